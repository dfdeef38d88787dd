// Shape and size, the milder of the balanced ones (TMOP's metric 94, μ₂ + 1.5 μ₅₆): with ε = excess / mean and
// τ = area / mean, q² = ε / τ + 3 (τ - 1)² / 4τ.

fn tmop_94_value(t: Invariants) -> f32 {
    let e = t.excess / t.mean;
    let tau = t.area / t.mean;
    let off = t.area_less_mean / t.mean;
    return (e + 0.75 * off * off) / tau;
}

fn tmop_94_slopes(t: Invariants) -> Slopes {
    let scale = 1.0 / t.mean;
    let e = t.excess * scale;
    let tau = t.area * scale;
    let off = t.area_less_mean * scale;
    let inverse = t.mean / t.area;
    let square = inverse * inverse;
    return Slopes(
        scale,
        (e + 0.75 * off * off) * inverse,
        inverse,
        (0.75 * off * (tau + 1.0) - e) * square,
        0.0,
        -square,
        (2.0 * e + 1.5) * square * inverse,
    );
}
