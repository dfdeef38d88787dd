// Aspect ratio q = √3 (L12² + L23² + L13²) / (12 S) (Dompierre et al. 2005); equal to imr.

const AR_SCALE: f32 = 0.28867513459; // √3/6

fn ar_excess(t: Corner) -> f32 {
    let q = AR_SCALE * squared_length_sum(t) / doubled_area(t);
    return (q - 1.0) * (q + 1.0);
}

fn ar_model(t: Corner) -> f32 {
    return ar_excess(t);
}

fn ar_derivatives(t: Corner) -> Derivatives {
    let inverse = 1.0 / doubled_area(t);
    let da = area_gradient(t);
    let q = AR_SCALE * squared_length_sum(t) * inverse;
    // The sum of squared lengths has gradient -2 (a + b) and Hessian 4 times the identity.
    let dq = (-2.0 * AR_SCALE * (t.a + t.b) - q * da) * inverse;
    let hq = (vec3(1.0, 0.0, 1.0) * (4.0 * AR_SCALE) - symmetric(dq, da)) * inverse;
    return Derivatives((q - 1.0) * (q + 1.0), 2.0 * q * dq, symmetric(dq, dq) + 2.0 * q * hq);
}
