// Aspect ratio q = s / area, with s = excess + area = √3/6 times the sum of the squared lengths (Dompierre et al.
// 2005). Equal to imr.

fn ar_value(t: Invariants) -> f32 {
    let q = (t.excess + t.area) / t.area;
    return (q - 1.0) * (q + 1.0);
}

fn ar_slopes(t: Invariants) -> Slopes {
    let unit = 1.0 / t.area;
    let q = (t.excess + t.area) * unit;
    return Slopes(
        unit,
        (q - 1.0) * (q + 1.0),
        2.0 * q,
        2.0 * (1.0 - q) * q,
        2.0,
        2.0 * (1.0 - 2.0 * q),
        2.0 * (q - 1.0) * (3.0 * q - 1.0),
    );
}
