// A free vertex and the triangles around it: a patch of the one-ring `ring[start..end]`.

#if QUADRILATERALS
// Returns a vertex of the one-ring, without the mark of an opposite vertex of a quadrilateral.
fn vertex_at(entry: u32) -> u32 {
    return ring[entry] & ~OPPOSITE;
}

fn ring_edge(p: Patch, i: u32) -> vec2<f32> {
    return edge(p.at, position(vertex_at(i))) * p.unit;
}

// A corner around the vertex of a patch: the entry of the one-ring at which its element begins, and the role of the vertex.
struct Around {
    entry: u32,
    role: u32,
}

// Returns the first corner of the element that begins at an entry. An opposite vertex follows the entry if the element is a
// quadrilateral.
fn corner_from(p: Patch, entry: u32) -> Around {
    let is_triangle = entry + 1u >= p.end || (ring[entry + 1u] & OPPOSITE) == 0u;
    return Around(entry, select(OWN, TRIANGLE, is_triangle));
}

fn first_corner(p: Patch) -> Around {
    return corner_from(p, p.start);
}

// Returns the next corner around the vertex. Its entry is the end of the patch after the last corner.
fn next_corner(p: Patch, at: Around) -> Around {
    if at.role == OWN || at.role == NEXT {
        return Around(at.entry, at.role + 1u);
    }
    let next = at.entry + select(1u, 2u, at.role == LAST);
    if next >= p.end {
        return Around(p.end, TRIANGLE);
    }
    return corner_from(p, next);
}

// Returns the entries of the other two vertices of a corner, counter-clockwise.
fn others_of(p: Patch, at: Around) -> vec2<u32> {
    let next = at.entry + select(2u, 1u, at.role == TRIANGLE);
    let last = select(next, p.start, next >= p.end);
    let opposite = at.entry + 1u;
    if at.role == NEXT {
        return vec2(at.entry, opposite);
    }
    return vec2(select(at.entry, last, at.role == LAST), select(last, opposite, at.role == LAST));
}

// Returns the other vertices, counter-clockwise, of the quadrilateral that begins at an entry.
fn quadrilateral_from(p: Patch, entry: u32) -> vec3<u32> {
    let last = select(entry + 2u, p.start, entry + 2u >= p.end);
    return vec3(vertex_at(entry), vertex_at(entry + 1u), vertex_at(last));
}

// Returns a corner of the plane around the vertex, with the vertex moved by d, and makes it the present corner.
fn corner_around(p: Patch, at: Around, d: vec2<f32>) -> Corner {
    let others = others_of(p, at);
    return corner_of(p, at.role, vertex_at(others.x), vertex_at(others.y), d);
}

// Returns the target map of a corner around the vertex.
fn map_of_corner(p: Patch, at: Around) -> vec3<f32> {
    let others = others_of(p, at);
    return map_of_patch(p, vertex_at(others.x), vertex_at(others.y));
}

// Returns in x the number of neighbors of the vertex along edges, in y the sum of the weights of its corners.
fn counts_of(p: Patch) -> vec2<f32> {
    var quadrilaterals = 0u;
    for (var i = p.start; i < p.end; i++) {
        quadrilaterals += ring[i] >> 31u;
    }
    let neighbors = f32(p.end - p.start - quadrilaterals);
    return vec2(neighbors, neighbors - 0.25 * f32(quadrilaterals));
}
#else
fn ring_edge(p: Patch, i: u32) -> vec2<f32> {
    return edge(p.at, position(ring[i])) * p.unit;
}
#endif

fn patch_of(vertex: u32) -> Patch {
    let start = ring_place(ring_start[vertex]);
    let end = ring_place(ring_start[vertex + 1u]);
    let unit = unit_of(edge(position(vertex), position(ring[start])));
    return patch_around(vertex, start, end, unit);
}

#if QUADRILATERALS
// Returns the least height of a corner, as metrics see it, over its edge b - a.
fn least_height(p: Patch) -> f32 {
    var least = 3.0e38;
    for (var at = first_corner(p); at.entry < p.end; at = next_corner(p, at)) {
        let t = metric_form(corner_around(p, at, vec2(0.0)));
        least = min(least, cross2(t.a, t.b) / length(t.b - t.a));
    }
    return least;
}
#else
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
#endif
