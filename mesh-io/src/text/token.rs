//! Parses the words of a text: numbers, quoted names, and pairs of key and value.

/// Returns the end, behind the line feed, of the line with the byte at offset `at`.
pub(crate) fn line_end(bytes: &[u8], at: usize) -> usize {
    memchr::memchr(b'\n', &bytes[at..]).map_or(bytes.len(), |n| at + n + 1)
}

/// Shortens a token to 40 characters and escapes its control characters, for a message of one line.
pub(crate) fn quoted(token: &[u8]) -> String {
    on_one_line(token, 40)
}

/// Shortens a text to `most` characters and escapes its control characters, for a message of one line.
pub(crate) fn on_one_line(text: &[u8], most: usize) -> String {
    let text = String::from_utf8_lossy(&text[..text.len().min(4 * most)]);
    let mut shown: String = text.chars().take(most).flat_map(char::escape_debug).collect();
    if text.chars().nth(most).is_some() {
        shown.push_str("...");
    }
    shown
}

/// Joins the first 8 names by commas, and counts the rest.
pub(crate) fn join_first(names: &[&str]) -> String {
    const MAX_NAMES: usize = 8;
    let told = names[..names.len().min(MAX_NAMES)].join(", ");
    match names.len().saturating_sub(MAX_NAMES) {
        0 => told,
        more => format!("{told} and {more} more"),
    }
}

/// Returns the offset of the next number, on this line or a later line. Blanks, comments, commas, semicolons and
/// backslashes are skipped: some formats have separators or line breaks between x and y.
#[inline]
pub(crate) fn skip_to_number(bytes: &[u8], mut at: usize) -> usize {
    loop {
        match bytes.get(at) {
            Some(b'#') => at = line_end(bytes, at),
            Some(b',' | b';' | b'\\') => at += 1,
            Some(&byte) if byte <= b' ' => at += 1,
            _ => return at,
        }
    }
}

/// Returns the exclusive end of the number that starts at `at`: the first byte that numbers cannot contain.
#[inline]
pub(crate) fn number_end(bytes: &[u8], mut at: usize) -> usize {
    let is_part = |byte: &u8| byte.is_ascii_alphanumeric() || matches!(byte, b'.' | b'+' | b'-');
    while bytes.get(at).is_some_and(is_part) {
        at += 1;
    }
    at
}

/// Returns the text between quotation marks; `None` if there are none around it.
pub(crate) fn in_quotes(text: &[u8]) -> Option<&[u8]> {
    text.trim_ascii().strip_prefix(b"\"")?.strip_suffix(b"\"")
}

/// Removes the blanks around a text, and then quotation marks around it.
pub(crate) fn unquoted(text: &[u8]) -> &[u8] {
    in_quotes(text).unwrap_or(text.trim_ascii())
}

/// Returns the key and the value around the first equals sign of a row, trimmed of blanks. Without an equals sign, the
/// value is empty.
pub(crate) fn key_value(row: &[u8]) -> (&[u8], &[u8]) {
    let equals = memchr::memchr(b'=', row).unwrap_or(row.len());
    (row[..equals].trim_ascii(), row.get(equals + 1..).unwrap_or_default().trim_ascii())
}

/// Parses digits from `at` on, as continuation of the digits of `number`. Returns the number modulo 2^64, and the
/// exclusive end of the digits. Numbers of up to 19 digits are below 2^64. The function is always inlined, as a call
/// per number slows down reading.
#[inline(always)]
pub(crate) fn parse_digits(bytes: &[u8], mut at: usize, mut number: u64) -> (u64, usize) {
    while let Some(&digit @ b'0'..=b'9') = bytes.get(at) {
        number = number.wrapping_mul(10).wrapping_add(u64::from(digit - b'0'));
        at += 1;
    }
    (number, at)
}

/// Parses a token as an unsigned whole number below 2^64; `None` for other tokens. A plus sign is accepted.
#[inline]
pub(crate) fn integer(token: &[u8]) -> Option<u64> {
    let digits = token.strip_prefix(b"+").unwrap_or(token);
    match parse_digits(digits, 0, 0) {
        (number, end @ 1..=19) if end == digits.len() => Some(number),
        (_, end) if end == digits.len() => str::from_utf8(digits).ok()?.parse().ok(),
        _ => None,
    }
}

#[inline]
pub(crate) fn float(token: &[u8]) -> Option<f64> {
    if let Some((number, end)) = short_float(token, 0)
        && end == token.len()
    {
        return Some(number);
    }
    let text = str::from_utf8(token).ok()?;
    text.parse().ok().or_else(|| {
        // Fortran writes `D` before the exponents of double precision.
        let (mantissa, exponent) = text.split_once(['d', 'D'])?;
        format!("{mantissa}e{exponent}").parse().ok()
    })
}

