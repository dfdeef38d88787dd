// Relative deviation of the area from the mean: q = |S/S_mean - 1|. q² is a quadratic function of one vertex.

fn area_value(t: Invariants) -> f32 {
    let q = t.area_less_mean / t.mean;
    return q * q;
}

fn area_slopes(t: Invariants) -> Slopes {
    let q = t.area_less_mean / t.mean;
    return Slopes(1.0 / t.mean, q * q, 0.0, 2.0 * q, 0.0, 0.0, 2.0);
}
