// How far the correction is gone along: as the host says, or, if that is 0, the device's own line search.
fn length_along() -> f32 {
    if op.a != 0.0 {
        return op.a;
    }
    return vectors[LENGTHS].x;
}

// How far a free vertex moves along the correction, which is as the shape of its target map shows it.
fn move_of(v: u32) -> vec2<f32> {
    var d = direction[v];
    if MAPPED {
        d = mapped(inverse_of(shape_of(v)), d);
    }
    return opaque2(length_along() * d);
}
