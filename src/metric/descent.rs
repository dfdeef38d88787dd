//! Newton's direction for a Hessian that need not be positive definite.

use glam::DVec2;

/// Returns the Newton direction -H⁻¹g. The Hessian xx, xy, yy is made positive definite: its eigenvalues are replaced
/// by their absolute values, and raised to at least `floor` times the larger. Zero or not finite if there is no
/// direction.
pub(crate) fn descent(g: DVec2, [xx, xy, yy]: [f64; 3], floor: f64) -> DVec2 {
    let (mean, half) = (0.5 * (xx + yy), 0.5 * (xx - yy));
    let radius = half.hypot(xy);
    let (high, low) = ((mean + radius).abs(), (mean - radius).abs());
    let least = high.max(low) * floor;
    // H = mean + R with R² = radius², so the projector on the upper eigenvector is (1 + R/radius)/2.
    let upper = match radius > 0.0 {
        true => 0.5 * (g + DVec2::new(half * g.x + xy * g.y, xy * g.x - half * g.y) / radius),
        false => g,
    };
    -(upper / high.max(least) + (g - upper) / low.max(least))
}
