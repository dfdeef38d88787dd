// Inverse mean ratio q = |T|² / (2 det T), T = A W⁻¹ = [a, (2b - a)/√3] for an equilateral W
// (Munson 2007). q - 1 = m = (u² + v²) / (2 det T), u = T00 - T11, v = T01 + T10: no cancellation.

const IMR_W: f32 = 0.57735026919; // 1/√3

fn imr_numerator_parts(t: Corner) -> vec2<f32> {
    let s = (2.0 * t.b - t.a) * IMR_W;
    return vec2(t.a.x - s.y, s.x + t.a.y);
}

fn imr_excess(t: Corner) -> f32 {
    let uv = imr_numerator_parts(t);
    let m = dot(uv, uv) / (4.0 * IMR_W * doubled_area(t));
    return m * (m + 2.0);
}

fn imr_model(t: Corner) -> f32 {
    return imr_excess(t);
}

fn imr_derivatives(t: Corner) -> Derivatives {
    let uv = imr_numerator_parts(t);
    let inverse = 1.0 / doubled_area(t);
    let da = area_gradient(t);
    let scale = 1.0 / (4.0 * IMR_W);
    let m = dot(uv, uv) * scale * inverse;
    // ∇u = (-1, w), ∇v = (-w, -1): the numerator's Hessian is 2 (1 + w²) = 8/3 times the identity.
    let numerator = 2.0 * vec2(-uv.x - IMR_W * uv.y, IMR_W * uv.x - uv.y);
    let dm = (numerator * scale - m * da) * inverse;
    let hm = (vec3(1.0, 0.0, 1.0) * (8.0 / 3.0 * scale) - symmetric(dm, da)) * inverse;
    let q = m + 1.0;
    return Derivatives(m * (m + 2.0), 2.0 * q * dm, symmetric(dm, dm) + 2.0 * q * hm);
}
