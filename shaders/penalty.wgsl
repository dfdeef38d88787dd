// The penalty in front of the shape guard, which is added to EDGE's p-norm with the same exponent k: PENALTY (ratio / guard)^k of the
// inverse mean ratio, constant beyond the guard. The same as src/metric/smoothing.rs.

// x is the shape m = excess / area, y the inverse mean ratio over that of the guard.
fn penalized_shape(t: Corner) -> vec2<f32> {
    let i = invariants(t);
    let m = i.excess / i.area;
    return vec2(m, (m + 1.0) * over_guard);
}

fn penalty_at(ratio: f32) -> f32 {
    var power = min(ratio, 1.0);
    for (var i = 0u; i < sharpness; i++) {
        power *= power;
    }
    return PENALTY * power;
}

fn smoothed_model(t: Corner) -> f32 {
    let norm = edge_model(t);
    if over_guard == 0.0 {
        return norm;
    }
    return norm + penalty_at(penalized_shape(t).y);
}

fn smoothed_derivatives(t: Corner) -> Derivatives {
    let norm = edge_derivatives(t);
    if over_guard == 0.0 {
        return norm;
    }
    let shape = penalized_shape(t);
    if shape.y >= 1.0 {
        return Derivatives(norm.value + PENALTY, norm.gradient, norm.hessian);
    }
    let m = shape.x;
    let k = f32(1u << sharpness);
    let per_shape = 1.0 / (m + 1.0);
    let value = penalty_at(shape.y);
    let first = value * per_shape * k;
    let second = first * per_shape * (k - 1.0);
    // By excess and area, of which m is the ratio.
    let penalty = expansion(t, Slopes(
        1.0 / doubled_area(t),
        value,
        first,
        -m * first,
        second,
        -(first + m * second),
        m * (m * second + 2.0 * first),
    ));
    return Derivatives(
        norm.value + penalty.value,
        norm.gradient + penalty.gradient,
        norm.hessian + penalty.hessian,
    );
}
