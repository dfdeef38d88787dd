//! Decimal text of real numbers in fields of Nastran's bulk data, which hold 8 or 16 characters.
//!
//! Nastran's real numbers need a point, but no letter before the exponent: `1.5-3` is 0.0015, and `.5` is a half.

/// Field width that holds every double with all its digits: a sign, a point, seventeen digits and an exponent of five
/// characters.
pub(crate) const MAX_LENGTH: usize = 24;

/// Returns a finite number as text of at most `most` characters (8 or more), with the digits that fit, but without
/// superfluous digits.
pub(crate) fn field_text(number: f64, most: usize) -> String {
    let sign = if number.is_sign_negative() { "-" } else { "" };
    let (_, text) = nearest(number.abs(), most - sign.len());
    format!("{sign}{text}")
}

/// Returns the number that Nastran reads from the result of [`field_text`]; infinity and NaN unchanged.
pub(crate) fn rounded_to_field(number: f64, most: usize) -> f64 {
    if number == 0.0 || !number.is_finite() || most >= MAX_LENGTH {
        return number;
    }
    let (size, room) = (number.abs(), most - usize::from(number.is_sign_negative()));
    // For these sizes, text without an exponent has no fewer digits than text with an exponent. The power of ten and
    // the scaled whole number are exact doubles, and therefore the quotient is the number that a reader parses.
    let whole = POWERS.iter().position(|&power| size < power).unwrap_or(usize::MAX);
    if size >= 1e-3 && whole < room {
        let scale = POWERS[room - 1 - whole];
        return ((size * scale).round_ties_even() / scale).copysign(number);
    }
    nearest(size, room).0.value().copysign(number)
}

/// Returns a bound on the rounding error of [`field_text`] for numbers up to `size`.
pub(crate) fn field_error(size: f64, most: usize) -> f64 {
    if size == 0.0 || !size.is_finite() {
        return size;
    }
    // Room for digits, beside a sign and a point.
    let room = most as i32 - 2;
    // The logarithm of a power of ten may be a little less than whole.
    let exponent = (size * (1.0 + 1e-12)).log10().floor() as i32;
    let whole = (exponent + 1).max(0);
    let plain = if whole <= room { 10f64.powi(whole - room) } else { f64::INFINITY };
    let characters = match exponent.abs() {
        0..=9 => 2,
        10..=99 => 3,
        _ => 4,
    };
    plain.min(size * 10f64.powi(1 - (room - characters)))
}

const POWERS: [f64; 16] =
    [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15];

/// Number in decimal scientific notation: digits with a point after the first digit, times ten to the power `exponent`.
struct Decimal {
    /// Decimal digits without trailing zeros; at least one digit.
    digits: String,
    exponent: i32,
}

/// Returns the decimal nearest to `size` whose text has at most `room` characters, and the text.
fn nearest(size: f64, room: usize) -> (Decimal, String) {
    let all = Decimal::of(&format!("{size:e}"));
    if let Some(text) = all.text(room) {
        return (all, text);
    }
    // Besides digits, the text has at least a point.
    let most = all.digits.len().min(room - 1);
    let shorter = (1..=most).rev().find_map(|count| {
        let mut shorter = Decimal::of(&format!("{size:.*e}", count - 1));
        if shorter.value().is_infinite() {
            let digits = all.digits[..count].to_owned();
            shorter = Decimal { digits, exponent: all.exponent };
        }
        let text = shorter.text(room)?;
        Some((shorter, text))
    });
    // A single digit fits into any field.
    shorter.unwrap_or((all, String::new()))
}

impl Decimal {
    /// Parses a number in the notation of the format specifier `{:e}`.
    fn of(scientific: &str) -> Decimal {
        let (mantissa, exponent) = scientific.split_once('e').unwrap_or((scientific, "0"));
        let digits = mantissa.replace('.', "");
        let digits = match digits.trim_end_matches('0') {
            "" => "0".to_owned(),
            digits => digits.to_owned(),
        };
        Decimal { digits, exponent: exponent.parse().unwrap_or(0) }
    }

