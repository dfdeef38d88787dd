// Relative deviation of the area from the mean: q = |S/S_mean - 1|. q² is quadratic in one vertex.

fn area_excess(t: Corner) -> f32 {
    let q = 0.5 * doubled_area(t) / t.mean_area - 1.0;
    return q * q;
}

fn area_model(t: Corner) -> f32 {
    return area_excess(t);
}

fn area_derivatives(t: Corner) -> Derivatives {
    let scale = 0.5 / t.mean_area;
    let q = doubled_area(t) * scale - 1.0;
    let dq = area_gradient(t) * scale;
    return Derivatives(q * q, 2.0 * q * dq, symmetric(dq, dq));
}
