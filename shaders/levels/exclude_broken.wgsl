// Replaces the correction by the result of find_broken.wgsl, and sets the gradient to zero at the excluded vertices.

@compute @workgroup_size(WORKGROUP)
fn exclude_broken(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let vertex = invocation(id, groups);
    if vertex >= op.rows || rests() {
        return;
    }
    let kept = vectors[op.unbroken + vertex];
    if any(direction[vertex] != kept) {
        gradient[vertex] = vec2(0.0);
        direction[vertex] = kept;
    }
}
