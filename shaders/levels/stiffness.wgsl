// The root of the stiffness at each free vertex, in both components of `gradient`: of the mean absolute eigenvalue of the
// Hessian of the sum of q² with respect to the vertex, as the shape of its target map shows it, over the number of its neighbors.

@compute @workgroup_size(WORKGROUP)
fn find_stiffness(
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
    let sum = pulled_back(derivatives_around(p), inverse_of(shape_of(vertex))).hessian;
    let mean = 0.5 * (sum.x + sum.z);
    let half = 0.5 * (sum.x - sum.z);
    // The eigenvalues are the mean plus and minus the radius.
    let radius = sqrt(half * half + sum.y * sum.y);
    let root = sqrt(max(abs(mean), radius) / f32(p.end - p.start));
    gradient[vertex] = vec2(root * p.unit);
}
