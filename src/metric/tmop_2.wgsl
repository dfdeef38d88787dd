// TMOP's μ₂, the inverse mean ratio less one: q² = excess / area.

fn tmop_2_value(t: Invariants) -> f32 {
    return t.excess / t.area;
}

fn tmop_2_slopes(t: Invariants) -> Slopes {
    let unit = 1.0 / t.area;
    let m = t.excess * unit;
    return Slopes(unit, m, 1.0, -m, 0.0, -1.0, 2.0 * m);
}
