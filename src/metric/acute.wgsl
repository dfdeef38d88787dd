// q² = imr² plus the penalties on angles of shaders/angles.wgsl, with imr = 1 + m and m = excess / area.

#if QUADRILATERALS
// The factor of imr² - 1, smaller at corners of quadrilaterals.
fn shape_share() -> f32 {
    return select(1.0, 0.3, is_right);
}

#endif
fn acute_excess(t: Corner) -> f32 {
    let i = invariants(t);
    let m = i.excess / i.area;
#if QUADRILATERALS
    return shape_share() * m * (m + 2.0) + angles_value(t, i.area);
#else
    return m * (m + 2.0) + angles_value(t, i.area);
#endif
}

fn acute_derivatives(t: Corner) -> Derivatives {
    let i = invariants(t);
    let unit = 1.0 / i.area;
    let m = i.excess * unit;
    let excess = 2.0 * (m + 1.0);
#if QUADRILATERALS
    let share = shape_share();
    let imr = Slopes(
        unit,
        share * m * (m + 2.0),
        share * excess,
        share * (-m * excess),
        share * 2.0,
        share * (-2.0 * (2.0 * m + 1.0)),
        share * (2.0 * m * (3.0 * m + 2.0)),
    );
#else
    let imr = Slopes(
        unit,
        m * (m + 2.0),
        excess,
        -m * excess,
        2.0,
        -2.0 * (2.0 * m + 1.0),
        2.0 * m * (3.0 * m + 2.0),
    );
#endif
    return with_angles(expansion(t, imr), t, unit);
}
