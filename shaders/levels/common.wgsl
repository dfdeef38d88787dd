// What the kernels of a correction from coarser levels see, beside params.wgsl. Each is one step on vectors;
// `op` says where these are.

struct LevelOp {
    // Invocations.
    rows: u32,
    // Number of free vertices.
    free: u32,
    // In `structure`: where each row starts, relative to the columns of the first, and the columns.
    starts: u32,
    columns: u32,
    // In `values`: what goes with the columns, and the reciprocal diagonal.
    entries: u32,
    diagonal: u32,
    // In `vectors`: what is multiplied (NONE for zero), the right-hand side, the last step, the result.
    x: u32,
    right: u32,
    step: u32,
    out: u32,
    a: f32,
    b: f32,
}

@group(0) @binding(1) var<uniform> op: LevelOp;
@group(0) @binding(2) var<storage, read_write> positions: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> ring_start: array<u32>;
@group(0) @binding(4) var<storage, read> ring: array<u32>;
@group(0) @binding(5) var<storage, read> triangles: array<u32>;
@group(0) @binding(6) var<storage, read> structure: array<u32>;
@group(0) @binding(7) var<storage, read> values: array<f32>;
@group(0) @binding(8) var<storage, read_write> vectors: array<vec2<f32>>;

// Where in `ring` the neighbors of a vertex start, from its ring start.
fn ring_place(start: u32) -> u32 {
    return start & ~HELD;
}

// The product of a row of the matrix with x.
fn row_times_x(row: u32) -> vec2<f32> {
    var sum = vec2(0.0);
    let end = structure[op.starts + row + 1u];
    for (var i = structure[op.starts + row]; i < end; i++) {
        sum += values[op.entries + i] * vectors[op.x + structure[op.columns + i]];
    }
    return sum;
}
