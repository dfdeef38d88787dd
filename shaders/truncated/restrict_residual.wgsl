// Computes the right-hand side of the next coarser level, the residual of this level summed over each coarser aggregate, and the
// first step of Chebyshev's method from zero.

@compute @workgroup_size(WORKGROUP)
fn restrict_residual(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let row = invocation(id, groups);
    if row >= op.rows || state.is_solved != 0u {
        return;
    }
    var sum = vec4(0.0);
    let end = structure[op.member_starts + row + 1u];
    for (var i = structure[op.member_starts + row]; i < end; i++) {
        let member = structure[op.members + i];
        sum += transpose(motion_of(member)) * residual(member, op.right, op.solution);
    }
    rows[op.coarse_right + row] = sum;
    rows[op.coarse_step + row] = FIRST_STEP * (block_at(op.coarse_inverses, row) * sum);
}
