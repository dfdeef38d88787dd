// Visits the sliding vertices of one color by safeguarded Newton steps along their curves, the steps of
// src/slide/newton.rs. A vertex and its partner move together, by the sum of their objectives.

// A vertex of a visit with the triangles around it, `corners[start..end]`.
var<private> patches: array<Patch, 2>;
// Number of patches: 2 for a vertex with a partner, else 1.
var<private> sides: u32;
var<private> visited: SlidingVertex;
// The parameters of the vertex and of its neighbors.
var<private> window: Window;
// The points of each curve at the parameters of the window.
var<private> before: array<OnCurve, 2>;
var<private> here: array<OnCurve, 2>;
var<private> after: array<OnCurve, 2>;
// The points of each curve in a trial. Compilers copy functions to where they are called, so points are computed in few
// places.
var<private> there: array<OnCurve, 2>;

// The parameters of a vertex and of its two neighbors on the curve.
struct Window {
    low: vec2<f32>,
    at: vec2<f32>,
    high: vec2<f32>,
}

// The objective as a function of the length along the curve, in the unit of the patches, and the largest inverse mean ratio
// that a step may leave.
struct AlongCurve {
    value: f32,
    slope: f32,
    curvature: f32,
    limit: f32,
}

// Returns a triangle of a patch in the plane, with the vertex moved by d.
fn corner_around(p: Patch, i: u32, d: vec2<f32>) -> Corner {
#if QUADRILATERALS
    let others = others_at(i);
    return corner_of(p, role_of(i), others.x, others.y, d);
}

// Returns the other two vertices of a corner, without the marks of the role.
fn others_at(i: u32) -> vec2<u32> {
    return corners[i] & vec2(~OPPOSITE);
}

// Returns the role of the sliding vertex in a corner, from the marks of the other two vertices.
fn role_of(i: u32) -> u32 {
    return (corners[i].x >> 31u) + 2u * (corners[i].y >> 31u);
}

// Returns the quadrilateral whose first corner has this index.
fn quadrilateral_from(p: Patch, i: u32) -> Element {
    return quadrilateral_of(p, vec3(corners[i].x, corners[i + 1u].y, corners[i].y) & vec3(~OPPOSITE));
}

// Returns the sum of the weights of the corners of a patch.
fn weight_of(p: Patch) -> f32 {
    var sum = 0.0;
    for (var i = p.start; i < p.end; i++) {
        sum += select(0.25, 1.0, role_of(i) == TRIANGLE);
    }
    return sum;
}
#else
    let a = edge(p.at, position(corners[i].x)) * p.unit - d;
    let b = edge(p.at, position(corners[i].y)) * p.unit - d;
    return Corner(a, b, p.ideal);
}
#endif

fn along_curve() -> AlongCurve {
    var found = AlongCurve(0.0, 0.0, 0.0, part.shape_guard);
    for (var side = 0u; side < sides; side++) {
        let p = patches[side];
        var value = 0.0;
        var gradient = vec2(0.0);
        var hessian = vec3(0.0);
        for (var i = p.start; i < p.end; i++) {
#if QUADRILATERALS
            let others = others_at(i);
            let map = map_of_patch(p, others.x, others.y);
            let t = transformed(metric_form(corner_around(p, i, vec2(0.0))), map);
#else
            let map = map_of_patch(p, corners[i].x, corners[i].y);
            let t = transformed(corner_around(p, i, vec2(0.0)), map);
#endif
            if part.shape_guard < NO_GUARD {
                found.limit = max(found.limit, inverse_mean_ratio(t));
            }
#if OPPOSITE_ANGLES
            var d = pulled_back(metric_derivatives(t, 0.0), map);
            if role_of(i) == OWN {
                let joined = opposite_angle_derivatives(p, quadrilateral_from(p, i));
                d.value += joined.value;
                d.gradient += joined.gradient;
                d.hessian += joined.hessian;
            }
#else
            let d = pulled_back(metric_derivatives(t, 0.0), map);
#endif
            value += d.value;
            gradient += d.gradient;
            hessian += d.hessian;
        }
        let first = here[side].first;
        found.value += value;
        found.slope += dot(gradient, first);
        let bent = dot(gradient, here[side].second) / p.unit;
        found.curvature += hessian.x * first.x * first.x + 2.0 * hessian.y * first.x * first.y
            + hessian.z * first.y * first.y + bent;
    }
    return found;
}

