// Shape first and size second (TMOP's metrics μ₂ + 0.4 μ₅₆): with ε = excess / mean and
// τ = area / mean, q² = ε / τ + (τ - 1)² / 5τ.

fn soft_size_value(t: Invariants) -> f32 {
    let e = t.excess / t.mean;
    let tau = t.area / t.mean;
    let off = t.area_less_mean / t.mean;
    return (e + 0.2 * off * off) / tau;
}

fn soft_size_slopes(t: Invariants) -> Slopes {
    let scale = 1.0 / t.mean;
    let e = t.excess * scale;
    let tau = t.area * scale;
    let off = t.area_less_mean * scale;
    let inverse = t.mean / t.area;
    let square = inverse * inverse;
    return Slopes(
        scale,
        (e + 0.2 * off * off) * inverse,
        inverse,
        (0.2 * off * (tau + 1.0) - e) * square,
        0.0,
        -square,
        (2.0 * e + 0.4) * square * inverse,
    );
}
