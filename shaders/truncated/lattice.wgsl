// A level of aggregates, which move, turn and scale, and the next coarser level, whose aggregates are groups of them. The
// rows of an aggregate are its four unknowns: a translation, and a turn with a scaling as a complex number.

// Returns the motion of an aggregate by the four unknowns of its coarser aggregate.
fn motion_of(row: u32) -> mat4x4<f32> {
    let shift = rows[op.shifts + row];
    return mat4x4(
        vec4(1.0, 0.0, 0.0, 0.0),
        vec4(0.0, 1.0, 0.0, 0.0),
        vec4(shift.x, shift.y, shift.z, 0.0),
        vec4(-shift.y, shift.x, 0.0, shift.z),
    );
}

// Returns a row of the residual: the right-hand side at the offset `right` minus the matrix times the vector at `x`.
fn residual(row: u32, right: u32, x: u32) -> vec4<f32> {
    var left = rows[right + row];
    let end = structure[op.starts + row + 1u];
    for (var at = structure[op.starts + row]; at < end; at++) {
        left -= block_at(op.blocks, at) * rows[x + structure[op.columns + at]];
    }
    return left;
}
