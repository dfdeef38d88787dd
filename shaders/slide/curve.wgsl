// Curves on which vertices slide: the points of `Curve` in src/slide/curve.rs, as the same functions of the parameter.

// Most turns around a closed curve by which a parameter leaves the first turn.
const MOST_TURNS: u32 = 16u;

// A point of a curve with its derivatives by the parameter: the first is the tangent, of about unit length.
struct OnCurve {
    at: vec4<f32>,
    first: vec2<f32>,
    second: vec2<f32>,
    // Index of the last knot before the parameter, from 0 at the start of the curve, and the distance from this knot.
    piece: u32,
    way: f32,
}

// Returns the length of the lines of a curve, which is the period of a closed curve.
fn period_of(v: SlidingVertex) -> vec2<f32> {
    return knots[v.knots + v.knot_count - 1u].param;
}

// Returns the equivalent parameter in the first turn around a closed curve.
fn wrapped(v: SlidingVertex, param: vec2<f32>) -> vec2<f32> {
    var within = param;
    if v.is_closed == 0u {
        return within;
    }
    let period = period_of(v);
    for (var turn = 0u; turn < MOST_TURNS; turn++) {
        if pair_less(within, vec2(0.0)) {
            within = pair_add(within, period);
        } else if !pair_less(within, period) {
            within = pair_add(within, -period);
        } else {
            break;
        }
    }
    return within;
}

// Returns the index of the knot at which the piece with a parameter of the first turn begins. The search begins at the knot `near`.
fn piece_at(v: SlidingVertex, param: vec2<f32>, near: u32) -> u32 {
    var piece = min(near, v.knot_count - 2u);
    while piece + 2u < v.knot_count && !pair_less(param, knots[v.knots + piece + 1u].param) {
        piece++;
    }
    while piece > 0u && pair_less(param, knots[v.knots + piece].param) {
        piece--;
    }
    return piece;
}

// Returns the point at a parameter, on the vertex's own curve (`side` 0) or on the curve of its partner (1). The result does
// not depend on `near`, the number of a knot, but is found fastest if the knot is near.
fn on_curve(v: SlidingVertex, side: u32, param: vec2<f32>, near: u32) -> OnCurve {
    let here = wrapped(v, param);
    let piece = piece_at(v, here, near);
    let knot = knots[v.knots + side * v.knot_count + piece];
    let line = edge(knot.at, knots[v.knots + side * v.knot_count + piece + 1u].at);
    let a = knot.slopes.x;
    let b = knot.slopes.y;
    let way = pair_difference(here, knot.param);
    let u = clamp(way / knot.length, 0.0, 1.0);
    let w = 1.0 - u;
    let across = vec2(-line.y, line.x);
    let height = u * w * (w * a - u * b);
    let slope = a * w * (1.0 - 3.0 * u) + b * u * (3.0 * u - 2.0);
    let bend = a * (6.0 * u - 4.0) + b * (6.0 * u - 2.0);
    return OnCurve(
        // On a line parallel to an axis, one coordinate stays exactly equal to that of both ends.
        advanced(knot.at, line * u + across * height),
        line / knot.length + across * (slope / knot.length),
        across * (bend / knot.length / knot.length),
        piece,
        way,
    );
}
