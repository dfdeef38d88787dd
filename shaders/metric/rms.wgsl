// Root mean square edge length over that of the equilateral triangle of mean area:
// q² = √3 (L12² + L23² + L13²) / (12 S_mean). Quadratic: its Newton step is the mean of the ring.

const RMS_SCALE: f32 = 0.14433756730; // √3/12

fn rms_excess(t: Corner) -> f32 {
    return RMS_SCALE * squared_length_sum(t) / t.mean_area - 1.0;
}

fn rms_model(t: Corner) -> f32 {
    return rms_excess(t);
}

fn rms_derivatives(t: Corner) -> Derivatives {
    let scale = RMS_SCALE / t.mean_area;
    let hessian = vec3(1.0, 0.0, 1.0) * (4.0 * scale);
    return Derivatives(scale * squared_length_sum(t) - 1.0, -2.0 * scale * (t.a + t.b), hessian);
}
