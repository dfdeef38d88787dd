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
    let text = str::from_utf8(token).ok()?;
    text.parse().ok().or_else(|| fortran_float(text))
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

    #[test]
    fn quoting_keeps_a_message_on_one_short_line() {
        assert_eq!(quoted(b"a\x07\xFFb"), "a\\u{7}\u{FFFD}b");
        assert_eq!(quoted(&[b'x'; 5000]).len(), 43);
    }
}
