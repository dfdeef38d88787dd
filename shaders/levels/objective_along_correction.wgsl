// Evaluates a trial step along the correction by four sums over the mesh: the objective before and after the step, the
// count of triangles inverted before or broken after the step, and the objective's slope along the correction. For
// EDGE, the objective is the p-norm. Each invocation writes its partial sums as pairs of floats, which
// sum_along_correction.wgsl adds up. If the triangles are bound in parts, each dispatch continues the sums of the
// previous part.

@compute @workgroup_size(WORKGROUP)
fn objective_along_correction(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    if rests() {
        return;
    }
    let stride = groups.x * WORKGROUP;
    sharpness = op.sharpness;
    inverse_penalty_guard = op.inverse_penalty_guard;
    var sums: array<vec2<f32>, 4>;
    if op.first != 0u {
        for (var i = 0u; i < 4u; i++) {
            sums[i] = vectors[op.partial_sums + i * stride + id.x];
        }
    } else {
        for (var v = id.x; v < op.free; v += stride) {
            sums[3] = pair_accumulate(sums[3], dot(gradient[v], direction[v]));
        }
    }
    for (var t = id.x; t < op.rows; t += stride) {
#if QUADRILATERALS
        for (var k = 0u; k < 4u; k++) {
        let places = own_corner(t, k);
        let corners = vec3(triangles[places.x], triangles[places.y], triangles[places.z]);
#else
        let corners = vec3(triangles[3u * t], triangles[3u * t + 1u], triangles[3u * t + 2u]);
#endif
        let p = position(corners.x);
        let a = edge(p, position(corners.y));
        let b = edge(p, position(corners.z));
        let d = displacement(corners.x);
        let map = map_of(corners);
        let ideal = Ideal(params.mean_area, params.size_weight);
#if QUADRILATERALS
        let here = transformed(metric_form(Corner(a, b, ideal)), map);
#else
        let here = transformed(Corner(a, b, ideal), map);
#endif
        let moved = Corner(
            moved_edge(a, d, displacement(corners.y)),
            moved_edge(b, d, displacement(corners.z)),
            ideal,
        );
#if QUADRILATERALS
        let there = transformed(metric_form(moved), map);
#else
        let there = transformed(moved, map);
#endif
#if OPPOSITE_ANGLES
        var joined = 0.0;
        // Each pair of opposite corners has one share.
        if k < 2u {
            let across = opposite_corner(t, k);
            let around = vec3(triangles[across.x], triangles[across.y], triangles[across.z]);
            let o = position(around.x);
            let e = displacement(around.x);
            let far = Corner(edge(o, position(around.y)), edge(o, position(around.z)), ideal);
            let moved_far = Corner(
                moved_edge(far.a, e, displacement(around.y)),
                moved_edge(far.b, e, displacement(around.z)),
                ideal,
            );
            let map_far = map_of(around);
            let opposite_here = transformed(metric_form(far), map_far);
            let opposite_there = transformed(metric_form(moved_far), map_far);
            sums[0] = pair_accumulate(sums[0], share_of_opposite_angles(here, opposite_here));
            joined = share_of_opposite_angles(there, opposite_there);
        }
#endif
        sums[0] = pair_accumulate(sums[0], metric_model(here));
        if !is_positive(doubled_area(here)) || is_broken(here, there)
            || !keeps_altitude(a, b, moved.a, moved.b, 1.0) {
            sums[2].x += 1.0;
        } else {
#if OPPOSITE_ANGLES
            sums[1] = pair_accumulate(sums[1], joined);
#endif
            sums[1] = pair_accumulate(sums[1], metric_model(there));
        }
#if QUADRILATERALS
        }
#endif
    }
    for (var i = 0u; i < 4u; i++) {
        vectors[op.partial_sums + i * stride + id.x] = sums[i];
    }
}
