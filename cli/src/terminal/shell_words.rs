//! Words of command lines, quoted for a shell.

use std::ffi::OsStr;

/// Quotes a word for a shell if it needs quotes.
pub(crate) fn quoted(word: &OsStr) -> String {
    let word = word.to_string_lossy();
    let is_plain = |c: char| c.is_alphanumeric() || "-_=+./,:@%".contains(c);
    match !word.is_empty() && word.chars().all(is_plain) {
        true => word.into_owned(),
        false => format!("'{}'", word.replace('\'', r"'\''")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_quoted_for_a_shell() {
        let cases =
            [("in.msh", "in.msh"), ("", "''"), ("a b", "'a b'"), ("it's<5", r"'it'\''s<5'")];
        for (word, expected) in cases {
            assert_eq!(quoted(OsStr::new(word)), expected);
        }
    }
}
