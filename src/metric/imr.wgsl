// Inverse mean ratio q = 1 + m, with m = excess / area: q² - 1 = m (m + 2), free of cancellation (Munson 2007).

fn imr_value(t: Invariants) -> f32 {
    let m = t.excess / t.area;
    return m * (m + 2.0);
}

fn imr_slopes(t: Invariants) -> Slopes {
    let unit = 1.0 / t.area;
    let m = t.excess * unit;
    let excess = 2.0 * (m + 1.0);
    return Slopes(
        unit,
        m * (m + 2.0),
        excess,
        -m * excess,
        2.0,
        -2.0 * (2.0 * m + 1.0),
        2.0 * m * (3.0 * m + 2.0),
    );
}
