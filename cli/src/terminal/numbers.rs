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
