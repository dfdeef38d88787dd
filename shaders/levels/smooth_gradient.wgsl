// Applies the transpose of the prolongation's smoothing to the gradient, for restrict.wgsl. The result goes to
// `direction`, before this vector holds the correction.

fn carried(k: u32) -> vec2<f32> {
    return gradient[k] * (fit(k) * values[op.diagonal + k] * root(k));
}

@compute @workgroup_size(WORKGROUP)
fn smooth_gradient(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let index = invocation(id, groups);
    if index >= op.rows || rests() {
        return;
    }
    let v = op.first + index;
    direction[v] = gradient[v] * (fit(v) * (1.0 - SMOOTHING)) + sum_over_neighbors(v) * (SMOOTHING * root(v));
}
