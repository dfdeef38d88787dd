// Computes the correction with zeros at the free vertices of triangles that the correction would break. The result goes
// to `vectors`, because invocations for neighbors still read the old correction; exclude_broken.wgsl copies the
// result.

#if QUADRILATERALS
// Returns a corner of a patch after its vertices have moved: the visited vertex by d, the others by `first` and `second`.
fn moved_corner(t: Corner, role: u32, d: vec2<f32>, first: vec2<f32>, second: vec2<f32>) -> Corner {
    if role == NEXT {
        return Corner(moved_edge(t.a, first, second), moved_edge(t.b, first, d), t.ideal);
    }
    if role == LAST {
        return Corner(moved_edge(t.a, first, d), moved_edge(t.b, first, second), t.ideal);
    }
    return Corner(moved_edge(t.a, d, first), moved_edge(t.b, d, second), t.ideal);
}

#endif
@compute @workgroup_size(WORKGROUP)
fn find_broken(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let index = invocation(id, groups);
    if index >= op.rows || rests() {
        return;
    }
    let vertex = op.first + index;
#if QUADRILATERALS
    var p = patch_of(vertex);
    p.unit = 1.0;
    p.ideal = Ideal(params.mean_area, params.size_weight);
    let d = displacement(vertex);
    var kept = true;
    for (var at = first_corner(p); at.entry < p.end; at = next_corner(p, at)) {
        let others = others_of(p, at);
        let map = map_of_corner(p, at);
        let was = corner_around(p, at, vec2(0.0));
        let moved = moved_corner(
            was,
            at.role,
            d,
            displacement(vertex_at(others.x)),
            displacement(vertex_at(others.y)),
        );
        let here = transformed(metric_form(was), map);
        let there = transformed(metric_form(moved), map);
        kept = kept && !is_broken(here, there)
            && keeps_altitude(was.a, was.b, moved.a, moved.b, 1.0);
    }
#else
    let p = patch_of(vertex);
    let d = displacement(vertex);
    let last = ring[p.end - 1u];
    var a = edge(p.at, position(last));
    var moved_a = moved_edge(a, d, displacement(last));
    var kept = true;
    for (var i = p.start; i < p.end; i++) {
        let neighbor = ring[i];
        let b = edge(p.at, position(neighbor));
        let moved_b = moved_edge(b, d, displacement(neighbor));
        let map = map_around(p, i);
        let ideal = Ideal(params.mean_area, params.size_weight);
        let here = transformed(Corner(a, b, ideal), map);
        let there = transformed(Corner(moved_a, moved_b, ideal), map);
        kept = kept && !is_broken(here, there)
            && keeps_altitude(a, b, moved_a, moved_b, 1.0);
        a = b;
        moved_a = moved_b;
    }
#endif
    vectors[op.unbroken + vertex] = select(vec2(0.0), direction[vertex], kept);
}
