// Computes the correction with zeros at the free vertices of triangles that the correction would break. The result goes
// to `vectors`, because invocations for neighbors still read the old correction; exclude_broken.wgsl copies the
// result.

#if QUADRILATERALS
// The displacements of the vertices of an element other than the visited vertex, counter-clockwise.
struct Displacements {
    next: vec2<f32>,
    opposite: vec2<f32>,
    last: vec2<f32>,
}

fn displacements_of(vertices: vec3<u32>) -> Displacements {
    return Displacements(
        displacement(vertices.x),
        displacement(vertices.y),
        displacement(vertices.z),
    );
}

// Returns a corner of an element after its vertices have moved, the visited vertex by d.
fn moved_corner(t: Corner, role: u32, d: vec2<f32>, by: Displacements) -> Corner {
    if role == NEXT {
        return Corner(moved_edge(t.a, by.next, by.opposite), moved_edge(t.b, by.next, d), t.ideal);
    }
    if role == LAST {
        return Corner(moved_edge(t.a, by.last, d), moved_edge(t.b, by.last, by.opposite), t.ideal);
    }
    return Corner(moved_edge(t.a, d, by.next), moved_edge(t.b, d, by.last), t.ideal);
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
    for (var at = first_element(p); at.entry < p.end; at = next_element(p, at)) {
        let ahead = displacements_of(at.element.vertices);
        for (var role = at.first_role; role <= at.last_role; role++) {
            let was = corner_in(p, at.element, role, vec2(0.0));
            let moved = moved_corner(was, role, d, ahead);
            let map = map_in(p, at.element, role);
            let here = transformed(metric_form(was), map);
            let there = transformed(metric_form(moved), map);
            kept = kept && !is_broken(here, there)
                && keeps_altitude(was.a, was.b, moved.a, moved.b, 1.0);
        }
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
