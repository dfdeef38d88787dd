// For all kernels of a correction from coarser levels. Each kernel is one operation on vectors; `op` tells where in
// `vectors` they begin. The bindings are `Fine`, `Transfer` and `Coarse` in src/gpu/kernels/layouts.rs.

// The index in the bound part of `ring` for an entry of `ring_start`.
fn ring_place(start: u32) -> u32 {
    return (start & ~HELD) - op.ring_base;
}
