// Edge ratio q = Lmax/Lmin. Newton's method minimizes a p-norm over pairs of edges, with the exponent k = 2^sharpness:
// q² ≈ (max/min) [mean A · mean B]^(1/k), A = (L/max)^k, B = (min/L)^k, over squared lengths L. Powers are computed by
// squaring, and roots by square roots, of ratios below 1, so nothing overflows for any k.

struct EdgePowers {
    lengths: vec3<f32>,
    ratio: f32,
    a: vec3<f32>,
    b: vec3<f32>,
}

fn edge_squared_lengths(t: Corner) -> vec3<f32> {
#if QUADRILATERALS
    if is_right {
        // The two sides, and the diagonal divided by √2, are equally long in a square.
        let b = before_shear(t);
        let diagonal = b - t.a;
        return vec3(dot(t.a, t.a), dot(b, b), 0.5 * dot(diagonal, diagonal));
    }
#endif
    let c = t.b - t.a;
    return vec3(dot(t.a, t.a), dot(t.b, t.b), dot(c, c));
}

fn edge_excess(t: Corner) -> f32 {
    let l = edge_squared_lengths(t);
    let least = min(l.x, min(l.y, l.z));
    return (max(l.x, max(l.y, l.z)) - least) / least;
}

fn edge_powers(t: Corner) -> EdgePowers {
    let l = edge_squared_lengths(t);
    let most = max(l.x, max(l.y, l.z));
    let least = min(l.x, min(l.y, l.z));
    var a = l / most;
    var b = least / l;
    for (var i = 0u; i < sharpness; i++) {
        a *= a;
        b *= b;
    }
    return EdgePowers(l, most / least, a, b);
}

// The p-norm minus 1.
fn edge_norm(p: EdgePowers) -> f32 {
    var root = (p.a.x + p.a.y + p.a.z) * (p.b.x + p.b.y + p.b.z) / 9.0;
    for (var i = 0u; i < sharpness; i++) {
        root = sqrt(root);
    }
    return p.ratio * root - 1.0;
}

fn edge_model(t: Corner) -> f32 {
    return edge_norm(edge_powers(t));
}

// xx, xy, yy of u vᵀ + v uᵀ.
fn edge_symmetric(u: vec2<f32>, v: vec2<f32>) -> vec3<f32> {
    return vec3(2.0 * u.x * v.x, u.x * v.y + u.y * v.x, 2.0 * u.y * v.y);
}

fn edge_derivatives(t: Corner) -> Derivatives {
    let p = edge_powers(t);
    let k = f32(1u << sharpness);
#if QUADRILATERALS
    // The share of each edge in the two sums.
    let wa = p.a / (p.a.x + p.a.y + p.a.z);
    let wb = p.b / (p.b.x + p.b.y + p.b.z);
    // The edges in the plane, and their slopes by the position of the vertex.
    var b = t.b;
    var slopes = vec3(edge_slopes, 0.0);
    if is_right {
        b = before_shear(t);
        slopes.y = (slopes.y - 0.5 * slopes.x) / HEIGHT;
    }
    slopes.z = slopes.y - slopes.x;
    let third = select(1.0, 0.5, is_right);
    // ∇L / L of each squared length L, and the Hessian of each L as a multiple of the identity.
    let u = 2.0 * slopes.x * t.a / p.lengths.x;
    let v = 2.0 * slopes.y * b / p.lengths.y;
    let w = 2.0 * slopes.z * third * (b - t.a) / p.lengths.z;
    let bends = 2.0 * slopes * slopes * vec3(1.0, 1.0, third) / p.lengths;
    let mean_a = wa.x * u + wa.y * v + wa.z * w;
    let mean_b = wb.x * u + wb.y * v + wb.z * w;
    let g = mean_a - mean_b;
    let uu = 0.5 * edge_symmetric(u, u);
    let vv = 0.5 * edge_symmetric(v, v);
    let ww = 0.5 * edge_symmetric(w, w);
    let net = wa - wb;
    let both = wa + wb;
    let unit = vec3(1.0, 0.0, 1.0);
    // The Hessian of the logarithm: the curvature of each edge, plus the change of the shares.
    let own = net.x * (bends.x * unit - uu) + net.y * (bends.y * unit - vv)
        + net.z * (bends.z * unit - ww);
    let spread = both.x * uu + both.y * vv + both.z * ww
        - 0.5 * (edge_symmetric(mean_a, mean_a) + edge_symmetric(mean_b, mean_b));
#else
    // The share of each edge in the two sums; the third edge does not move with the vertex.
    let wa = p.a / (p.a.x + p.a.y + p.a.z);
    let wb = p.b / (p.b.x + p.b.y + p.b.z);
    // u = ∇L / L and v = ∇L / L of the two moving edges; the Hessian of each L is 2 times the identity.
    let u = -2.0 * t.a / p.lengths.x;
    let v = -2.0 * t.b / p.lengths.y;
    let mean_a = wa.x * u + wa.y * v;
    let mean_b = wb.x * u + wb.y * v;
    let g = mean_a - mean_b;
    let uu = 0.5 * edge_symmetric(u, u);
    let vv = 0.5 * edge_symmetric(v, v);
    let net = wa - wb;
    let both = wa + wb;
    // The Hessian of the logarithm: the curvature of each edge, plus the change of the shares.
    let own = net.x * (vec3(2.0, 0.0, 2.0) / p.lengths.x - uu)
        + net.y * (vec3(2.0, 0.0, 2.0) / p.lengths.y - vv);
    let spread = both.x * uu + both.y * vv
        - 0.5 * (edge_symmetric(mean_a, mean_a) + edge_symmetric(mean_b, mean_b));
#endif
    let value = edge_norm(p);
    let q = value + 1.0;
    return Derivatives(value, q * g, q * (own + k * spread + 0.5 * edge_symmetric(g, g)));
}
