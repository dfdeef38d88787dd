//! Formats of numbers in text.

/// Formats a number with about six significant digits.
pub(crate) fn sig6(x: f64) -> String {
    match x.abs() {
        a if a.is_nan() => "NaN".into(),
        a if a.is_infinite() => "infinite".into(),
        a if (1e-4..1e6).contains(&a) || a == 0.0 => {
            let before_point = if a < 1.0 { 1 } else { a.log10().floor() as usize + 1 };
            format!("{x:.*}", 7usize.saturating_sub(before_point).max(1))
        }
        _ => format!("{x:.4e}"),
    }
}

/// Formats a count with its noun in the singular or plural: `1 ring`, `2 rings`.
pub(crate) fn counted(count: usize, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}

/// Formats the numbers of triangles and of quadrilaterals, each only if the mesh has some.
pub(crate) fn elements(triangles: usize, quadrilaterals: usize) -> String {
    match (triangles, quadrilaterals) {
        (triangles, 0) => counted(triangles, "triangle"),
        (0, count) => counted(count, "quadrilateral"),
        (triangles, count) => {
            format!("{}, {}", counted(triangles, "triangle"), counted(count, "quadrilateral"))
        }
    }
}

/// Formats a number with the digits of single precision, which hides rounding errors of double precision.
pub(crate) fn short(number: f64) -> String {
    (number as f32).to_string()
}

/// Formats a number with two significant digits or as an integer, without an exponent from 1e-4 to 1e6.
pub(crate) fn rough(x: f64) -> String {
    match x.abs() {
        0.0 => "0".into(),
        a if (1e-4..1e6).contains(&a) => {
            format!("{x:.*}", (1 - a.log10().floor() as i32).max(0) as usize)
        }
        _ => format!("{x:.1e}"),
    }
}

/// Formats a coordinate with digits down to a thousandth of `length`, a length of the mesh at that point.
pub(crate) fn coordinate(x: f64, length: f64) -> String {
    // The power of ten of the last digit. Digits of an infinite or zero length would have no end.
    let last = match length.abs().log10() {
        power if power.is_finite() => power.floor() as i32 - 3,
        _ => return format!("{x}"),
    };
    match x.abs() {
        0.0 => "0".into(),
        a if (1e-4..1e15).contains(&a) || a < 1.0 && last >= -9 => {
            format!("{x:.*}", (-last).max(0) as usize)
        }
        a => {
            let first = a.log10().floor() as i32;
            // A number in double precision has at most 17 digits.
            format!("{x:.*e}", first.saturating_sub(last).clamp(0, 16) as usize)
        }
    }
}

/// Formats a fraction in percent, rounded down so that no goal seems reached early.
pub(crate) fn percent(share: f64) -> String {
    format!("{:.2}", (share * 1e4).floor() / 1e2)
}

/// Formats a number with four or five significant digits, in at most eight characters.
pub(crate) fn fit8(x: f64) -> String {
    match x.abs() {
        a if a.is_nan() => "NaN".into(),
        a if a.is_infinite() => "infinite".into(),
        0.0 => "0".into(),
        a if (1e-3..99_999.5).contains(&a) => {
            let decimals = 4 - a.log10().floor().max(-4.0) as i32 - i32::from(a < 1.0);
            format!("{x:.*}", (decimals - i32::from(x < 0.0)).max(0) as usize)
        }
        _ => format!("{x:.1e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_have_digits_down_to_a_thousandth_of_the_length() {
        let cases = [
            (6_736_951.264, 48.0, "6736951.26"),
            (-6_736_951.264, 0.5, "-6736951.2640"),
            (6_736_951.264, 5e4, "6736951"),
            (0.5, 0.01, "0.50000"),
            (1.25e-7, 1.0, "0.000"),
            (1.25e-7, 1e-9, "1.25000e-7"),
            (1.25e20, 1e16, "1.2500000e20"),
            (0.0, 1.0, "0"),
            (0.25, 0.0, "0.25"),
        ];
        for (x, length, text) in cases {
            assert_eq!(coordinate(x, length), text, "{x} {length}");
        }
    }

    #[test]
    fn rough_numbers_have_two_digits() {
        let cases = [
            (0.1174, "0.12"),
            (0.000_117, "0.00012"),
            (3.04, "3.0"),
            (804.6, "805"),
            (0.0, "0"),
            (2e-7, "2.0e-7"),
            (1e7, "1.0e7"),
        ];
        for (x, text) in cases {
            assert_eq!(rough(x), text);
        }
    }

    #[test]
    fn numbers_fit_their_column() {
        let cases = [
            (60.0, "60.000"),
            (0.0012487, "0.001249"),
            (0.25, "0.2500"),
            (-0.0012487, "-0.00125"),
            (1.0, "1.0000"),
            (99_999.4, "99999"),
            (99_999.6, "1.0e5"),
            (0.000999, "1.0e-3"),
            (-1e-300, "-1.0e-300"),
            (f64::INFINITY, "infinite"),
            (f64::NAN, "NaN"),
        ];
        for (x, text) in cases {
            assert_eq!(fit8(x), text);
        }
        assert_eq!([f64::NAN, f64::INFINITY].map(sig6), ["NaN", "infinite"]);
    }
}
