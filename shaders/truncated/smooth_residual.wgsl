// Computes the residual of a level, and the first step of Chebyshev's method from it.

@compute @workgroup_size(WORKGROUP)
fn smooth_residual(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let row = invocation(id, groups);
    if row >= op.rows || state.is_solved != 0u {
        return;
    }
    let left = residual(row, op.right, op.solution);
    rows[op.left + row] = left;
    rows[op.step + row] = FIRST_STEP * (block_at(op.inverses, row) * left);
}
