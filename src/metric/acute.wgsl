// q² = imr² + 300 Σ ψ(0.2 - cot) + 30 Σ ψ(cot - 1.3), with the sums over the cotangents of the three angles, and ψ of
// the Rust struct Hinge (src/metric/hinge.rs) with the ramp 0.2.

const ACUTE_RAMP: f32 = 0.2;

// The value and the first two derivatives of ψ.
fn acute_hinge(x: f32) -> vec3<f32> {
    let excess = max(x, 0.0);
    let beyond = max(excess - ACUTE_RAMP, 0.0);
    let t = excess - beyond;
    return vec3(
        t * t * t / (3.0 * ACUTE_RAMP) + beyond * (beyond + ACUTE_RAMP),
        t * t / ACUTE_RAMP + 2.0 * beyond,
        2.0 * t / ACUTE_RAMP,
    );
}

// The penalties on an angle, with their first two derivatives by its cotangent.
fn acute_penalties(cotangent: f32) -> vec3<f32> {
    let large = acute_hinge(0.2 - cotangent);
    return 300.0 * vec3(large.x, -large.y, large.z) + 30.0 * acute_hinge(cotangent - 1.3);
}

fn acute_excess(t: Corner) -> f32 {
    let i = invariants(t);
    let m = i.excess / i.area;
    let c = t.b - t.a;
    let cotangents = vec3(dot(t.a, t.b), -dot(t.a, c), dot(t.b, c)) / i.area;
    return m * (m + 2.0) + (acute_penalties(cotangents.x).x
        + acute_penalties(cotangents.y).x + acute_penalties(cotangents.z).x);
}

// Adds the penalties on an angle to a sum. The angle has the cotangent n / area, n the gradient `slope` and the Hessian
// `curvature` times the identity, and the area the gradient `area_slope`.
fn acute_with_angle(sum: Derivatives, unit: f32, area_slope: vec2<f32>, n: f32, slope: vec2<f32>, curvature: f32) -> Derivatives {
    let cotangent = n * unit;
    let penalties = acute_penalties(cotangent);
    let g = (slope - cotangent * area_slope) * unit;
    let s = 0.5 * penalties.z * g - penalties.y * unit * area_slope;
    let own = penalties.y * unit * curvature;
    return Derivatives(
        sum.value + penalties.x,
        sum.gradient + penalties.y * g,
        sum.hessian + vec3(own + 2.0 * g.x * s.x, g.x * s.y + g.y * s.x, own + 2.0 * g.y * s.y),
    );
}

fn acute_derivatives(t: Corner) -> Derivatives {
    let i = invariants(t);
    let unit = 1.0 / i.area;
    let m = i.excess * unit;
    let excess = 2.0 * (m + 1.0);
    let imr = Slopes(
        unit,
        m * (m + 2.0),
        excess,
        -m * excess,
        2.0,
        -2.0 * (2.0 * m + 1.0),
        2.0 * m * (3.0 * m + 2.0),
    );
    // If the vertex moves by d, the edges a and b change by -d, and c does not change.
    let c = t.b - t.a;
    let area_slope = vec2(t.a.y - t.b.y, t.b.x - t.a.x);
    var sum = expansion(t, imr);
    sum = acute_with_angle(sum, unit, area_slope, dot(t.a, t.b), -t.a - t.b, 2.0);
    sum = acute_with_angle(sum, unit, area_slope, -dot(t.a, c), c, 0.0);
    return acute_with_angle(sum, unit, area_slope, dot(t.b, c), -c, 0.0);
}
