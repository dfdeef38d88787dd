//! Sine and cosine with identical bits on all platforms. Platform functions differ in the last bit, which would
//! change generated meshes.

use std::f64::consts::TAU;

/// Returns the point of the unit circle at an angle of `turns` full turns: `[cos, sin]` of `turns * 2 pi`.
pub fn on_circle(turns: f64) -> [f64; 2] {
    let quarters = (turns * 4.0).round();
    // At most pi / 4 in magnitude, where the series below are exact up to rounding.
    let x = (turns - quarters / 4.0) * TAU;
    let x2 = x * x;
    let (mut sin, mut cos) = (1.0, 1.0);
    for k in (1..=9).rev() {
        let k = f64::from(2 * k);
        sin = 1.0 - x2 / (k * (k + 1.0)) * sin;
        cos = 1.0 - x2 / (k * (k - 1.0)) * cos;
    }
    sin *= x;
    match quarters.rem_euclid(4.0) as u8 {
        0 => [cos, sin],
        1 => [-sin, cos],
        2 => [-cos, -sin],
        _ => [sin, -cos],
    }
}

/// Returns `sin(turns * 2 pi)`.
pub fn sin_turns(turns: f64) -> f64 {
    on_circle(turns)[1]
}
