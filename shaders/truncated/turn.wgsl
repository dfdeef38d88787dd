// Computes the next direction: the preconditioned residual plus β times the last direction.

@compute @workgroup_size(WORKGROUP)
fn turn(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let v = invocation(id, groups);
    if v >= op.rows || state.is_solved != 0u {
        return;
    }
    fine[direction_at(v)] = fine[product_at(v)] + state.beta * fine[direction_at(v)];
}
