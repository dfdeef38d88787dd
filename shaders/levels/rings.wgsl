// Shared by the kernels of a correction that visit one-rings.

// Returns the index in the bound part of `ring` for an offset from `ring_start`.
fn ring_place(start: u32) -> u32 {
    return (start & ~HELD) - op.ring_base;
}
