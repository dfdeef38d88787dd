// TMOP's μ₂ + 1.5 μ₅₆: q² = ε / τ + 0.75 v (τ - 1)² / τ, with ε = excess / mean, τ = area / mean and the size
// weight v.

fn tmop_94_value(t: Invariants) -> f32 {
    return shape_and_size_value(t, 0.75);
}

fn tmop_94_slopes(t: Invariants) -> Slopes {
    return shape_and_size_slopes(t, 0.75);
}
