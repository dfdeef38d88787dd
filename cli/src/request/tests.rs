//! Tests of random command lines, whose number the environment variable `FUZZ_ROUNDS` multiplies, and a test that each
//! option is used in a test.

#[allow(dead_code, unreachable_pub)]
#[path = "../../../tests/support/rng.rs"]
mod rng;

use std::collections::BTreeMap;
use std::path::Path;

use clap::CommandFactory;

use crate::args::Cli;
use crate::request::checks::{Checker, Choices};
use rng::SplitMix64;

impl Choices for SplitMix64 {
    fn below(&mut self, n: usize) -> usize {
        SplitMix64::below(self, n)
    }
}

#[test]
fn command_lines_of_any_words_are_refused_or_can_be_carried_out() {
    let factor: Option<usize> =
        std::env::var("FUZZ_ROUNDS").ok().and_then(|text| text.parse().ok());
    let mut random = SplitMix64::new(31);
    let checker = Checker::new();
    let mut seen = BTreeMap::<&str, usize>::new();
    for _ in 0..1000 * factor.unwrap_or(1) {
        *seen.entry(checker.check(&mut random)).or_default() += 1;
    }
    assert!(seen.len() >= 6 && seen.values().all(|count| *count > 8), "{seen:?}");
}

/// Returns whether a text contains `option`, and not only a longer name that begins with `option`.
fn names(text: &str, option: &str) -> bool {
    let is_longer = |c: char| c.is_ascii_alphanumeric() || c == '-';
    let mut found = text.match_indices(option);
    found.any(|(at, _)| !text[at + option.len()..].starts_with(is_longer))
}

#[test]
fn every_option_is_given_in_a_test_of_the_command_line() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cli");
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let texts = files.filter(|path| path.extension().is_some_and(|ending| ending == "rs"));
    let text: String = texts.map(|path| std::fs::read_to_string(path).unwrap()).collect();
    let program = Cli::command();
    for command in std::iter::once(&program).chain(program.get_subcommands()) {
        for option in command.get_arguments().filter_map(|arg| arg.get_long()) {
            let (option, name) = (format!("--{option}"), command.get_name());
            assert!(
                names(&text, &option),
                "no test gives {option} to {name}: add one to a file of cli/tests/cli, such as options.rs"
            );
        }
    }
    assert!(!names("--max-move 1", "--max") && names("--max 1", "--max"));
}
