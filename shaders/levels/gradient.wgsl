// The gradient of the sum of q² at each free vertex.

@compute @workgroup_size(WORKGROUP)
fn find_gradient(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let index = invocation(id, groups);
    if index >= op.rows {
        return;
    }
    let vertex = op.first + index;
    let p = patch_of(vertex);
    gradient[vertex] = derivatives_around(p).gradient * p.unit;
}
