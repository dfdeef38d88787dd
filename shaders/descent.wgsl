// The direction of descent of a Newton step.

// Returns in xy the direction d = -H⁻¹g, with H made positive definite by absolute eigenvalues above a floor, and in z
// the slope g·d, zero without descent. Zeros if H vanishes or overflows.
fn descent(gradient: vec2<f32>, hessian: vec3<f32>) -> vec3<f32> {
    let scale = max(abs(hessian.x), max(abs(hessian.y), abs(hessian.z)));
    if !(scale > 0.0 && scale < 3.0e38) {
        return vec3(0.0);
    }
    // Scaled before any product: the determinant of an ordinary bad patch overflows.
    let g = gradient / scale;
    let h = hessian / scale;
    let mean = 0.5 * (h.x + h.z);
    let half = 0.5 * (h.x - h.z);
    let radius = length(vec2(half, h.y));
    var high = abs(mean + radius);
    var low = abs(mean - radius);
    let least = EIGENVALUE_FLOOR * max(high, low);
    high = max(high, least);
    low = max(low, least);
    // H = mean + R, R² = radius²: the projector on the upper eigenvector is (1 + R/radius)/2.
    var upper = g;
    if radius > 0.0 {
        upper = 0.5 * (g + vec2(half * g.x + h.y * g.y, h.y * g.x - half * g.y) / radius);
    }
    let direction = -(upper / high + (g - upper) / low);
    return vec3(direction, min(dot(direction, g) * scale, 0.0));
}
