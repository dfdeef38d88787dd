// The inverse mean ratio with a regularized area, s / χ(ε, d), which is finite for inverted triangles too. Here d is
// the doubled area, s the sum of the squared lengths over 2√3, χ(ε, d) = (d + √(ε² + d²)) / 2, and ε is in the unit of
// d.

const PER_DOUBLED_AREA: f32 = 0.28867513459; // 1 / (2√3)

struct Regularized {
    chi: f32,
    root: f32,
}

// Computes χ and √(ε² + d²) without cancellation, and without underflow or overflow of squares.
fn regularized(epsilon: f32, d: f32) -> Regularized {
    let unit = max(epsilon, abs(d));
    let e = epsilon / unit;
    let f = d / unit;
    let root = sqrt(e * e + f * f);
    if d > 0.0 {
        return Regularized(0.5 * (d + unit * root), unit * root);
    }
    return Regularized(0.5 * epsilon * (e / (root - f)), unit * root);
}

fn energy(t: Corner, epsilon: f32) -> f32 {
    return PER_DOUBLED_AREA * squared_length_sum(t) / regularized(epsilon, doubled_area(t)).chi;
}

// Returns the energy and its derivatives by the vertex where the edges start. With r = √(ε² + d²), the derivatives of
// 1/χ by d are -1 / (χ r) and 2 / r³.
fn energy_derivatives(t: Corner, epsilon: f32) -> Derivatives {
    let r = regularized(epsilon, doubled_area(t));
    let inverse = 1.0 / r.chi;
    let per_root = 1.0 / r.root;
    let s = PER_DOUBLED_AREA * squared_length_sum(t);
#if QUADRILATERALS
    let slopes = vec3(edge_slopes, edge_slopes.y - edge_slopes.x);
    let ds = 2.0 * PER_DOUBLED_AREA * (slopes.x * t.a + slopes.y * t.b + slopes.z * (t.b - t.a));
    let ss = 2.0 * PER_DOUBLED_AREA * inverse * dot(slopes, slopes);
    // Division by the root keeps slopes in range for tiny and huge areas.
    let dd = area_slope(t) * per_root;
#else
    let ds = (-2.0 * PER_DOUBLED_AREA) * (t.a + t.b);
    let ss = 4.0 * PER_DOUBLED_AREA * inverse;
    // Division by the root keeps slopes in range for tiny and huge areas.
    let dd = vec2(t.a.y - t.b.y, t.b.x - t.a.x) * per_root;
#endif
    let mixed = -inverse * ds;
    let second = 2.0 * s * per_root;
    return Derivatives(
        s * inverse,
        inverse * (ds - s * dd),
        vec3(
            ss + 2.0 * mixed.x * dd.x + second * dd.x * dd.x,
            mixed.x * dd.y + mixed.y * dd.x + second * dd.x * dd.y,
            ss + 2.0 * mixed.y * dd.y + second * dd.y * dd.y,
        ),
    );
}
