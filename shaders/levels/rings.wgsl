// For the kernels of a correction that visit the one-rings of vertices.

// The index in the bound part of `ring` for an entry of `ring_start`.
fn ring_place(start: u32) -> u32 {
    return (start & ~HELD) - op.ring_base;
}
