// TMOP's μ₂ + 1.5 μ₅₆: q² = ε / τ + 0.75 (τ - 1)² / τ, with ε = excess / mean and τ = area / mean.

fn tmop_94_value(t: Invariants) -> f32 {
    return shape_and_size_value(t, 0.75);
}

fn tmop_94_slopes(t: Invariants) -> Slopes {
    return shape_and_size_slopes(t, 0.75);
}
