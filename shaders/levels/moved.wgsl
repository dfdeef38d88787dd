// Triangles with their vertices moved a times along the correction.

// How far a vertex moves.
fn displacement(v: u32) -> vec2<f32> {
    if v >= op.free {
        return vec2(0.0);
    }
    return move_of(v);
}

// An edge after its vertices have moved. A correction may carry both much farther than the edge is long.
fn moved_edge(e: vec2<f32>, tail_displacement: vec2<f32>, head_displacement: vec2<f32>) -> vec2<f32> {
    return e + opaque2(head_displacement - tail_displacement);
}

// Whether a triangle is inverted or flat, has an area that is not a number, or breaks the shape guard and is worse
// than it was.
fn is_broken(here: Corner, there: Corner) -> bool {
    if !is_positive(doubled_area(there)) {
        return true;
    }
    if op.shape_guard >= NO_GUARD {
        return false;
    }
    return inverse_mean_ratio(there) > max(op.shape_guard, inverse_mean_ratio(here));
}
