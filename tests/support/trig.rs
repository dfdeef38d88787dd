//! Sine and cosine that are the same everywhere: those of platforms differ in the last bit, and the meshes with them.

use std::f64::consts::TAU;

/// The point of the unit circle at a number of turns: `[cos, sin]` of `turns * 2 pi`.
pub fn on_circle(turns: f64) -> [f64; 2] {
    let quarters = (turns * 4.0).round();
    // At most pi / 4 in size, where the series below are exact up to rounding.
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

/// `sin(turns * 2 pi)`.
pub fn sin_turns(turns: f64) -> f64 {
    on_circle(turns)[1]
}
