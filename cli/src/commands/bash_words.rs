//! Completions in bash, which splits `--scheme=imr` into three words.

use std::ffi::OsString;
use std::io::{self, Write};
use std::path::Path;

use clap::Command;
use clap_complete::engine;
use clap_complete::env::{Bash, EnvCompleter};

/// Environment variables by which the script passes the index of the incomplete word, and the separator of the answer.
const INDEX: &str = "_CLAP_COMPLETE_INDEX";
const SEPARATOR: &str = "_CLAP_IFS";
/// The line of the script of clap that empties the last word if it is `=`, and the line that replaces it.
const LAST_WORD: &str = r#"words[COMP_CWORD]="$2""#;
const LAST_WORD_OR_SIGN: &str = r#"[[ "${words[COMP_CWORD]}" == "=" ]] || words[COMP_CWORD]="$2""#;

/// Adapter for bash that joins an option, `=` and its value to one word.
#[derive(Debug)]
pub(super) struct BashWords;

impl EnvCompleter for BashWords {
    fn name(&self) -> &'static str {
        Bash.name()
    }

    fn is(&self, name: &str) -> bool {
        Bash.is(name)
    }

    fn write_registration(
        &self,
        var: &str,
        name: &str,
        bin: &str,
        completer: &str,
        buf: &mut dyn Write,
    ) -> io::Result<()> {
        let mut script = Vec::new();
        Bash.write_registration(var, name, bin, completer, &mut script)?;
        let script = String::from_utf8_lossy(&script).replace(LAST_WORD, LAST_WORD_OR_SIGN);
        buf.write_all(script.as_bytes())
    }

    fn write_complete(
        &self,
        program: &mut Command,
        words: Vec<OsString>,
        directory: Option<&Path>,
        buf: &mut dyn Write,
    ) -> io::Result<()> {
        let index = std::env::var(INDEX).ok().and_then(|index| index.parse().ok());
        let (words, index) = joined(words, index.unwrap_or_default());
        // bash replaces the value alone.
        let option = words.get(index).and_then(|word| word.to_str()?.split_once('='));
        let option = option.map(|(name, _)| format!("{name}=")).unwrap_or_default();
        let found = engine::complete(program, words, index, directory)?;
        let values = found.iter().map(|found| found.get_value().to_string_lossy());
        let values: Vec<String> =
            values.map(|value| value.strip_prefix(&option).unwrap_or(&value).to_owned()).collect();
        let separator = std::env::var(SEPARATOR).unwrap_or_else(|_| "\n".to_owned());
        buf.write_all(values.join(&separator).as_bytes())
    }
}

/// Joins each option, `=` behind it and its value to one word. Returns the words, and the index of the word that contains
/// the word at `index`.
fn joined(words: Vec<OsString>, index: usize) -> (Vec<OsString>, usize) {
    let (mut all, mut new_index): (Vec<OsString>, usize) = (Vec::new(), 0);
    let mut is_value = false;
    for (at, word) in words.into_iter().enumerate() {
        let is_sign = word == "="
            && all.last().is_some_and(|last| last.as_encoded_bytes().starts_with(b"--"));
        match all.last_mut() {
            Some(last) if is_sign || is_value => last.push(&word),
            _ => all.push(word),
        }
        is_value = is_sign;
        if at == index {
            new_index = all.len() - 1;
        }
    }
    (all, new_index)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_joined_to_their_options() {
        for (line, index, expected, new_index) in [
            ("p --a = b c", 3, "p --a=b c", 1),
            ("p --a = b c", 4, "p --a=b c", 2),
            ("p --a =", 2, "p --a=", 1),
            ("p = b", 1, "p = b", 1),
            ("p --a b", 2, "p --a b", 2),
        ] {
            let words = line.split(' ').map(OsString::from).collect();
            let (words, found) = joined(words, index);
            assert_eq!((words.join(" ".as_ref()), found), (expected.into(), new_index), "{line}");
        }
    }
}
