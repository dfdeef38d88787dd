// Root mean square edge length, relative to that of the equilateral triangle of mean area: q² = (excess + area) / mean.
// It is quadratic, and a Newton step moves the vertex to the mean of its one-ring.

fn rms_value(t: Invariants) -> f32 {
    return (t.excess + t.area_less_mean) / t.mean;
}

fn rms_slopes(t: Invariants) -> Slopes {
    return Slopes(1.0 / t.mean, rms_value(t), 1.0, 1.0, 0.0, 0.0, 0.0);
}
