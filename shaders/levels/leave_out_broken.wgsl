// Puts in place the correction that find_broken.wgsl has left some vertices out of, and leaves their gradients out as well.

@compute @workgroup_size(WORKGROUP)
fn leave_out_broken(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let vertex = invocation(id, groups);
    if vertex >= op.rows || rests() {
        return;
    }
    let kept = vectors[op.x + vertex];
    if any(direction[vertex] != kept) {
        gradient[vertex] = vec2(0.0);
        direction[vertex] = kept;
    }
}
