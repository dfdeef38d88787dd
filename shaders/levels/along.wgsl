// How far a free vertex moves along the correction, which is as the shape of its target map shows it.
fn move_of(v: u32) -> vec2<f32> {
    var d = direction[v];
    if MAPPED {
        d = mapped(inverse_of(shape_of(v)), d);
    }
    return opaque2(op.a * d);
}
