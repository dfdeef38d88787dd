//! Words of a text and the numbers they stand for.

/// Where the line ends that holds this byte, after its line feed.
pub(crate) fn line_end(bytes: &[u8], at: usize) -> usize {
    memchr::memchr(b'\n', &bytes[at..]).map_or(bytes.len(), |n| at + n + 1)
}

/// A token made fit for a message of one line: shortened, with control characters escaped.
pub(crate) fn quoted(token: &[u8]) -> String {
    on_one_line(token, 40)
}

/// A text that may quote any part of a file, made fit for a message of one line: so many characters of it, with control
/// characters escaped.
pub(crate) fn on_one_line(text: &[u8], most: usize) -> String {
    let text = String::from_utf8_lossy(&text[..text.len().min(4 * most)]);
    let mut shown: String = text.chars().take(most).flat_map(char::escape_debug).collect();
    if text.chars().nth(most).is_some() {
        shown.push_str("...");
    }
    shown
}

/// The first byte from `at` on that is no blank. A line feed does not count as one.
#[inline]
pub(crate) fn skip_blanks(bytes: &[u8], mut at: usize) -> usize {
    while at < bytes.len() && bytes[at] <= b' ' && bytes[at] != b'\n' {
        at += 1;
    }
    at
}

/// Where the next token starts, on this line or a later one, behind a comment too: some formats break lines between x
/// and y.
#[inline]
pub(crate) fn skip_to_token(bytes: &[u8], mut at: usize) -> usize {
    loop {
        match bytes.get(at) {
            Some(b'#') => at = line_end(bytes, at),
            Some(&byte) if byte <= b' ' => at += 1,
            _ => return at,
        }
    }
}

/// Where the token ends that starts at `at`: at a blank, at a comment or at the end of the line.
#[inline]
pub(crate) fn token_end(bytes: &[u8], mut at: usize) -> usize {
    while at < bytes.len() && bytes[at] > b' ' && bytes[at] != b'#' {
        at += 1;
    }
    at
}

#[inline]
pub(crate) fn integer(token: &[u8]) -> Option<u64> {
    let digits = token.strip_prefix(b"+").unwrap_or(token);
    if digits.is_empty() {
        return None;
    }
    // So many digits cannot overflow.
    if digits.len() < 20 && digits.iter().all(u8::is_ascii_digit) {
        let append = |number: u64, &byte: &u8| 10 * number + u64::from(byte - b'0');
        return Some(digits.iter().fold(0, append));
    }
    digits.iter().try_fold(0_u64, |number, &byte| {
        let digit = byte.wrapping_sub(b'0');
        if digit > 9 {
            return None;
        }
        number.checked_mul(10)?.checked_add(u64::from(digit))
    })
}

#[inline]
pub(crate) fn float(token: &[u8]) -> Option<f64> {
    if let Some(number) = short_float(token) {
        return Some(number);
    }
    let text = str::from_utf8(token).ok()?;
    text.parse().ok().or_else(|| fortran_float(text))
}

