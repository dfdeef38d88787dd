// Projects the residual at sliding vertices to their admitted moves, and begins conjugate gradients there. Each invocation has
// an unknown.

@compute @workgroup_size(WORKGROUP)
fn project_residual(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let first = invocation(id, groups);
    if first >= op.rows || lines[first].is_first == 0u {
        return;
    }
    set_value(0u, first, value_in(0u, first));
    set_value(solution_at(0u), first, 0.0);
    set_value(direction_at(0u), first, 0.0);
    set_value(product_at(0u), first, 0.0);
}
