// Begins a sweep where triangles are inverted: the ε of the energy follows from the most inverted one, as in
// src/run/regularization.rs. Where none is, what is encoded behind does nothing.

@compute @workgroup_size(1)
fn regularize() {
    if tangle.valid != 0u && part.begins == 0u {
        return;
    }
    let inverted = atomicExchange(&tangle.inverted, 0u);
    let depth = bitcast<f32>(atomicExchange(&tangle.depth, 0u));
    tangle.valid = select(0u, 1u, inverted == 0u);
    if inverted == 0u {
        // Vertices that were reached in this tangle are not in the next one.
        if tangle.sweep != tangle.since {
            tangle.sweep += 1u;
            tangle.since = tangle.sweep;
        }
        return;
    }
    // No square overflows.
    let unit = max(depth, 1.0);
    let share = depth / unit;
    tangle.epsilon = unit * sqrt(LEAST_SQUARE / unit / unit + SQUARE_SHARE * share * share);
    tangle.sweep += 1u;
    changes[0] += 1u;
}
