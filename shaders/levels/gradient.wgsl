// The gradient of the sum of q² at each free vertex, by the vertex as the shape of its target map shows it.

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
    sharpness = op.sharpness;
    let p = patch_of(vertex);
    var sum = derivatives_around(p).gradient;
    if MAPPED {
        sum = mapped(inverse_of(shape_of(vertex)), sum);
    }
    gradient[vertex] = sum * p.unit;
}
