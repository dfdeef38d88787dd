// What each free vertex hands down: the gradient, smoothed as the prolongation is. It stands where the correction
// will.

@compute @workgroup_size(WORKGROUP)
fn smooth_gradient(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let index = invocation(id, groups);
    if index >= op.rows {
        return;
    }
    let v = op.first + index;
    var around = vec2(0.0);
    let end = ring_place(ring_start[v + 1u]);
    for (var i = ring_place(ring_start[v]); i < end; i++) {
        let k = ring[i];
        if k < op.free {
            around += gradient[k] * (values[op.diagonal + k] * edge_weight(v, k));
        }
    }
    direction[v] = gradient[v] * (1.0 - SMOOTHING) + around * SMOOTHING;
}
