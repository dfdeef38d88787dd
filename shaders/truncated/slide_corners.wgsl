// The triangles around sliding vertices.

// Returns the range of the triangles around a vertex that is not free, as indices in `corners` of `structure`.
fn corners_of(v: u32) -> vec2<u32> {
    let at = op.corner_starts + v - op.vertices;
    return vec2(structure[at], structure[at + 1u]);
}

// Returns one of the other two vertices of each triangle, which follow each other.
fn corner_at(k: u32) -> u32 {
    return structure[op.corners + k];
}
