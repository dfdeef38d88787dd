// Declarations of all kernels of a correction from coarser levels, beside params.wgsl and the bindings of fine.wgsl,
// transfer.wgsl or coarse.wgsl. Each kernel is one operation on vectors; `op` tells where in `vectors` they begin.

struct LevelOp {
    // Number of rows or triangles of this dispatch. More invocations than these may be started.
    rows: u32,
    // The row or triangle of the first invocation.
    first: u32,
    // Number of free vertices.
    free: u32,
    // Number of entries of `ring` before the start of the binding.
    ring_base: u32,
    // Where in `structure` the row starts begin. Row starts count from `columns` and `entries`.
    starts: u32,
    // Where in `structure` the column numbers begin.
    columns: u32,
    // Where in `values` the matrix entries begin, one for each column number.
    entries: u32,
    // Where in `values` the reciprocal diagonal begins.
    diagonal: u32,
    // Where in `vectors` the vector to be multiplied begins; NONE for a vector of zeros.
    x: u32,
    // Where in `vectors` the right-hand side begins.
    right: u32,
    // Where in `vectors` the last step begins. For kernels on the free vertices: where the square roots of the present
    // stiffness begin, to which the levels are fitted, or NONE if they are not.
    step: u32,
    // Where in `vectors` the result begins.
    out: u32,
    a: f32,
    // A factor too; of kernels that see a metric, one over the shape guard that a penalty keeps EDGE off, 0 for none.
    b: f32,
    // Up to this inverse mean ratio a correction may flatten a triangle. NO_GUARD allows any ratio.
    shape_guard: f32,
    // log2 of the exponent of EDGE's p-norm.
    sharpness: u32,
}

@group(0) @binding(1) var<uniform> op: LevelOp;

// The index in the bound part of `ring` for an entry of `ring_start`.
fn ring_place(start: u32) -> u32 {
    return (start & ~HELD) - op.ring_base;
}
