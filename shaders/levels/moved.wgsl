// Triangles after their vertices have moved along the correction by the step length.

// Returns the displacement of a vertex, zero for vertices that are not free.
fn displacement(v: u32) -> vec2<f32> {
    // Without a branch, the loads of the three corners of a triangle are under way at once.
    return select(vec2(0.0), move_of(min(v, op.free - 1u)), v < op.free);
}

// Returns an edge after its two vertices have moved. Displacements may be much longer than the edge, so the
// displacements are subtracted first.
fn moved_edge(e: vec2<f32>, tail_displacement: vec2<f32>, head_displacement: vec2<f32>) -> vec2<f32> {
    return e + opaque2(head_displacement - tail_displacement);
}

// Returns whether the moved triangle is inverted, flat or not finite, or breaks the shape guard and is worse than
// before.
fn is_broken(here: Corner, there: Corner) -> bool {
    if !is_positive(doubled_area(there)) {
        return true;
    }
    if op.shape_guard >= NO_GUARD {
        return false;
    }
    return inverse_mean_ratio(there) > max(op.shape_guard, inverse_mean_ratio(here));
}
