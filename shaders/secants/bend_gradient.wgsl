// Replaces the gradient by the vector to which the levels are applied: the gradient minus the part that the secant
// pairs account for.

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
