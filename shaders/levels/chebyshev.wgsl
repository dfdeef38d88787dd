// A step of Chebyshev's iteration on a level: step = last_step_factor step + residual_factor D⁻¹ (right - A x),
// out = x + step.

@compute @workgroup_size(WORKGROUP)
fn chebyshev(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let row = invocation(id, groups);
    if row >= op.rows || rests() {
        return;
    }
    var residual = vectors[op.right + row];
    if op.x != NONE {
        residual -= row_times_x(row);
    }
    var step = op.residual_factor * values[op.diagonal + row] * residual;
    if op.last_step_factor != 0.0 {
        step += op.last_step_factor * vectors[op.last_step + row];
    }
    vectors[op.last_step + row] = step;
    if op.x != NONE {
        step += vectors[op.x + row];
    }
    vectors[op.out + row] = step;
}
