// The triangles around sliding vertices.

// Returns the range of the triangles around a vertex that is not free, as indices in `corners` of `structure`.
fn corners_of(v: u32) -> vec2<u32> {
    let at = op.corner_starts + v - op.vertices;
    return vec2(structure[at], structure[at + 1u]);
}

// Returns one of the other two vertices of each triangle, which follow each other.
fn corner_at(k: u32) -> u32 {
#if QUADRILATERALS
    return structure[op.corners + k] & ~OPPOSITE;
#else
    return structure[op.corners + k];
#endif
}
#if QUADRILATERALS

// Returns the role of the sliding vertex in a corner, from the marks of the other two vertices.
fn role_at(corner: u32) -> u32 {
    let k = op.corners + 2u * corner;
    return (structure[k] >> 31u) + 2u * (structure[k + 1u] >> 31u);
}
#endif
