//! Random command lines. The environment variable `FUZZ_ROUNDS` multiplies their number.

#[allow(dead_code, unreachable_pub)]
#[path = "../../../tests/support/rng.rs"]
mod rng;

use std::collections::BTreeMap;

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
