//! Precision of the coordinates in a file.

use crate::text::field_text::{field_error, rounded_to_field};

/// Precision with which a file stores the coordinates of a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Precision {
    /// Single precision: about seven digits, as in files of 32-bit floats.
    Single,
    /// Double precision: about sixteen digits.
    #[default]
    Double,
    /// Double precision in text of at most 20 characters, the limit of Abaqus and CalculiX: about sixteen digits, fewer
    /// only for numbers near zero or very large numbers.
    Text20,
    /// Text of at most 16 characters, as in large fields of Nastran's bulk data: 12 to 15 digits for numbers from 0.001
    /// to 1e14, 10 or more for most others.
    Text16,
    /// Text of at most 8 characters, as in small fields of Nastran's bulk data: 4 to 7 digits for numbers from 1e-10 to
    /// 1e10, 2 or 3 for most others.
    Text8,
}

impl Precision {
    /// Returns the width of a binary number in bytes.
    pub(crate) fn bytes(self) -> usize {
        match self {
            Precision::Single => 4,
            Precision::Double | Precision::Text20 | Precision::Text16 | Precision::Text8 => 8,
        }
    }

    /// Returns `number` rounded to the precision, as readers of the file see the number.
    pub fn rounded(self, number: f64) -> f64 {
        match self {
            Precision::Single => f64::from(number as f32),
            Precision::Double => number,
            Precision::Text20 => rounded_to_short(number),
            Precision::Text16 => rounded_to_field(number, 16),
            Precision::Text8 => rounded_to_field(number, 8),
        }
    }

    /// Returns a bound on the rounding error of numbers up to the magnitude `size`. Exceptions are numbers near the
    /// smallest and the largest exponents, and with [`Precision::Text20`] all numbers with an exponent of three digits.
    pub fn error(self, size: f64) -> f64 {
        match self {
            Precision::Single => f64::from(f32::EPSILON) * size,
            Precision::Double => f64::EPSILON * size,
            // Negative numbers with an exponent of two digits have fourteen digits.
            Precision::Text20 => 256.0 * f64::EPSILON * size,
            Precision::Text16 => field_error(size, 16),
            Precision::Text8 => field_error(size, 8),
        }
    }
}

/// Largest number of characters of [`Precision::Text20`].
const MAX_CHARACTERS: usize = 20;
/// The largest number with at most 20 characters. Larger doubles become this number, as rounding to 20 characters would
/// make them infinite.
const MAX_TEXT20: f64 = 1.797_693_134_862_3e308;

/// Returns the number that results from parsing [`short_text`].
fn rounded_to_short(number: f64) -> f64 {
    // All seventeen digits fit, with a sign, a point and one zero.
    if (0.01..1e16).contains(&number.abs()) || number == 0.0 || !number.is_finite() {
        return number;
    }
    let rounded = short_text(number).parse().unwrap_or(number);
    if f64::is_infinite(rounded) { MAX_TEXT20.copysign(number) } else { rounded }
}

/// Writes a finite number in at most 20 characters, with no more digits than needed to parse back to the same bits. If
/// not all digits fit, a zero before the decimal point is left out.
pub(crate) fn short_text(number: f64) -> String {
    let shortest = format!("{number:?}");
    if shortest.len() <= MAX_CHARACTERS {
        return shortest;
    }
    let all = format!("{number:e}");
    let digits = all.bytes().take_while(|&byte| byte != b'e').filter(u8::is_ascii_digit).count();
    let fits = |text: &String| text.len() <= MAX_CHARACTERS;
    (1..=digits)
        .rev()
        .find_map(|digits| {
            let scientific = format!("{number:.*e}", digits - 1);
            [plain(&scientific), Some(scientific)].into_iter().flatten().find(fits)
        })
        .unwrap_or(shortest)
}

/// Writes a number from scientific notation without an exponent, and without a zero before the decimal point. `None` if
/// the magnitude is 1 or more, or if at least 20 zeros follow the point.
fn plain(scientific: &str) -> Option<String> {
    let (mantissa, exponent) = scientific.split_once('e')?;
    let zeros = usize::try_from(-1 - exponent.parse::<i32>().ok()?)
        .ok()
        .filter(|&zeros| zeros < MAX_CHARACTERS)?;
    let (sign, mantissa) = match mantissa.strip_prefix('-') {
        Some(mantissa) => ("-", mantissa),
        None => ("", mantissa),
    };
    let digits = mantissa.replace('.', "");
    let digits = digits.trim_end_matches('0');
    Some(format!("{sign}.{}{digits}", "0".repeat(zeros)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_lose_digits_only_where_they_have_no_room() {
        for (number, expected) in [
            (0.25, "0.25"),
            (-0.0, "-0.0"),
            (1e-7, "1e-7"),
            (-0.123_456_789_012_345_67, "-0.12345678901234566"),
            (-0.012_345_678_901_234_567, "-.012345678901234567"),
            (0.001_234_567_890_123_456_7, ".0012345678901234567"),
            (-0.001_234_567_890_123_456_7, "-.001234567890123457"),
            (-0.000_123_456_789_012_345_67, "-.000123456789012346"),
            (-1.234_567_890_123_456_7e-5, "-1.23456789012346e-5"),
            (1.234_567_890_123_456_7e-10, "1.23456789012346e-10"),
            (-1.234_567_890_123_456_7e-100, "-1.234567890123e-100"),
            (-1.234_567_890_123_456_7e16, "-1.23456789012346e16"),
            (1.234_567_890_123_456_7e20, "1.234567890123457e20"),
        ] {
            let text = short_text(number);
            assert_eq!(text, expected);
            assert!(text.len() <= MAX_CHARACTERS, "{text}");
        }
    }

    /// Checks random numbers of all magnitudes: the text fits in 20 characters, the error is small, and rounding again
    /// changes nothing.
    #[test]
    fn rounded_numbers_fit_and_stay_as_they_are() {
        let mut state = 1_u64;
        let mut random = move || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            state ^ (state >> 29)
        };
        let near = |exponent: i32, part: f64| part * 10f64.powi(exponent);
        for round in 0..200_000 {
            let number = match round % 2 {
                0 => f64::from_bits(random()),
                _ => {
                    near((random() % 40) as i32 - 20, (random() >> 11) as f64 / 2f64.powi(53) - 0.5)
                }
            };
            if !number.is_finite() {
                continue;
            }
            let short = rounded_to_short(number);
            let text = short_text(short);
            assert!(text.len() <= MAX_CHARACTERS, "{text}");
            assert_eq!(text.parse::<f64>().map(f64::to_bits), Ok(short.to_bits()), "{text}");
            assert_eq!(rounded_to_short(short).to_bits(), short.to_bits(), "{number:e}");
            let error = ((short - number) / number).abs();
            let most = if (1e-99..1e100).contains(&number.abs()) { 5e-14 } else { 5e-13 };
            assert!(
                error <= most || number.abs() < 1e-290 || number == 0.0,
                "{number:e} {error:e}"
            );
            if (0.001..1e16).contains(&number) {
                assert_eq!(short, number);
            }
        }
        assert_eq!(
            [rounded_to_short(f64::MAX), rounded_to_short(f64::MIN)],
            [MAX_TEXT20, -MAX_TEXT20]
        );
        assert!(
            rounded_to_short(f64::NAN).is_nan() && rounded_to_short(f64::INFINITY).is_infinite()
        );
    }
}