/// The number if it is an integer of at most 53 bits by a power of ten that is a `f64`: then a single operation rounds it rightly
/// (Clinger, How to read floating point numbers accurately, 1990). Most numbers of up to 16 digits are, and it takes a
/// third of the time.
#[inline]
fn short_float(token: &[u8]) -> Option<f64> {
    const POWERS: [f64; 23] = [
        1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16,
        1e17, 1e18, 1e19, 1e20, 1e21, 1e22,
    ];
    let (is_negative, digits) = match token {
        [b'-', rest @ ..] => (true, rest),
        rest => (false, rest),
    };
    let (mut number, mut fraction, mut count, mut at) = (0_u64, None, 0, 0);
    while let Some(&byte) = digits.get(at) {
        match byte {
            b'0'..=b'9' => {
                number = number.wrapping_mul(10).wrapping_add(u64::from(byte - b'0'));
                count += 1;
            }
            b'.' if fraction.is_none() => fraction = Some(count),
            _ => break,
        }
        at += 1;
    }
    let exponent = match &digits[at..] {
        [] => 0,
        [b'e' | b'E', b'-', digit @ b'0'..=b'9'] => -i32::from(digit - b'0'),
        [b'e' | b'E', b'-', tens @ b'0'..=b'9', ones @ b'0'..=b'9'] => {
            -10 * i32::from(tens - b'0') - i32::from(ones - b'0')
        }
        [b'e' | b'E', b'+', tens @ b'0'..=b'9', ones @ b'0'..=b'9'] => {
            10 * i32::from(tens - b'0') + i32::from(ones - b'0')
        }
        _ => return None,
    };
    // So many digits, leading zeros among them, cannot overflow.
    if !(1..=19).contains(&count) || number > 1 << 53 {
        return None;
    }
    let power = exponent - fraction.map_or(0, |before| count - before);
    let scale = *POWERS.get(power.unsigned_abs() as usize)?;
    let number = number as f64;
    let number = if power < 0 { number / scale } else { number * scale };
    Some(if is_negative { -number } else { number })
}

/// The number if its exponent is marked with D, as Fortran does for double precision.
#[cold]
fn fortran_float(text: &str) -> Option<f64> {
    let (mantissa, exponent) = text.split_once(['d', 'D'])?;
    format!("{mantissa}e{exponent}").parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integers() {
        assert_eq!(integer(b"0"), Some(0));
        assert_eq!(integer(b"+17"), Some(17));
        assert_eq!(integer(b"18446744073709551615"), Some(u64::MAX));
        for wrong in ["", "+", "-1", "1.0", "1e3", "18446744073709551616", "7a", ":"] {
            assert_eq!(integer(wrong.as_bytes()), None, "{wrong}");
        }
    }

    #[test]
    fn floats() {
        for (text, value) in [
            ("1", 1.0),
            ("+1.5", 1.5),
            (".5", 0.5),
            ("2.", 2.0),
            ("1.5D+02", 150.0),
            ("-1d-1", -0.1),
        ] {
            assert_eq!(float(text.as_bytes()), Some(value), "{text}");
        }
        for wrong in ["", "x", "1,5", "1.5.2", "D", "1D", "0x10", "--1", "\u{e9}"] {
            assert_eq!(float(wrong.as_bytes()), None, "{wrong}");
        }
    }

    /// Against the standard library, on numbers as they are written and on what may look like one.
    #[test]
    fn short_floats_are_those_of_the_standard_library() {
        let mut state = 3_u64;
        let mut random = move |below: usize| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 33) as usize % below
        };
        let mut short = 0;
        for round in 0..60_000 {
            let text = match round % 3 {
                0 => {
                    let letters = b"00123456789.-+eE";
                    let length = 1 + random(12);
                    let bytes = (0..length).map(|_| letters[random(letters.len())]).collect();
                    String::from_utf8(bytes).unwrap()
                }
                1 => {
                    let number = random(1 << 31) as f64 * 7.0f64.powi(random(40) as i32 - 20);
                    format!("{number:.*}", random(12))
                }
                _ => format!("{:e}", random(1 << 30) as f64 / 10f64.powi(random(30) as i32)),
            };
            let expected = text.parse::<f64>().ok().map(f64::to_bits);
            let found = short_float(text.as_bytes()).map(f64::to_bits);
            assert!(found.is_none() || found == expected, "{text}");
            assert!(float(text.as_bytes()).map(f64::to_bits) == expected, "{text}");
            short += u32::from(found.is_some());
        }
        assert!(short > 20_000, "{short}");
    }

    #[test]
    fn quoting_keeps_a_message_on_one_short_line() {
        assert_eq!(quoted(b"a\x07\xFFb"), "a\\u{7}\u{FFFD}b");
        assert_eq!(quoted(&[b'x'; 5000]).len(), 43);
    }
}
