// Moves the free vertices of a color by a Newton step that lowers the energy of their patch. At first only vertices of
// inverted triangles move, and each further sweep adds the vertices one edge farther off.

// First trial length, as a multiple of Newton's step. A long step cannot cross a barrier, as the energy has none. A
// first length of 1 was measured to take twice as many sweeps.
const OVER_RELAXATION: f32 = 1.7;

// Returns whether the vertex moves in this sweep. Marks a vertex with a neighbor that moved before.
fn joins_in(vertex: u32, first: u32, end: u32) -> bool {
    let own = atomicLoad(&vertices[vertex].reached);
    if own >= tangle.since && own <= tangle.sweep {
        return true;
    }
    for (var i = first; i < end; i++) {
#if QUADRILATERALS
        let near = atomicLoad(&vertices[vertex_at(i)].reached);
#else
        let near = atomicLoad(&vertices[ring[i]].reached);
#endif
        if near >= tangle.since && near < tangle.sweep {
            atomicStore(&vertices[vertex].reached, tangle.sweep);
            return true;
        }
    }
    return false;
}

// Returns the patch of a vertex, scaled by the longest edge, as other edges may have zero length.
fn tangled_patch_of(vertex: u32) -> Patch {
    var p = patch_of(vertex);
    var longest = vec2(0.0);
    for (var i = p.start; i < p.end; i++) {
#if QUADRILATERALS
        longest = max(longest, abs(edge(p.at, position(vertex_at(i)))));
#else
        longest = max(longest, abs(edge(p.at, position(ring[i]))));
#endif
    }
    p.unit = unit_of(longest);
    return p;
}

// Returns the longest allowed step along an axis: twice the larger of the shortest edge and the desired edge length. A
// distant vertex has only long edges and returns at once. Neighbors of a distant vertex have short edges too, and
// cannot follow.
fn reach(p: Patch, vertex: u32) -> f32 {
    var shortest = 3.0e38;
    for (var i = p.start; i < p.end; i++) {
        let e = abs(ring_edge(p, i));
        shortest = min(shortest, max(e.x, e.y));
    }
    return 2.0 * max(shortest, sqrt(vertices[vertex].area) * p.unit);
}

#if !QUADRILATERALS
// Returns a triangle of the patch with the vertex moved by d, transformed by the triangle's target map.
fn triangle_at(p: Patch, before: u32, i: u32, d: vec2<f32>, map: vec3<f32>) -> Corner {
    return transformed(Corner(ring_edge(p, before) - d, ring_edge(p, i) - d, Ideal()), map);
}
#endif

// Returns ε in the unit of the triangle's doubled area, at least 1e-30 so that nothing is divided by zero.
fn epsilon_of(p: Patch, corners: vec3<u32>, map: vec3<f32>) -> f32 {
    let wanted = 2.0 * wanted_area(corners, map);
    return max((tangle.epsilon * p.unit) * (wanted * p.unit), 1.0e-30);
}

#if QUADRILATERALS
// Returns ε of a corner of an element around a vertex.
fn epsilon_in(p: Patch, vertex: u32, e: Element, role: u32, map: vec3<f32>) -> f32 {
    return epsilon_of(p, vec3(vertex, others_of(e.vertices, role)), map);
}

#endif
fn energy_of_patch(p: Patch, vertex: u32, d: vec2<f32>) -> f32 {
    var sum = 0.0;
#if QUADRILATERALS
    for (var at = first_element(p); at.entry < p.end; at = next_element(p, at)) {
        for (var role = at.first_role; role <= at.last_role; role++) {
            let map = map_in(p, at.element, role);
            let epsilon = epsilon_in(p, vertex, at.element, role, map);
            let t = transformed(metric_form(corner_in(p, at.element, role, d)), map);
            sum += corner_weight * energy(t, epsilon);
        }
    }
#else
    var before = p.end - 1u;
    for (var i = p.start; i < p.end; i++) {
        let map = map_around(p, i);
        let epsilon = epsilon_of(p, vec3(vertex, ring[before], ring[i]), map);
        sum += energy(triangle_at(p, before, i, d, map), epsilon);
        before = i;
    }
#endif
    return sum;
}

// Returns a Newton step after its line search, in the patch's unit; zero if no trial lowers the energy.
fn untangling_step(p: Patch, vertex: u32) -> vec2<f32> {
    var sum = Derivatives(0.0, vec2(0.0), vec3(0.0));
#if QUADRILATERALS
    for (var at = first_element(p); at.entry < p.end; at = next_element(p, at)) {
        for (var role = at.first_role; role <= at.last_role; role++) {
            let map = map_in(p, at.element, role);
            let epsilon = epsilon_in(p, vertex, at.element, role, map);
            let t = transformed(metric_form(corner_in(p, at.element, role, vec2(0.0))), map);
            let d = pulled_back(energy_derivatives(t, epsilon), map);
            sum.value += corner_weight * d.value;
            sum.gradient += corner_weight * d.gradient;
            sum.hessian += corner_weight * d.hessian;
        }
    }
#else
    var before = p.end - 1u;
    for (var i = p.start; i < p.end; i++) {
        let map = map_around(p, i);
        let epsilon = epsilon_of(p, vec3(vertex, ring[before], ring[i]), map);
        let t = triangle_at(p, before, i, vec2(0.0), map);
        let d = pulled_back(energy_derivatives(t, epsilon), map);
        sum.value += d.value;
        sum.gradient += d.gradient;
        sum.hessian += d.hessian;
        before = i;
    }
#endif
    let inverse = inverse_of(p.own * p.map_unit);
    let seen = pulled_back(sum, inverse);
    var down = descent(seen.gradient, seen.hessian);
    if MAPPED {
        down = vec3(mapped(inverse, down.xy), down.z);
    }
    if down.z >= 0.0 || !is_finite(sum.value) || !(is_finite(down.x) && is_finite(down.y)) {
        return vec2(0.0);
    }
    let farthest = reach(p, vertex) / max(abs(down.x), abs(down.y));
    var length = min(OVER_RELAXATION, farthest);
    for (var trial = 0u; trial < TRIALS; trial++) {
        let d = down.xy * length;
        let there = energy_of_patch(p, vertex, d);
        let enough = sum.value * (1.0 + SLACK) + SUFFICIENT_DECREASE * length * down.z;
        if is_finite(there) && there <= enough {
            return d;
        }
        length *= SHORTEN;
    }
    return vec2(0.0);
}

fn visit(vertex: u32) {
    let start = ring_start[vertex];
    if (start & HELD) != 0u {
        return;
    }
    if !joins_in(vertex, ring_place(start), ring_place(ring_start[vertex + 1u])) {
        return;
    }
    let p = tangled_patch_of(vertex);
    let d = untangling_step(p, vertex);
    if any(d != vec2(0.0)) {
        set_position(vertex, advanced(p.at, d / p.unit));
    }
}

@compute @workgroup_size(WORKGROUP)
fn untangle(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let count = select(part.count, 0u, tangle.valid != 0u);
    for (var i = invocation(id, groups); i < count; i += invocations(groups)) {
        visit(part.first + i);
    }
}
