// Computes the correction with zeros at the free vertices of triangles that the correction would break. The result goes
// to `vectors`, because invocations for neighbors still read the old correction; exclude_broken.wgsl copies the
// result.

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
    vectors[op.unbroken + vertex] = select(vec2(0.0), direction[vertex], kept);
}
