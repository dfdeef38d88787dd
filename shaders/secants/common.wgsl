// Secant pairs of the free vertices, of which src/run/secant.rs tells what they are for. Two of them, in single precision;
// the slots of the newer and the older one change places from one correction to the next.

struct SecantOp {
    // Number of free vertices.
    free: u32,
    // Place of the newer pair in `steps` and `changes`.
    newer: u32,
    // Place of the older pair.
    older: u32,
    // How many of the two are there: the newer one if 1.
    pairs: u32,
    // Number of invocations that leave partial sums.
    partials: u32,
    // Whether sum_secants.wgsl sums products with the correction, not with the gradient.
    @size(12) is_after: u32,
}

@group(0) @binding(1) var<uniform> op: SecantOp;
@group(0) @binding(3) var<storage, read_write> gradient: array<vec2<f32>>;
@group(0) @binding(4) var<storage, read_write> direction: array<vec2<f32>>;
// How far the vertices moved from one correction to the next. Of the open pair: where they started, the high parts.
@group(0) @binding(5) var<storage, read_write> steps: array<vec2<f32>>;
// How the gradient changed meanwhile. Of the open pair: the gradient at the start, negative.
@group(0) @binding(6) var<storage, read_write> changes: array<vec2<f32>>;
// Where the vertices started, the low parts.
@group(0) @binding(7) var<storage, read_write> low_starts: array<vec2<f32>>;
// First the scalars below, then the partial sums.
@group(0) @binding(8) var<storage, read_write> sums: array<vec2<f32>>;

// Places in `sums`. Each holds a value for the newer pair, and one for the older.
const CURVATURES: u32 = 0u;
const BEFORE: u32 = 1u;
const AFTER: u32 = 2u;
// One value: the product of the older step and the newer change.
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

// What the gradient is bent by, so that the levels make of it what the pairs have not yet told.
fn bend(v: u32) -> vec2<f32> {
    let factors = sums[BEFORE];
    return opaque2(factors.x * changes[op.newer + v] + factors.y * older_change(v));
}
