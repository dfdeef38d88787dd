// Inverts the diagonal blocks of a level's matrix, by the elimination of one unknown after the other. A pivot that is rounding
// makes the row and the column of its unknown zero in the inverse.

// Eliminates the unknown p, whose diagonal entry was `diagonal` at first.
fn eliminated(block: mat4x4<f32>, p: u32, diagonal: f32) -> mat4x4<f32> {
    let column = block[p];
    let row = vec4(block[0][p], block[1][p], block[2][p], block[3][p]);
    let pivot = column[p];
    let by = select(0.0, 1.0 / pivot, is_positive(pivot - LEAST_PIVOT * diagonal));
    let left = row * by;
    var made = mat4x4(
        block[0] - column * left.x,
        block[1] - column * left.y,
        block[2] - column * left.z,
        block[3] - column * left.w,
    );
    made[0][p] = left.x;
    made[1][p] = left.y;
    made[2][p] = left.z;
    made[3][p] = left.w;
    made[p] = -column * by;
    made[p][p] = by;
    return made;
}

@compute @workgroup_size(WORKGROUP)
fn invert_diagonal(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let row = invocation(id, groups);
    if row >= op.rows {
        return;
    }
    var at = structure[op.starts + row];
    while structure[op.columns + at] != row {
        at++;
    }
    let block = block_at(op.blocks, at);
    let first = eliminated(block, 0u, block[0][0]);
    let second = eliminated(first, 1u, block[1][1]);
    let third = eliminated(second, 2u, block[2][2]);
    set_block(op.inverses, row, eliminated(third, 3u, block[3][3]));
}
