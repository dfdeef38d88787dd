// Shape and size (TMOP's metric 7): q = |T - T⁻ᵗ|, T = A W⁻¹, W equilateral of the mean area. With ε = excess / mean
// and τ = area / mean, q² = 2 ε (1 + 1/τ²) + 2 (τ - 1)² / τ.

fn shape_size_value(t: Invariants) -> f32 {
    let e = t.excess / t.mean;
    let off = t.area_less_mean / t.mean;
    let inverse = t.mean / t.area;
    return 2.0 * (e * (inverse * inverse + 1.0) + off * off * inverse);
}

fn shape_size_slopes(t: Invariants) -> Slopes {
    let scale = 1.0 / t.mean;
    let e = t.excess * scale;
    let tau = t.area * scale;
    let off = t.area_less_mean * scale;
    let inverse = t.mean / t.area;
    let square = inverse * inverse;
    let cube = square * inverse;
    return Slopes(
        scale,
        2.0 * (e * (square + 1.0) + off * off * inverse),
        2.0 * (square + 1.0),
        2.0 * (off * (tau + 1.0) * square - 2.0 * e * cube),
        0.0,
        -4.0 * cube,
        4.0 * cube * (3.0 * e * inverse + 1.0),
    );
}
