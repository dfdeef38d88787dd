// Relative deviation of the area from the mean: q = |S/S_mean - 1|. q² is quadratic in one vertex.

fn area_value(t: Invariants) -> f32 {
    let q = t.area / t.mean - 1.0;
    return q * q;
}

fn area_slopes(t: Invariants) -> Slopes {
    let inverse = 1.0 / t.mean;
    let q = t.area * inverse - 1.0;
    return Slopes(q * q, 0.0, 2.0 * q * inverse, 0.0, 0.0, 2.0 * inverse * inverse);
}
