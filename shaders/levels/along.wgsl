// Returns the step length along the correction: the host's length or, if the host has given 0, the length that the line
// search on the device has found.
fn length_along() -> f32 {
    if op.length != 0.0 {
        return op.length;
    }
    return vectors[LENGTHS].x;
}

// Returns the displacement of a free vertex. The correction is in the coordinates of the shape of the vertex's
// map, and is mapped back.
fn move_of(v: u32) -> vec2<f32> {
    var d = direction[v];
    if MAPPED {
        d = mapped(inverse_of(shape_of(v)), d);
    }
    return opaque2(length_along() * d);
}
