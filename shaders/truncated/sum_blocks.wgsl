// Computes a row of the next coarser level's matrix: the sums of the blocks between the members of both aggregates, for motions
// of the aggregates.

// Returns a block by the motion of the coarser aggregate on the right-hand side.
fn moved(block: mat4x4<f32>, shift: vec4<f32>) -> mat4x4<f32> {
    return mat4x4(
        block[0],
        block[1],
        shift.x * block[0] + shift.y * block[1] + shift.z * block[2],
        shift.x * block[1] - shift.y * block[0] + shift.z * block[3],
    );
}

@compute @workgroup_size(WORKGROUP)
fn sum_blocks(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let row = invocation(id, groups);
    if row >= op.rows {
        return;
    }
    let first = structure[op.coarse_starts + row];
    let end = structure[op.coarse_starts + row + 1u];
    for (var at = first; at < end; at++) {
        set_block(op.coarse_blocks, at, mat4x4<f32>());
    }
    let last = structure[op.member_starts + row + 1u];
    for (var i = structure[op.member_starts + row]; i < last; i++) {
        let member = structure[op.members + i];
        let left = rows[op.shifts + member];
        let last_block = structure[op.starts + member + 1u];
        for (var k = structure[op.starts + member]; k < last_block; k++) {
            let other = structure[op.columns + k];
            let column = structure[op.aggregate_of + other];
            var at = first;
            while structure[op.coarse_columns + at] != column {
                at++;
            }
            let by_right = transpose(moved(block_at(op.blocks, k), rows[op.shifts + other]));
            add_block(op.coarse_blocks, at, transpose(moved(by_right, left)));
        }
    }
}
