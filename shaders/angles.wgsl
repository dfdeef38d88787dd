// Penalties on the large and on the small angles of a triangle: 300 Σ ψ(0.2 - cot) + 30 Σ ψ(cot - 1.3), with the sums over
// the cotangents of the three angles, and ψ of the Rust struct Hinge (src/metric/hinge.rs) with the ramp 0.2.

const ANGLE_RAMP: f32 = 0.2;

// The value and the first two derivatives of ψ.
fn angle_hinge(x: f32) -> vec3<f32> {
    let excess = max(x, 0.0);
    let beyond = max(excess - ANGLE_RAMP, 0.0);
    let t = excess - beyond;
    return vec3(
        t * t * t / (3.0 * ANGLE_RAMP) + beyond * (beyond + ANGLE_RAMP),
        t * t / ANGLE_RAMP + 2.0 * beyond,
        2.0 * t / ANGLE_RAMP,
    );
}

// The penalties on an angle, with their first two derivatives by its cotangent.
fn angle_penalties(cotangent: f32) -> vec3<f32> {
    let large = angle_hinge(0.2 - cotangent);
    return 300.0 * vec3(large.x, -large.y, large.z) + 30.0 * angle_hinge(cotangent - 1.3);
}

#if QUADRILATERALS
// ψ with another ramp.
fn angle_hinge_of(x: f32, ramp: f32) -> vec3<f32> {
    let scale = ANGLE_RAMP / ramp;
    let hinge = angle_hinge(x * scale);
    return vec3(hinge.x / (scale * scale), hinge.y / scale, hinge.z);
}

// The kinds of angles, by which penalties differ: angles of triangles, angles between two sides of a quadrilateral, and angles
// between a side and a diagonal. ANGLE_ITSELF stands for the cotangent without a penalty.
const ANGLE_OF_TRIANGLE: u32 = 0u;
const ANGLE_AT_CORNER: u32 = 1u;
const ANGLE_AT_DIAGONAL: u32 = 2u;
const ANGLE_ITSELF: u32 = 3u;

// A function of an angle, with its first two derivatives by the cotangent.
fn function_of_angle(kind: u32, cotangent: f32) -> vec3<f32> {
    if kind == ANGLE_AT_CORNER {
        return 420.0 * vec3(cotangent * cotangent, 2.0 * cotangent, 2.0);
    }
    if kind == ANGLE_AT_DIAGONAL {
        let large = angle_hinge_of(0.1 - cotangent, 0.1);
        return 600.0 * vec3(large.x, -large.y, large.z);
    }
    if kind == ANGLE_ITSELF {
        return vec3(cotangent, 1.0, 0.0);
    }
    return angle_penalties(cotangent);
}

#endif
// The penalties on the angles of a triangle with this doubled area.
fn angles_value(t: Corner, area: f32) -> f32 {
#if QUADRILATERALS
    if is_right {
        let b = before_shear(t);
        let c = b - t.a;
        let seen = HEIGHT * vec3(dot(t.a, b), -dot(t.a, c), dot(b, c)) / area;
        return function_of_angle(ANGLE_AT_CORNER, seen.x).x
            + function_of_angle(ANGLE_AT_DIAGONAL, seen.y).x
            + function_of_angle(ANGLE_AT_DIAGONAL, seen.z).x;
    }
#endif
    let c = t.b - t.a;
    let cotangents = vec3(dot(t.a, t.b), -dot(t.a, c), dot(t.b, c)) / area;
    return angle_penalties(cotangents.x).x
        + angle_penalties(cotangents.y).x + angle_penalties(cotangents.z).x;
}

// Adds the penalties on an angle to a sum. The angle has the cotangent n / area, n the gradient `slope` and the Hessian
// `curvature` times the identity, and the area the gradient `area_slope`.
fn with_angle(
    sum: Derivatives,
#if QUADRILATERALS
    kind: u32,
#endif
    unit: f32,
    area_slope: vec2<f32>,
    n: f32,
    slope: vec2<f32>,
    curvature: f32,
) -> Derivatives {
    let cotangent = n * unit;
#if QUADRILATERALS
    let penalties = function_of_angle(kind, cotangent);
#else
    let penalties = angle_penalties(cotangent);
#endif
    let g = (slope - cotangent * area_slope) * unit;
    let s = 0.5 * penalties.z * g - penalties.y * unit * area_slope;
    let own = penalties.y * unit * curvature;
    return Derivatives(
        sum.value + penalties.x,
        sum.gradient + penalties.y * g,
        sum.hessian + vec3(own + 2.0 * g.x * s.x, g.x * s.y + g.y * s.x, own + 2.0 * g.y * s.y),
    );
}

// Adds the penalties on the angles of a triangle to a function of the triangle. `unit` is 1 over the doubled area.
fn with_angles(start: Derivatives, t: Corner, unit: f32) -> Derivatives {
#if QUADRILATERALS
    let s = plane_slopes;
    let a = t.a;
    var b = t.b;
    var per_area = unit;
    var of_area = area_slope(t);
    var kinds = vec2(ANGLE_OF_TRIANGLE);
    if is_right {
        // Angles are those before the shear, which multiplies areas by √3/2.
        b = before_shear(t);
        per_area *= HEIGHT;
        of_area /= HEIGHT;
        kinds = vec2(ANGLE_AT_CORNER, ANGLE_AT_DIAGONAL);
    }
    let c = b - a;
    let third = s.y - s.x;
    let one = s.x * b + s.y * a;
    let two = -(s.x * c + third * a);
    let three = s.y * c + third * b;
    var sum = with_angle(start, kinds.x, per_area, of_area, dot(a, b), one, 2.0 * s.x * s.y);
    sum = with_angle(sum, kinds.y, per_area, of_area, -dot(a, c), two, -2.0 * s.x * third);
    return with_angle(sum, kinds.y, per_area, of_area, dot(b, c), three, 2.0 * s.y * third);
#else
    // If the vertex moves by d, the edges a and b change by -d, and c does not change.
    let c = t.b - t.a;
    let area_slope = vec2(t.a.y - t.b.y, t.b.x - t.a.x);
    var sum = with_angle(start, unit, area_slope, dot(t.a, t.b), -t.a - t.b, 2.0);
    sum = with_angle(sum, unit, area_slope, -dot(t.a, c), c, 0.0);
    return with_angle(sum, unit, area_slope, dot(t.b, c), -c, 0.0);
#endif
}
