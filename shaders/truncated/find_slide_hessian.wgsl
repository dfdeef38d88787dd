// Computes the Hessian of the sum of q² at each sliding vertex: for each triangle around the vertex, the 2x2 blocks of the second
// derivatives by the vertex and by each of the other two. If `op.is_positive`, computes the positive semidefinite part of the
// Hessian, the inverse of its second derivative along the tangent, and the tangents of the levels; otherwise the whole Hessian
// and the residual, the negative gradient.

@compute @workgroup_size(WORKGROUP)
fn find_slide_hessian(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let index = invocation(id, groups);
    if index >= op.rows {
        return;
    }
    let line = lines[index];
    let v = line.vertex;
    let range = corners_of(v);
    let unit = unit_of(edge(position(v), position(corner_at(2u * range.x))));
    let p = patch_around(v, range.x, range.y, unit);
    var gradient = vec2(0.0);
    var own = vec4(0.0);
    for (var i = p.start; i < p.end; i++) {
        let first = corner_at(2u * i);
        let second = corner_at(2u * i + 1u);
        let map = map_of_patch(p, first, second);
#if QUADRILATERALS
        let t = corner_of(p, role_at(i), first, second, vec2(0.0));
        let made = blocks_of(transformed(metric_form(t), map));
#else
        let a = edge(p.at, position(first)) * p.unit;
        let b = edge(p.at, position(second)) * p.unit;
        let made = blocks_of(transformed(Corner(a, b, p.ideal), map));
#endif
        gradient += select(made.gradient, mapped(map, made.gradient), HAS_TARGETS);
        own += block_in_plane(made.own, map, p.unit);
        entries[op.slide_entries + 2u * i] = block_in_plane(made.a, map, p.unit);
        entries[op.slide_entries + 2u * i + 1u] = block_in_plane(made.b, map, p.unit);
    }
    if op.is_positive == 0u {
        fine[v] = -gradient * p.unit;
        return;
    }
    let t = line.along;
    let stiffness = max(line.curvature, 0.0);
    let second = dot(t, mat2x2(own.xy, own.zw) * t) + stiffness;
    let by = select(0.0, 1.0 / second, second > 0.0);
    fine[inverse_at(v)] = vec2(t.x * t.x, t.x * t.y) * by;
    fine[inverse_at(v) + 1u] = vec2(t.y * t.y * by, stiffness);
    fine[tangent_at(v)] = t;
}
