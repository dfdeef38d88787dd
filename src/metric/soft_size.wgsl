// TMOP's μ₂ + 0.4 μ₅₆: q² = ε / τ + 0.2 v (τ - 1)² / τ, with ε = excess / mean, τ = area / mean and the size
// weight v.

fn soft_size_value(t: Invariants) -> f32 {
    return shape_and_size_value(t, 0.2);
}

fn soft_size_slopes(t: Invariants) -> Slopes {
    return shape_and_size_slopes(t, 0.2);
}
