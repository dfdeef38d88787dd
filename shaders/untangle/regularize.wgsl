// Begins a sweep if triangles are inverted: computes the ε of the energy from the most inverted triangle, as in
// src/run/regularization.rs. If no triangle is inverted, sets `valid`, so that later kernels of the call do nothing.

@compute @workgroup_size(1)
fn regularize() {
    if tangle.valid != 0u && part.begins == 0u {
        return;
    }
    let inverted = atomicExchange(&tangle.inverted, 0u);
    let depth = bitcast<f32>(atomicExchange(&tangle.depth, 0u));
    tangle.valid = select(0u, 1u, inverted == 0u);
    if inverted == 0u {
        // Vertices marked in this tangle do not count as marked in the next tangle.
        if tangle.sweep != tangle.since {
            tangle.sweep += 1u;
            tangle.since = tangle.sweep;
        }
        return;
    }
    // Scaled so that no square overflows.
    let unit = max(depth, 1.0);
    let share = depth / unit;
    tangle.epsilon = unit * sqrt(MIN_SQUARE / unit / unit + SQUARE_SHARE * share * share);
    tangle.sweep += 1u;
    changes[0] += 1u;
}
