// Common to the kernels of a correction from coarser levels, beside params.wgsl and the bindings of fine.wgsl,
// transfer.wgsl or coarse.wgsl. Each kernel is one step on vectors; `op` says where these are.

struct LevelOp {
    // Invocations, and the row or triangle of the first one. Other dispatches take the rest.
    rows: u32,
    first: u32,
    // Number of free vertices.
    free: u32,
    // Entries of `ring` in front of the binding.
    ring_base: u32,
    // In `structure`: where each row starts, relative to the columns of the first, and the columns.
    starts: u32,
    columns: u32,
    // In `values`: the matrix entries that belong to `columns`, and the reciprocal diagonal.
    entries: u32,
    diagonal: u32,
    // In `vectors`: the vector that is multiplied (NONE for zero), the right-hand side, the last step, the result.
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

// The place in `ring` that a ring start stands for.
fn ring_place(start: u32) -> u32 {
    return (start & ~HELD) - op.ring_base;
}
