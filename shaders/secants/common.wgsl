// Declarations of the kernels for secant pairs of the free vertices; src/run/secant.rs explains their use. There are up
// to two pairs, in single precision. From one correction to the next the newer and the older pair exchange their slots.

struct SecantOp {
    // Number of free vertices.
    free: u32,
    // Where the newer pair begins in `steps` and `changes`.
    newer: u32,
    // Where the older pair begins in `steps` and `changes`.
    older: u32,
    // Number of pairs, 0 to 2. If it is 1, only the newer one exists.
    pairs: u32,
    // Number of invocations that leave partial sums.
    partials: u32,
    // Not zero if sum_secants.wgsl is to sum products with the correction, zero for products with the gradient.
    @size(12) is_after: u32,
}

@group(0) @binding(1) var<uniform> op: SecantOp;
@group(0) @binding(3) var<storage, read_write> gradient: array<vec2<f32>>;
@group(0) @binding(4) var<storage, read_write> direction: array<vec2<f32>>;
// How far the vertices moved from one correction to the next. For an open pair: the high parts of their positions at
// its start.
@group(0) @binding(5) var<storage, read_write> steps: array<vec2<f32>>;
// How the gradient changed from one correction to the next. For an open pair: minus the gradient at its start.
@group(0) @binding(6) var<storage, read_write> changes: array<vec2<f32>>;
// The low parts of the vertices' positions at the start of the open pair.
@group(0) @binding(7) var<storage, read_write> low_starts: array<vec2<f32>>;
// The scalars below, and behind them the partial sums.
@group(0) @binding(8) var<storage, read_write> sums: array<vec2<f32>>;

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
