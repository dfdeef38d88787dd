// Shape and size in equal parts (TMOP's metric 80 with γ = 1/2): with ε = excess / mean and τ = area / mean,
// q² = ε / 2τ + v (τ - 1/τ)² / 4 with the size weight v, and τ - 1/τ = (τ - 1) (τ + 1) / τ.

fn tmop_80_value(t: Invariants) -> f32 {
    let e = t.excess / t.mean;
    let tau = t.area / t.mean;
    let off = t.area_less_mean / t.mean;
    let size = off * (tau + 1.0) / tau;
    return 0.5 * e / tau + 0.25 * t.size_weight * size * size;
}

fn tmop_80_slopes(t: Invariants) -> Slopes {
    let scale = 1.0 / t.mean;
    let e = t.excess * scale;
    let tau = t.area * scale;
    let off = t.area_less_mean * scale;
    let inverse = t.mean / t.area;
    let square = inverse * inverse;
    let size = off * (tau + 1.0) * inverse;
    let weight = t.size_weight;
    return Slopes(
        scale,
        0.5 * e * inverse + 0.25 * weight * size * size,
        0.5 * inverse,
        0.5 * (weight * size * (square + 1.0) - e * square),
        0.0,
        -0.5 * square,
        e * square * inverse + 0.5 * weight * (3.0 * square * square + 1.0),
    );
}
