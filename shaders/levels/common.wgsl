// Common to the kernels of a correction from coarser levels, beside params.wgsl and the bindings of fine.wgsl,
// transfer.wgsl or coarse.wgsl. Each kernel is one step on vectors; `op` holds the places of these vectors.

struct LevelOp {
    // Invocations: the rows or triangles of this dispatch, of which there may be more.
    rows: u32,
    // The row or triangle of the first invocation.
    first: u32,
    // Number of free vertices.
    free: u32,
    // Entries of `ring` in front of the binding.
    ring_base: u32,
    // Place in `structure` of the start of each row, relative to `columns`.
    starts: u32,
    // Place in `structure` of the columns.
    columns: u32,
    // Place in `values` of the matrix entries, one for each column.
    entries: u32,
    // Place in `values` of the reciprocal diagonal.
    diagonal: u32,
    // Place in `vectors` of the vector that is multiplied; NONE for zero.
    x: u32,
    // Place in `vectors` of the right-hand side.
    right: u32,
    // Place in `vectors` of the last step; of kernels on the free vertices, that of the present roots of the stiffness, which the levels
    // are then fitted to, or NONE.
    step: u32,
    // Place in `vectors` of the result.
    out: u32,
    a: f32,
    // A factor too; of kernels that see a metric, one over the shape guard that a penalty keeps EDGE off, 0 for none.
    b: f32,
    // The inverse mean ratio up to which a correction may flatten a triangle, NO_GUARD for any.
    shape_guard: f32,
    // log2 of the exponent of EDGE's p-norm.
    sharpness: u32,
}

@group(0) @binding(1) var<uniform> op: LevelOp;

// The place in `ring` that a ring start stands for.
fn ring_place(start: u32) -> u32 {
    return (start & ~HELD) - op.ring_base;
}
