//! Vectors of the plane as arrays.

pub(super) fn minus(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

pub(super) fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

pub(super) fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

pub(super) fn length(a: [f64; 2]) -> f64 {
    a[0].hypot(a[1])
}

/// Returns the distance of a point from a segment.
pub(super) fn distance_to_segment(point: [f64; 2], [p, q]: [[f64; 2]; 2]) -> f64 {
    let (edge, to) = (minus(q, p), minus(point, p));
    let size = dot(edge, edge);
    let share = if size > 0.0 { (dot(to, edge) / size).clamp(0.0, 1.0) } else { 0.0 };
    length(minus(to, edge.map(|x| share * x)))
}

/// Returns the angle at `p` from `q` counter-clockwise to `r`, from 0 to 360 degrees.
pub(super) fn angle(p: [f64; 2], q: [f64; 2], r: [f64; 2]) -> f64 {
    let (a, b) = (minus(q, p), minus(r, p));
    let turn = cross(a, b).atan2(dot(a, b)).to_degrees();
    if turn < 0.0 { turn + 360.0 } else { turn }
}

/// Returns the median of some numbers; `None` for no number.
pub(super) fn median(mut numbers: Vec<f64>) -> Option<f64> {
    let middle = numbers.len() / 2;
    if numbers.is_empty() {
        return None;
    }
    Some(*numbers.select_nth_unstable_by(middle, f64::total_cmp).1)
}