// Returns the distance of a point from the line between two other points, and more than that by the error of single
// precision.
fn distance_to_line(point: vec4<f32>, start: vec4<f32>, end: vec4<f32>) -> f32 {
    let line = edge(start, end);
    let to = edge(start, point);
    let size = length(line);
    let share = dot(to, line) / (size * size);
    var off = length(to - line * clamp(share, 0.0, 1.0));
    if share > 0.0 && share < 1.0 {
        // Exact on lines parallel to an axis.
        off = abs(cross2(to, line)) / size;
    }
    return off + CURVE_ERROR * size;
}

// Returns whether the vertex in a trial is in reach of its given position, and whether the lines to its neighbors pass near
// all given vertices between them.
fn is_near(side: u32, to: vec2<f32>) -> bool {
    let v = visited;
    let first = v.knots + side * v.knot_count;
    // The error of a point grows with the length of its line, on which a short move may end.
    let error = CURVE_ERROR * knots[first + there[side].piece].length;
    if length(edge(knots[first + v.own].at, there[side].at)) + error > v.reach {
        return false;
    }
    // Ways from the neighbor before.
    let middle = pair_difference(to, window.low);
    let end = pair_difference(window.high, window.low);
    var knot = before[side].piece;
    var way = knots[first + knot].length - before[side].way;
    for (var i = 0u; i < v.knot_count && way < end; i++) {
        knot++;
        if knot + 1u >= v.knot_count {
            if v.is_closed == 0u {
                break;
            }
            knot = 0u;
        }
        let given = knots[first + knot];
        let is_before = way < middle;
        let start = select(there[side].at, before[side].at, is_before);
        let stop = select(after[side].at, there[side].at, is_before);
        if distance_to_line(given.at, start, stop) > given.bound {
            return false;
        }
        way += given.length;
    }
    return true;
}

// Returns whether the vertex keeps all bounds at a parameter, and writes the points of the trial.
fn is_within_bounds(to: vec2<f32>) -> bool {
    for (var side = 0u; side < sides; side++) {
        there[side] = on_curve(visited, side, to, here[side].piece);
        if !is_near(side, to) {
            return false;
        }
    }
    return true;
}

