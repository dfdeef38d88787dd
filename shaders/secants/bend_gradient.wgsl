// Replaces the gradient by the vector that the levels are applied to: the gradient minus what the secant pairs account
// for.

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
