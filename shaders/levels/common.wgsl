// What the kernels of a correction from coarser levels see, beside params.wgsl and the bindings of fine.wgsl,
// transfer.wgsl or coarse.wgsl. Each is one step on vectors; `op` says where these are.

struct LevelOp {
    // Invocations, and the number of the first: the rest of the rows, or of the triangles, is for other dispatches.
    rows: u32,
    first: u32,
    // Number of free vertices.
    free: u32,
    // What of `ring` is in front of the binding.
    ring_base: u32,
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
    // The inverse mean ratio up to which a correction may flatten a triangle, where the metric is GUARDED.
    @size(8) shape_guard: f32,
}

@group(0) @binding(1) var<uniform> op: LevelOp;

// Where in `ring` the neighbors of a vertex start, from its ring start.
fn ring_place(start: u32) -> u32 {
    return (start & ~HELD) - op.ring_base;
}
