// Computes the square root of the stiffness at each free vertex, in the coordinates of the shape of its map.
// Both components of `gradient` receive the root.

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
    inverse_penalty_guard = op.inverse_penalty_guard;
    let p = patch_of(vertex);
    let sum = pulled_back(derivatives_around(p), inverse_of(shape_of(vertex))).hessian;
    gradient[vertex] = vec2(root_of_stiffness(p, sum));
}
