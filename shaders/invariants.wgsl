// The invariants of a triangle, and the chain rule from derivatives by the invariants to derivatives by a vertex.

const TARGET_W: f32 = 0.57735026919; // 1/√3

// The invariants of the Rust struct Invariants (src/metric/corner.rs), and the area minus the mean area. All areas are
// doubled. The excess, √3/6 times the sum of the squared lengths minus the doubled area, is computed as a sum of
// squares. A mean area rounded to single precision would give all triangles an equal error, so area - mean uses the
// pair of floats.
struct Invariants {
    excess: f32,
    area: f32,
    mean: f32,
    area_less_mean: f32,
    size_weight: f32,
}

// The value of a function of the invariants, and its partial derivatives, each named by its variables. The derivatives
// are by invariants multiplied by `unit`, the inverse of an area, so that derivatives have no dimension and never
// overflow.
struct Slopes {
    unit: f32,
    value: f32,
    excess: f32,
    area: f32,
    excess_excess: f32,
    excess_area: f32,
    area_area: f32,
}

// Returns T00 - T11 and T01 + T10 of the matrix T = A W⁻¹ = [a, (2b - a)/√3], with W the equilateral triangle.
fn distortion(t: Corner) -> vec2<f32> {
    let s = (2.0 * t.b - t.a) * TARGET_W;
    return vec2(t.a.x - s.y, s.x + t.a.y);
}

fn invariants(t: Corner) -> Invariants {
    let uv = distortion(t);
    let area = doubled_area(t);
    let mean = 2.0 * t.ideal.area;
    return Invariants(
        dot(uv, uv) * (0.25 / TARGET_W),
        area,
        mean.x,
        (area - mean.x) - mean.y,
        t.ideal.size_weight,
    );
}

fn expansion(t: Corner, slopes: Slopes) -> Derivatives {
    let uv = distortion(t);
#if QUADRILATERALS
    // Moving the vertex changes u by (α, -γ) and v by (γ, α), with the slopes α and β of the edges and γ = (2β - α)/√3.
    let alpha = edge_slopes.x;
    let gamma = TARGET_W * (2.0 * edge_slopes.y - alpha);
    let e = vec2(uv.x * alpha + uv.y * gamma, uv.y * alpha - uv.x * gamma)
        * (0.5 / TARGET_W * slopes.unit);
    let d = area_slope(t) * slopes.unit;
#else
    // Moving the vertex changes u by (-1, w) and v by (-w, -1): the Hessian of the excess is 2/√3 times the
    // identity. The area is linear.
    let e = vec2(-(uv.x + uv.y * TARGET_W), uv.x * TARGET_W - uv.y) * (0.5 / TARGET_W * slopes.unit);
    let d = vec2(t.a.y - t.b.y, t.b.x - t.a.x) * slopes.unit;
#endif
    let p = slopes.excess_excess * e + slopes.excess_area * d;
    let r = slopes.excess_area * e + slopes.area_area * d;
#if QUADRILATERALS
    let square = dot(edge_slopes, edge_slopes) - edge_slopes.x * edge_slopes.y;
    let own = slopes.excess * (2.0 * TARGET_W * square) * slopes.unit;
#else
    let own = slopes.excess * (2.0 * TARGET_W) * slopes.unit;
#endif
    return Derivatives(
        slopes.value,
        slopes.excess * e + slopes.area * d,
        vec3(own + p.x * e.x + r.x * d.x, p.x * e.y + r.x * d.y, own + p.y * e.y + r.y * d.y),
    );
}

// Metrics that balance shape and size: ε / τ + v w (τ - 1)² / τ with ε = excess / mean, τ = area / mean, the size
// weight v, and w the argument `weight`.

fn shape_and_size_value(t: Invariants, weight: f32) -> f32 {
    let off = t.area_less_mean / t.mean;
    return (t.excess / t.mean + weight * off * off * t.size_weight) * t.mean / t.area;
}

fn shape_and_size_slopes(t: Invariants, weight: f32) -> Slopes {
    let scale = 1.0 / t.mean;
    let e = t.excess * scale;
    let off = t.area_less_mean * scale;
    let inverse = t.mean / t.area;
    let square = inverse * inverse;
    return Slopes(
        scale,
        (e + weight * off * off * t.size_weight) * inverse,
        inverse,
        (weight * off * (t.area * scale + 1.0) * t.size_weight - e) * square,
        0.0,
        -square,
        2.0 * (e + weight * t.size_weight) * square * inverse,
    );
}
