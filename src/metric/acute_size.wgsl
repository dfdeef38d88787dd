// q² of soft-size plus the penalties on angles of shaders/angles.wgsl.

fn acute_size_excess(t: Corner) -> f32 {
    let i = invariants(t);
    return shape_and_size_value(i, 0.2) + angles_value(t, i.area);
}

fn acute_size_derivatives(t: Corner) -> Derivatives {
    let i = invariants(t);
    return with_angles(expansion(t, shape_and_size_slopes(i, 0.2)), t, 1.0 / i.area);
}
