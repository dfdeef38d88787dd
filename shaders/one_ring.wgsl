// A free vertex and the triangles around it: a patch of the one-ring `ring[start..end]`.

#if QUADRILATERALS
// Returns a vertex of the one-ring, without the mark of an opposite vertex of a quadrilateral.
fn vertex_at(entry: u32) -> u32 {
    return ring[entry] & ~OPPOSITE;
}

fn ring_edge(p: Patch, i: u32) -> vec2<f32> {
    return edge(p.at, position(vertex_at(i))) * p.unit;
}

// An element around the vertex of a patch, the entry of the one-ring at which the element begins, the entry after the element, the
// position of the element's last vertex, and the roles of the visited vertex in the element's first and last corner.
struct Around {
    element: Element,
    entry: u32,
    end: u32,
    last_at: vec4<f32>,
    first_role: u32,
    last_role: u32,
}

// Returns the element that begins at an entry, given the position of its next vertex and the edge to that vertex. An opposite vertex
// follows the entry if the element is a quadrilateral.
fn element_from(p: Patch, entry: u32, next_at: vec4<f32>, next: vec2<f32>) -> Around {
    let is_triangle = entry + 1u >= p.end || (ring[entry + 1u] & OPPOSITE) == 0u;
    let end = entry + select(2u, 1u, is_triangle);
    let last = vertex_at(select(end, p.start, end >= p.end));
    let last_at = position(last);
    var e: Element;
    e.vertices = vec3(vertex_at(entry), last, last);
    e.next = next;
    e.last = edge(p.at, last_at) * p.unit;
    if is_triangle {
        return Around(e, entry, end, last_at, TRIANGLE, TRIANGLE);
    }
    e.vertices.y = vertex_at(entry + 1u);
    let opposite_at = position(e.vertices.y);
    e.from_next = edge(next_at, opposite_at) * p.unit;
    e.from_last = edge(last_at, opposite_at) * p.unit;
    return Around(e, entry, end, last_at, OWN, LAST);
}

fn first_element(p: Patch) -> Around {
    let next_at = position(vertex_at(p.start));
    return element_from(p, p.start, next_at, edge(p.at, next_at) * p.unit);
}

// Returns the next element around the vertex. Its entry is the end of the patch after the last element.
fn next_element(p: Patch, at: Around) -> Around {
    if at.end >= p.end {
        var none = at;
        none.entry = p.end;
        return none;
    }
    return element_from(p, at.end, at.last_at, at.element.last);
}

// Returns the entries of the vertices of an element other than the vertex of the patch.
fn entries_of(p: Patch, at: Around) -> vec3<u32> {
    let last = select(at.end, p.start, at.end >= p.end);
    return vec3(at.entry, select(last, at.entry + 1u, at.first_role == OWN), last);
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
    for (var at = first_element(p); at.entry < p.end; at = next_element(p, at)) {
        for (var role = at.first_role; role <= at.last_role; role++) {
            let t = metric_form(corner_in(p, at.element, role, vec2(0.0)));
            least = min(least, cross2(t.a, t.b) / length(t.b - t.a));
        }
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
