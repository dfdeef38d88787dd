// Computes the gradient of the sum of q² by each free vertex, in the coordinates of the shape of the vertex's
// map. The gradient is zero at held vertices. If each correction fits the levels, the square root of the stiffness is
// computed too.

@compute @workgroup_size(WORKGROUP)
fn find_gradient(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let index = invocation(id, groups);
    if index >= op.rows || rests() {
        return;
    }
    let vertex = op.first + index;
    if (ring_start[vertex] & HELD) != 0u {
        gradient[vertex] = vec2(0.0);
        if op.present_roots != NONE {
            vectors[op.present_roots + vertex] = vec2(0.0);
        }
        return;
    }
    sharpness = op.sharpness;
    inverse_penalty_guard = op.inverse_penalty_guard;
    let p = patch_of(vertex);
    var sum = derivatives_around(p);
    if BOUNDED {
        sum.gradient = tangential(disc_of(vertex, p.at, p.unit), sum.gradient);
    }
    if MAPPED {
        sum = pulled_back(sum, inverse_of(shape_of(vertex)));
    }
    gradient[vertex] = sum.gradient * p.unit;
    if op.present_roots != NONE {
        vectors[op.present_roots + vertex] = vec2(root_of_stiffness(p, sum.hessian), 0.0);
    }
}
