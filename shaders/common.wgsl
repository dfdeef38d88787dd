// For the kernels of a run; their bindings are `Run` in src/gpu/kernels/layouts.rs.

// The index in the bound part of `ring` for an entry of `ring_start`.
fn ring_place(start: u32) -> u32 {
    return (start & ~HELD) - part.ring_base;
}
