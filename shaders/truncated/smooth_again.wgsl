// The second step of Chebyshev's method on a level, after a first step from a residual. From zero, the residual is the right-hand
// side; otherwise the steps are added to the solution.

@compute @workgroup_size(WORKGROUP)
fn smooth_again(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let row = invocation(id, groups);
    if row >= op.rows || state.is_solved != 0u {
        return;
    }
    let is_from_zero = op.left == op.right;
    let left = residual(row, op.left, op.step);
    let step = STEP_AGAIN * rows[op.step + row] + SECOND_STEP * (block_at(op.inverses, row) * left);
    let before = select(rows[op.solution + row], vec4(0.0), is_from_zero);
    rows[op.solution + row] = before + step;
}
