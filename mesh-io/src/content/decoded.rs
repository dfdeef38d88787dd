//! Decodes the bytes of names.

/// Returns the text of a name: UTF-8, or else Windows-1252, which has the characters of Latin-1. Names of different bytes in
/// either encoding stay different. The five bytes that Windows-1252 leaves undefined become control characters.
pub(crate) fn decoded(name: &[u8]) -> String {
    /// Characters of the bytes from 0x80 to 0x9F in Windows-1252.
    const UPPER: [char; 32] = [
        '\u{20ac}', '\u{81}', '\u{201a}', '\u{192}', '\u{201e}', '\u{2026}', '\u{2020}',
        '\u{2021}', '\u{2c6}', '\u{2030}', '\u{160}', '\u{2039}', '\u{152}', '\u{8d}', '\u{17d}',
        '\u{8f}', '\u{90}', '\u{2018}', '\u{2019}', '\u{201c}', '\u{201d}', '\u{2022}', '\u{2013}',
        '\u{2014}', '\u{2dc}', '\u{2122}', '\u{161}', '\u{203a}', '\u{153}', '\u{9d}', '\u{17e}',
        '\u{178}',
    ];
    match str::from_utf8(name) {
        Ok(text) => text.to_owned(),
        Err(_) => name
            .iter()
            .map(|&byte| match byte {
                0x80..=0x9f => UPPER[usize::from(byte - 0x80)],
                byte => char::from(byte),
            })
            .collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_are_not_utf_8_are_those_of_windows_1252() {
        for (name, text) in [
            (&b"plain"[..], "plain"),
            ("f\u{e9}".as_bytes(), "f\u{e9}"),
            (b"f\xe9", "f\u{e9}"),
            (b"\x80 \x9f", "\u{20ac} \u{178}"),
            (b"\x81\xff", "\u{81}\u{ff}"),
        ] {
            assert_eq!(decoded(name), text);
        }
    }
}
