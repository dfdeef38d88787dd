// For the kernels for secant pairs of the free vertices; src/run/secant.rs explains their use. There are up to two pairs,
// in single precision. From one correction to the next the newer and the older pair exchange their slots. The bindings
// are `Secants` in src/gpu/kernels/layouts.rs.

// Indices in `sums`. Each of the first three holds one value for the newer pair and one for the older.
const CURVATURES: u32 = 0u;
const BEFORE: u32 = 1u;
const AFTER: u32 = 2u;
// Holds one value: the product of the older step and the newer change.
const ACROSS: u32 = 3u;
const PARTIAL: u32 = 4u;

fn older_step(v: u32) -> vec2<f32> {
    if op.pairs < 2u {
        return vec2(0.0);
    }
    return steps[op.older + v];
}

fn older_change(v: u32) -> vec2<f32> {
    if op.pairs < 2u {
        return vec2(0.0);
    }
    return changes[op.older + v];
}

// The vector subtracted from the gradient before the levels are applied: the part that the secant pairs account for.
fn bend(v: u32) -> vec2<f32> {
    let factors = sums[BEFORE];
    return opaque2(factors.x * changes[op.newer + v] + factors.y * older_change(v));
}
