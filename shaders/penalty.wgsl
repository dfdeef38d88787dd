// The penalty that keeps EDGE's p-norm off the shape guard: PENALTY (imr / guard)^k with the exponent k of the p-norm,
// constant beyond the guard. The formulas are those of src/metric/smoothing.rs.

// Returns in x the shape m = excess / area, in y the ratio imr / guard.
fn penalized_shape(t: Corner) -> vec2<f32> {
    let i = invariants(t);
    let m = i.excess / i.area;
    return vec2(m, (m + 1.0) * inverse_penalty_guard);
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
    if inverse_penalty_guard == 0.0 {
        return norm;
    }
    return norm + penalty_at(penalized_shape(t).y);
}

fn smoothed_derivatives(t: Corner) -> Derivatives {
    let norm = edge_derivatives(t);
    if inverse_penalty_guard == 0.0 {
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
    // The derivatives by excess and area, from those by m = excess / area.
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
