// The vector that the levels are given: the gradient, less what the pairs tell.

@compute @workgroup_size(WORKGROUP)
fn bend_gradient(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let v = invocation(id, groups);
    if v >= op.free {
        return;
    }
    gradient[v] -= bend(v);
}