/// Parses the number at `at`, if its digits form a whole number up to 2^53 and its power of ten is between 1e-22 and
/// 1e22. A single multiplication or division then rounds correctly (Clinger, How to read floating point numbers
/// accurately, 1990). Returns the number and its exclusive end. Most numbers of up to 16 digits qualify, and take a
/// third of the time of general parsing.
#[inline]
pub(crate) fn short_float(bytes: &[u8], at: usize) -> Option<(f64, usize)> {
    const POWERS: [f64; 23] = [
        1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16,
        1e17, 1e18, 1e19, 1e20, 1e21, 1e22,
    ];
    let is_negative = bytes.get(at) == Some(&b'-');
    let start = at + usize::from(is_negative);
    let (mut number, mut end) = parse_digits(bytes, start, 0);
    let (mut count, mut power) = (end - start, 0);
    if bytes.get(end) == Some(&b'.') {
        let point = end;
        (number, end) = parse_digits(bytes, point + 1, number);
        power = point as i32 + 1 - end as i32;
        count += end - point - 1;
    }
    // This many digits, with leading zeros, cannot overflow.
    if !(1..=19).contains(&count) || number > 1 << 53 {
        return None;
    }
    if let Some(b'e' | b'E') = bytes.get(end) {
        let (sign, first) = match bytes.get(end + 1)? {
            b'-' => (-1, end + 2),
            b'+' => (1, end + 2),
            _ => (1, end + 1),
        };
        let mut exponent = 0;
        end = first;
        while let Some(&digit @ b'0'..=b'9') = bytes.get(end)
            && end < first + 4
        {
            exponent = 10 * exponent + i32::from(digit - b'0');
            end += 1;
        }
        if end == first {
            return None;
        }
        power += sign * exponent;
    }
    let scale = *POWERS.get(power.unsigned_abs() as usize)?;
    let number = number as f64;
    let number = if power < 0 { number / scale } else { number * scale };
    Some((if is_negative { -number } else { number }, end))
}

/// Parses a number in a notation specific to Fortran: with quadruple precision (`Q`), or with a three-digit exponent
/// without a letter.
#[cold]
pub(crate) fn fortran_float(token: &[u8]) -> Option<f64> {
    let text = str::from_utf8(token).ok()?;
    let is_sign = |&at: &usize| matches!(text.as_bytes()[at], b'+' | b'-');
    let (mantissa, exponent) = match text.split_once(['q', 'Q']) {
        Some(parts) => parts,
        None => text.split_at((1..text.len()).rfind(is_sign)?),
    };
    // With a letter in either part, the token would have two exponents.
    let is_plain = |part: &str| part.bytes().all(|b| !b.is_ascii_alphabetic());
    (is_plain(mantissa) && is_plain(exponent))
        .then(|| format!("{mantissa}e{exponent}").parse().ok())
        .flatten()
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
    fn quotation_marks_and_equals_signs_are_removed() {
        for (text, name) in [("\"a b\" ", "a b"), ("\"a", "\"a"), (" a", "a"), ("\"", "\"")] {
            assert_eq!(unquoted(text.as_bytes()), name.as_bytes(), "{text}");
        }
        for (row, key, value) in [(" A = b=c ", "A", "b=c"), ("A=", "A", ""), (" A ", "A", "")] {
            assert_eq!(key_value(row.as_bytes()), (key.as_bytes(), value.as_bytes()), "{row}");
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
    fn exponents_of_fortran() {
        for (text, value) in
            [("1.5-101", 1.5e-101), ("-.25+003", -250.0), ("2Q1", 20.0), ("1q-2", 0.01)]
        {
            assert_eq!(
                (fortran_float(text.as_bytes()), float(text.as_bytes())),
                (Some(value), None),
                "{text}"
            );
        }
        for wrong in ["", "-", "1-", "-1", "1e5-2", "1-2-3", "nan-3", "1Qx", "1,5"] {
            assert_eq!(fortran_float(wrong.as_bytes()), None, "{wrong}");
        }
    }

    #[test]
    fn numbers_end_where_others_begin() {
        for (text, end) in
            [("1.5,2", 3), ("-1e+5<", 5), ("7#", 1), ("1D0\t", 3), ("+.5/x", 3), ("8", 1), ("", 0)]
        {
            assert_eq!(number_end(text.as_bytes(), 0), end, "{text}");
        }
        assert_eq!(skip_to_number(b"1 , # 2, 3\n\t4", 1), 12);
    }

    /// Results must equal the standard library's, for usual numbers and for random text similar to numbers.
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
            let whole = short_float(text.as_bytes(), 0).filter(|&(_, end)| end == text.len());
            let found = whole.map(|(number, _)| number.to_bits());
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
