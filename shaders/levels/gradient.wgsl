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
    var sum = vec2(0.0);
    var a = ring_edge(p, p.end - 1u);
    for (var i = p.start; i < p.end; i++) {
        let b = ring_edge(p, i);
        sum += metric_derivatives(Corner(a, b, p.mean_area), 0.0).gradient;
        a = b;
    }
    gradient[vertex] = sum * p.unit;
}
