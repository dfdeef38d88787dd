// Takes up the places of sliding vertices that an application has moved: along its curve, a vertex goes on sliding from its new
// place, and off its curve it stays. Also releases vertices that earlier sweeps have pressed against bounds.

// Distance from a curve within which a vertex counts as on the curve, as a share of the length of the line there. Vertex
// buffers in single precision round positions on large meshes by up to 1e-4 of an edge.
const ON_CURVE: f32 = 1e-3;
// Number of pieces of the curve, ahead and behind, in which a vertex is sought. A move sideways leaves the curve.
const SEARCHED: u32 = 32u;

// Returns whether a vertex and its partner are at a parameter.
fn is_at(v: SlidingVertex, param: vec2<f32>, near: u32) -> bool {
    for (var side = 0u; side < 2u; side++) {
        if v.vertices[side] == NONE {
            break;
        }
        let there = on_curve(v, side, param, near);
        let off = length(edge(there.at, position(v.vertices[side])));
        if off > ON_CURVE * knots[v.knots + there.piece].length {
            return false;
        }
    }
    return true;
}

// Returns the parameter nearest to a vertex in a piece of its curve.
fn nearest_in(v: SlidingVertex, piece: u32) -> vec2<f32> {
    let knot = knots[v.knots + piece];
    let line = edge(knot.at, knots[v.knots + piece + 1u].at);
    let share = dot(edge(knot.at, position(v.vertices.x)), line) / dot(line, line);
    return pair_add(knot.param, vec2(clamp(share, 0.0, 1.0) * knot.length, 0.0));
}

// Returns the parameter on the turn around a closed curve that is nearest to another parameter.
fn on_turn_of(v: SlidingVertex, param: vec2<f32>, other: vec2<f32>) -> vec2<f32> {
    var near = param;
    if v.is_closed == 0u {
        return near;
    }
    let period = period_of(v);
    for (var turn = 0u; turn < MOST_TURNS; turn++) {
        let off = pair_difference(near, other);
        if abs(off) <= 0.5 * period.x {
            break;
        }
        near = pair_add(near, select(period, -period, off > 0.0));
    }
    return near;
}

@compute @workgroup_size(WORKGROUP)
fn take_up(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let index = invocation(id, groups);
    if index >= arrayLength(&sliding) {
        return;
    }
    let v = sliding[index];
    let known = places[v.place];
    places[v.place].presses = 0;
    if is_at(v, known.param, known.piece) {
        return;
    }
    places[v.place].presses = i32(OFF_CURVE);
    let pieces = i32(v.knot_count) - 1;
    for (var i = 0u; i < 2u * SEARCHED; i++) {
        let step = i32(i / 2u);
        var piece = i32(known.piece) + select(-1 - step, step, i % 2u == 0u);
        if v.is_closed != 0u {
            piece = ((piece % pieces) + pieces) % pieces;
        } else if piece < 0 || piece >= pieces {
            continue;
        }
        let param = nearest_in(v, u32(piece));
        if is_at(v, param, u32(piece)) {
            places[v.place] = CurvePlace(on_turn_of(v, param, known.param), u32(piece), 0);
            return;
        }
    }
}
