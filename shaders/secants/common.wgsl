// Shared by the kernels for secant pairs of the free vertices, whose use src/run/secant.rs explains. Up to two pairs
// are stored in single precision. From one correction to the next, the newer and the older pair exchange their slots.
// The bindings are `Secants` in src/gpu/kernels/layouts.rs.

// Indices in `sums`: curvatures s·y, factors aᵢ before the levels and factors cᵢ after the levels, each with the newer
// pair's value in x and the older pair's in y.
const CURVATURES: u32 = 0u;
const BEFORE: u32 = 1u;
const AFTER: u32 = 2u;
// The product of the older step and the newer change, in x alone.
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

// Returns Σ aᵢ yᵢ, the vector that is subtracted from the gradient before the levels are applied.
fn bend(v: u32) -> vec2<f32> {
    let factors = sums[BEFORE];
    return opaque2(factors.x * changes[op.newer + v] + factors.y * older_change(v));
}