// Returns in x the objective with the vertex at a parameter, and in y whether the position is feasible: 0 if a triangle is
// inverted or breaks a bound, or if a line leaves the given vertices.
fn objective_at(to: vec2<f32>, limit: f32) -> vec2<f32> {
    if !is_within_bounds(to) {
        return vec2(0.0);
    }
    var sum = 0.0;
    for (var side = 0u; side < sides; side++) {
        let p = patches[side];
        let d = edge(p.at, there[side].at) * p.unit;
        for (var i = p.start; i < p.end; i++) {
            let moved = corner_around(p, i, d);
#if QUADRILATERALS
            let others = others_at(i);
            let t = transformed(metric_form(moved), map_of_patch(p, others.x, others.y));
#else
            let t = transformed(moved, map_of_patch(p, corners[i].x, corners[i].y));
#endif
            if !is_positive(doubled_area(t)) {
                return vec2(0.0);
            }
#if QUADRILATERALS
            let was = moved_back(moved, d);
            if BOUNDED && !keeps_altitude(was.a, was.b, moved.a, moved.b, p.unit) {
#else
            if BOUNDED && !keeps_altitude(moved.a + d, moved.b + d, moved.a, moved.b, p.unit) {
#endif
                return vec2(0.0);
            }
            if limit < NO_GUARD && inverse_mean_ratio(t) > limit {
                return vec2(0.0);
            }
            sum += metric_model(t);
#if OPPOSITE_ANGLES
            if role_of(i) == OWN {
                sum += opposite_angles(p, quadrilateral_from(p, i), d);
            }
#endif
        }
    }
    return vec2(sum, 1.0);
}

// Returns the share of a way along the curve that keeps the bounds: 1 if the whole way does.
fn share_within_bounds(way: f32) -> f32 {
    var inside = 0.0;
    var outside = 1.0;
    var tried = 1.0;
    for (var i = 0u; i <= HALVINGS && inside < 1.0; i++) {
        if is_within_bounds(moved_along(way * tried)) {
            inside = tried;
        } else {
            outside = tried;
        }
        tried = 0.5 * (inside + outside);
    }
    return inside;
}

fn moved_along(way: f32) -> vec2<f32> {
    return pair_add(window.at, vec2(way, 0.0));
}

// Moves the vertex by a Newton step along the curve. Returns 1 or -1 if the step led beyond a bound, toward larger or smaller
// parameters, and 0 otherwise.
fn slid() -> i32 {
    let now = along_curve();
    let unit = patches[0].unit;
    let newton = -now.slope / abs(now.curvature) / unit;
    if !is_finite(newton) {
        return 0;
    }
    let back = MAX_STEP_SHARE * pair_difference(window.low, window.at);
    let ahead = MAX_STEP_SHARE * pair_difference(window.high, window.at);
    var way = clamp(newton, back, ahead);
    let share = share_within_bounds(way);
    let pressed = select(0, select(-1, 1, way > 0.0), share < 1.0);
    way *= share;
#if QUADRILATERALS
    var weight = weight_of(patches[0]);
    if sides == 2u {
        weight += weight_of(patches[1]);
    }
    let slack = SLACK * (now.value + weight * IDEAL_SQUARED);
#else
    let triangles = patches[0].end - patches[0].start
        + select(0u, patches[1].end - patches[1].start, sides == 2u);
    let slack = SLACK * (now.value + f32(triangles) * IDEAL_SQUARED);
#endif
    let decrease = SUFFICIENT_DECREASE * now.slope * way * unit;
    var length = 1.0;
    for (var trial = 0u; trial < TRIALS; trial++) {
        let to = moved_along(way * length);
        let tried = objective_at(to, now.limit);
        if tried.y == 0.0 {
            length *= SHORTEN_INFEASIBLE;
        } else if tried.x <= now.value + decrease * length + slack {
            move_to(to);
            break;
        } else {
            length *= SHORTEN;
        }
    }
    return pressed;
}

// Moves the vertex to a parameter, for which the points of the trial are known.
fn move_to(to: vec2<f32>) {
    let is_between = pair_less(window.low, to) && pair_less(to, window.high);
    if !is_between || all(to == window.at) {
        return;
    }
    for (var side = 0u; side < sides; side++) {
        set_position(visited.vertices[side], there[side].at);
    }
    places[visited.place].piece = there[0].piece;
    places[visited.place].param = to;
}

@compute @workgroup_size(WORKGROUP)
fn slide(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let index = invocation(id, groups);
    if index >= part.count || control.done != 0u {
        return;
    }
    sharpness = part.sharpness;
    inverse_penalty_guard = part.inverse_penalty_guard;
    visited = sliding[part.first + index];
    let place = places[visited.place];
    if abs(place.presses) >= i32(FREEZES_AFTER) || (visited.pinned | visited.masked) != 0u {
        return;
    }
    window = Window(places[visited.low].param, place.param, places[visited.high].param);
    // On a closed curve, a neighbor of the first vertex and a neighbor of the last vertex have parameters of another turn.
    if visited.low >= visited.place {
        window.low = pair_add(window.low, -period_of(visited));
    }
    if visited.high <= visited.place {
        window.high = pair_add(window.high, period_of(visited));
    }
    let unit = unit_of(edge(
        position(visited.vertices.x),
#if QUADRILATERALS
        position(others_at(visited.first_corner).x),
#else
        position(corners[visited.first_corner].x),
#endif
    ));
    sides = 1u;
    patches[0] = patch_around(
        visited.vertices.x,
        visited.first_corner,
        visited.partner_corner,
        unit,
    );
    if visited.vertices.y != NONE {
        sides = 2u;
        patches[1] = patch_around(
            visited.vertices.y,
            visited.partner_corner,
            visited.last_corner,
            unit,
        );
    }
    for (var i = 0u; i < 3u * sides; i++) {
        let side = i / 3u;
        let which = i % 3u;
        let param = select(select(window.high, window.at, which == 1u), window.low, which == 0u);
        let point = on_curve(visited, side, param, place.piece);
        if which == 0u {
            before[side] = point;
        } else if which == 1u {
            here[side] = point;
        } else {
            after[side] = point;
        }
    }
    let pressed = slid();
    let is_same = pressed * place.presses > 0;
    places[visited.place].presses = pressed + select(0, place.presses, is_same);
}
