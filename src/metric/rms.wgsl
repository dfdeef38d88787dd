// Root mean square edge length over that of the equilateral triangle of mean area: q² = (excess + area) / mean.
// Quadratic: a Newton step moves the vertex to the mean of its one-ring.

fn rms_value(t: Invariants) -> f32 {
    return (t.excess + t.area) / t.mean - 1.0;
}

fn rms_slopes(t: Invariants) -> Slopes {
    return Slopes(rms_value(t), 1.0 / t.mean, 1.0 / t.mean, 0.0, 0.0, 0.0);
}
