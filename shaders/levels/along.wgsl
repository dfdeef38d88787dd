// Returns the step length along the correction: the host's length or, if the host has given 0, the length that the line
// search on the device has found.
fn length_along() -> f32 {
    if op.length != 0.0 {
        return op.length;
    }
    return vectors[LENGTHS].x;
}

// Returns the displacement of a free vertex, within its disc. The correction is in the coordinates of the shape of the vertex's
// map, and is mapped back.
fn move_of(v: u32) -> vec2<f32> {
    var d = direction[v];
    if MAPPED {
        d = mapped(inverse_of(shape_of(v)), d);
    }
    if !BOUNDED {
        return opaque2(length_along() * d);
    }
    var slopes = gradient[v];
    if MAPPED {
        slopes = mapped(shape_of(v), slopes);
    }
    let disc = disc_of(v, position(v), 1.0);
    return opaque2(within(disc, length_along() * along_circle(disc, d, slopes)));
}
