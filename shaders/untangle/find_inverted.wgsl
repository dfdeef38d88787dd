// Counts inverted and flat triangles, finds the most inverted triangle, and marks the vertices of every counted
// triangle.

// Upper limit of the depth of an inverted triangle.
const MOST_DEPTH: f32 = 1.0e30;

fn may_move(vertex: u32) -> bool {
    return vertex < part.free && (ring_start[vertex] & HELD) == 0u;
}

// Returns the depth of a triangle, its area without the minus sign: 0 for a flat triangle, MOST_DEPTH at most and for
// areas that are not finite.
fn depth_of(area: f32) -> f32 {
    if is_positive(-area) {
        return min(-area, MOST_DEPTH);
    }
    return select(MOST_DEPTH, 0.0, is_finite(area));
}

fn look_at(t: u32) {
#if QUADRILATERALS
    for (var k = 0u; k < 4u; k++) {
        look_at_corner(own_corner(t, k));
    }
}

fn look_at_corner(places: vec3<u32>) {
    let corners = vec3(triangles[places.x], triangles[places.y], triangles[places.z]);
#else
    let corners = vec3(triangles[3u * t], triangles[3u * t + 1u], triangles[3u * t + 2u]);
#endif
    let p = position(corners.x);
    let a = edge(p, position(corners.y));
    let b = edge(p, position(corners.z));
    let map = map_of(corners);
    // The area is computed as in objective.wgsl, so that both kernels count equal triangles.
#if QUADRILATERALS
    let area = doubled_area(transformed(metric_form(Corner(a, b, Ideal())), map));
#else
    let area = doubled_area(transformed(Corner(a, b, Ideal()), map));
#endif
    if is_positive(area) {
        return;
    }
    if !(may_move(corners.x) || may_move(corners.y) || may_move(corners.z)) {
        // No sweep can repair this triangle.
        return;
    }
    atomicAdd(&tangle.inverted, 1u);
    atomicMax(&tangle.depth, bitcast<u32>(depth_of(0.5 * area / wanted_area(corners, map))));
    for (var i = 0u; i < 3u; i++) {
        atomicStore(&vertices[corners[i]].reached, tangle.sweep);
    }
}

@compute @workgroup_size(WORKGROUP)
fn find_inverted(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let count = select(part.count, 0u, tangle.valid != 0u && part.begins == 0u);
    for (var t = invocation(id, groups); t < count; t += invocations(groups)) {
        look_at(t);
    }
}
