// q² = imr² plus the penalties on angles of shaders/angles.wgsl, with imr = 1 + m and m = excess / area.

fn acute_excess(t: Corner) -> f32 {
    let i = invariants(t);
    let m = i.excess / i.area;
    return m * (m + 2.0) + angles_value(t, i.area);
}

fn acute_derivatives(t: Corner) -> Derivatives {
    let i = invariants(t);
    let unit = 1.0 / i.area;
    let m = i.excess * unit;
    let excess = 2.0 * (m + 1.0);
    let imr = Slopes(
        unit,
        m * (m + 2.0),
        excess,
        -m * excess,
        2.0,
        -2.0 * (2.0 * m + 1.0),
        2.0 * m * (3.0 * m + 2.0),
    );
    return with_angles(expansion(t, imr), t, unit);
}
