// A free vertex and the triangles around it: a patch of the one-ring `ring[start..end]`.

fn ring_edge(p: Patch, i: u32) -> vec2<f32> {
    return edge(p.at, position(ring[i])) * p.unit;
}

fn patch_of(vertex: u32) -> Patch {
    let start = ring_place(ring_start[vertex]);
    let end = ring_place(ring_start[vertex + 1u]);
    let unit = unit_of(edge(position(vertex), position(ring[start])));
    return patch_around(vertex, start, end, unit);
}

// Returns the target map of the triangle between neighbor i and the previous neighbor.
fn map_around(p: Patch, i: u32) -> vec3<f32> {
    let before = select(i - 1u, p.end - 1u, i == p.start);
    return map_of_patch(p, ring[before], ring[i]);
}

// Returns the least distance from the vertex to the line through an edge of the ring.
fn least_height(p: Patch) -> f32 {
    var least = 3.0e38;
    var a = ring_edge(p, p.end - 1u);
    for (var i = p.start; i < p.end; i++) {
        let b = ring_edge(p, i);
        least = min(least, cross2(a, b) / length(b - a));
        a = b;
    }
    return least;
}
