// Computes the Hessian of the sum of q² at each free vertex: for each neighbor in the one-ring, the 2x2 block of the second
// derivatives by both vertices. The blocks of a row, the vertex's own included, have the sum zero, because q does not change
// when a triangle moves as a whole. So the vertex's own block is not stored. If `op.is_positive`, computes the positive
// semidefinite part of the Hessian (Curvature in src/metric/curvature.rs) and the inverses of its diagonal blocks; otherwise
// the whole Hessian and the residual, the negative gradient.

@compute @workgroup_size(WORKGROUP)
fn find_hessian(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let v = invocation(id, groups);
    if v >= op.rows {
        return;
    }
    let p = patch_of(v);
    var gradient = vec2(0.0);
    var own = vec4(0.0);
#if QUADRILATERALS
    for (var i = p.start; i < p.end; i++) {
        entries[i] = vec4(0.0);
    }
    for (var at = first_element(p); at.entry < p.end; at = next_element(p, at)) {
        let around = entries_of(p, at);
        for (var role = at.first_role; role <= at.last_role; role++) {
            let map = map_in(p, at.element, role);
            let corner = corner_in(p, at.element, role, vec2(0.0));
            let made = blocks_of(transformed(metric_form(corner), map));
            gradient += select(made.gradient, mapped(map, made.gradient), HAS_TARGETS);
            own += block_in_plane(made.own, map, p.unit);
            let others = others_of(around, role);
            entries[others.x] += block_in_plane(made.a, map, p.unit);
            entries[others.y] += block_in_plane(made.b, map, p.unit);
        }
    }
#else
    // The last neighbor has its second triangle at the start of the one-ring.
    var of_last = vec4(0.0);
    var before = vec4(0.0);
    var a = ring_edge(p, p.end - 1u);
    for (var i = p.start; i < p.end; i++) {
        let b = ring_edge(p, i);
        let map = map_around(p, i);
        let made = blocks_of(transformed(Corner(a, b, p.ideal), map));
        gradient += select(made.gradient, mapped(map, made.gradient), HAS_TARGETS);
        own += block_in_plane(made.own, map, p.unit);
        let earlier = block_in_plane(made.a, map, p.unit);
        if i == p.start {
            of_last = earlier;
        } else {
            entries[i - 1u] = before + earlier;
        }
        before = block_in_plane(made.b, map, p.unit);
        a = b;
    }
    entries[p.end - 1u] = before + of_last;
#endif
    if op.is_positive != 0u {
        let determinant = own.x * own.w - own.y * own.y;
        let by = select(0.0, 1.0 / determinant, determinant > 0.0);
        fine[inverse_at(v)] = vec2(own.w, -own.y) * by;
        fine[inverse_at(v) + 1u] = vec2(own.x * by, 0.0);
        return;
    }
    fine[v] = -gradient * p.unit;
    fine[solution_at(v)] = vec2(0.0);
    fine[direction_at(v)] = vec2(0.0);
    fine[product_at(v)] = vec2(0.0);
}
