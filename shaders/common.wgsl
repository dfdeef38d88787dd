// Shared by the kernels of a run, whose bindings are `Run` in src/gpu/kernels/layouts.rs.

// Returns the index in the bound part of `ring` for an offset from `ring_start`.
fn ring_place(start: u32) -> u32 {
    return (start & ~HELD) - part.ring_base;
}