    fn value(&self) -> f64 {
        let last = self.exponent - (self.digits.len() as i32 - 1);
        format!("{}e{last}", self.digits).parse().unwrap_or(f64::INFINITY)
    }

    /// Returns the text of all digits in at most `room` characters; `None` if the digits do not fit.
    fn text(&self, room: usize) -> Option<String> {
        let count = self.digits.len();
        let plain = match usize::try_from(self.exponent) {
            Ok(exponent) if exponent + 2 > room => None,
            Ok(exponent) if count <= exponent + 1 => {
                Some(format!("{}{}.", self.digits, "0".repeat(exponent + 1 - count)))
            }
            Ok(exponent) => {
                let (whole, part) = self.digits.split_at(exponent + 1);
                Some(format!("{whole}.{part}"))
            }
            Err(_) => {
                let zeros = (-1 - self.exponent) as usize;
                let fits = zeros + count < room;
                fits.then(|| format!(".{}{}", "0".repeat(zeros), self.digits))
            }
        };
        let plain = plain.filter(|text| text.len() <= room);
        if let Some(text) = plain {
            // The zero before the point is left out if a digit needs its room.
            let has_zero = text.starts_with('.') && text.len() < room;
            return Some(if has_zero { format!("0{text}") } else { text });
        }
        // For other positions of the point, the exponent may need a digit less.
        let forms = [(1, "E"), (1, ""), (0, ""), (count, "")];
        forms.into_iter().find_map(|(point, letter)| {
            let (whole, part) = self.digits.split_at(point);
            let exponent = self.exponent + 1 - point as i32;
            let text = format!("{whole}.{part}{letter}{exponent:+}");
            (text.len() <= room).then_some(text)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reads a number as Nastran does.
    fn read(text: &str) -> f64 {
        let sign = text.rfind(['+', '-']).filter(|&at| at > 0);
        match sign.filter(|&at| !text[..at].ends_with('E')) {
            Some(at) => format!("{}e{}", &text[..at], &text[at..]).parse().unwrap(),
            None => text.parse().unwrap(),
        }
    }

    fn random() -> impl FnMut() -> u64 {
        let mut state = 1_u64;
        move || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            state ^ (state >> 29)
        }
    }

    #[test]
    fn numbers_have_as_many_digits_as_fit() {
        for (number, short, long) in [
            (0.0, "0.", "0."),
            (-0.0, "-0.", "-0."),
            (5.0, "5.", "5."),
            (0.25, "0.25", "0.25"),
            (1.0 / 3.0, ".3333333", ".333333333333333"),
            (-1.0 / 3.0, "-.333333", "-.33333333333333"),
            (-123.456_789_012_345_67, "-123.457", "-123.45678901235"),
            (1_234_567.0, "1234567.", "1234567."),
            (-1_234_567.0, "-1.235+6", "-1234567."),
            (12_345_678.0, "1.2346+7", "12345678."),
            (99_999_999.0, "1.E+8", "99999999."),
            (0.001_234_567_890_123_456_7, ".0012346", ".001234567890123"),
            (0.000_123_456_789_012_345_67, "1.2346-4", "1.234567890123-4"),
            (-0.000_123_456_789_012_345_67, "-1.235-4", "-1.23456789012-4"),
            (1e-7, ".0000001", "0.0000001"),
            (1.234_567_89e-10, ".12346-9", "1.23456789E-10"),
            (-1.234_567_890_123e-100, "-.123-99", "-.12345678901-99"),
            (1.234_567_89e12, "12346.+8", "1234567890000."),
            (f64::MAX, "1.79+308", "1.7976931348+308"),
            (-f64::MAX, "-1.7+308", "-1.797693134+308"),
            (f64::from_bits(1), "5.E-324", "5.E-324"),
        ] {
            let texts = [8, 16].map(|most| field_text(number, most));
            assert_eq!(texts, [short, long]);
        }
    }

    /// Rounded numbers of all sizes fit into the field, differ by at most [`field_error`], and survive further rounding
    /// unchanged.
    #[test]
    fn rounded_numbers_fit_and_stay_as_they_are() {
        let mut random = random();
        for round in 0..30_000 {
            let number = match round % 3 {
                0 => f64::from_bits(random()),
                1 => {
                    ((random() >> 11) as f64 / 2f64.powi(53) - 0.5)
                        * 10f64.powi((random() % 40) as i32 - 20)
                }
                _ => {
                    ((random() >> 11) as f64 / 2f64.powi(53) - 0.5)
                        * 10f64.powi((random() % 7) as i32 - 2)
                }
            };
            if !number.is_finite() {
                continue;
            }
            for most in [8, 16, MAX_LENGTH] {
                let rounded = rounded_to_field(number, most);
                let text = field_text(rounded, most);
                assert!(text.len() <= most && text.contains('.'), "{text}");
                assert_eq!(read(&text).to_bits(), rounded.to_bits(), "{number:e} {text}");
                assert_eq!(rounded_to_field(rounded, most).to_bits(), rounded.to_bits());
                let error = (rounded - number).abs();
                assert!(error <= field_error(number.abs(), most), "{number:e} {text}");
                assert!(most < MAX_LENGTH || rounded.to_bits() == number.to_bits());
                // The text of the unrounded number is equally near, except for ties between two decimals.
                let direct = (read(&field_text(number, most)) - number).abs();
                assert!((direct - error).abs() <= 2.0 * f64::EPSILON * number.abs(), "{number:e}");
            }
        }
        for number in [f64::NAN, f64::INFINITY] {
            assert_eq!(rounded_to_field(number, 8).to_bits(), number.to_bits());
        }
    }

    /// Rounding keeps every number read from a field, in any notation.
    #[test]
    fn numbers_of_a_field_are_kept() {
        let mut random = random();
        let mut below = |count: usize| (random() >> 20) as usize % count;
        for most in [8, 16] {
            let mut kept = 0;
            for _ in 0..200_000 {
                let mut text = ["", "-", "+"][below(3)].to_owned();
                let digits = 1 + below(most - 1 - text.len());
                let point = below(digits + 1);
                (0..digits).for_each(|at| {
                    if at == point {
                        text.push('.');
                    }
                    text.push(char::from(b'0' + below(10) as u8));
                });
                if point == digits {
                    text.push('.');
                }
                let (sign, most_of_exponent) = (["+", "-"][below(2)], [10, 100][below(2)]);
                let number = match below(3) {
                    0 => text.clone(),
                    _ => format!("{text}{sign}{}", below(most_of_exponent)),
                };
                if number.len() > most || !number.bytes().any(|byte| byte.is_ascii_digit()) {
                    continue;
                }
                let number = read(&number);
                assert_eq!(
                    rounded_to_field(number, most).to_bits(),
                    number.to_bits(),
                    "{number:e}"
                );
                kept += 1;
            }
            assert!(kept > 100_000, "{kept}");
        }
    }

    #[test]
    fn errors_of_rounding_are_told_for_all_smaller_numbers() {
        for exponent in -30..30 {
            for part in [1.0, 3.7, 9.999_999_999_9] {
                let size = part * 10f64.powi(exponent);
                for most in [8, 16] {
                    let bound = field_error(size, most);
                    for share in
                        [-1.0, 0.999_999_7, -0.123_456_789_123_456_7, 0.012_345_678_912_345]
                    {
                        let number = share * size;
                        let error = (rounded_to_field(number, most) - number).abs();
                        assert!(error <= bound, "{number:e} {error:e} {bound:e}");
                    }
                }
            }
        }
        assert_eq!([0.5, 5.0, 500.0].map(|size| field_error(size, 8)), [1e-6, 1e-5, 1e-3]);
        assert_eq!([field_error(1e-6, 8), field_error(0.0, 8)], [1e-9, 0.0]);
    }
}
