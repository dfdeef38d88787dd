//! The table of pairs of options of a run that contradict each other.

use crate::args::{EngineChoice, MethodChoice, SmoothArgs};

/// Two options that do not go together.
pub(super) struct Conflict {
    /// The options as messages name them.
    pub(super) options: [&'static str; 2],
    /// Whether a command line has both options.
    has_both: fn(&SmoothArgs) -> bool,
    /// The sentence that refuses both options, where A and B stand for them.
    reason: &'static str,
}

const TOGETHER: &str = "A does not go with B: drop one of them";
const IDLE: &str = "B has no effect with A: drop one of them";
const PLACES: &str = "a target that belongs to places does not go with B: drop B, or let vertices take their targets along (--target-of vertex)";

const fn row(
    options: [&'static str; 2],
    reason: &'static str,
    has_both: fn(&SmoothArgs) -> bool,
) -> Conflict {
    Conflict { options, has_both, reason }
}

/// All pairs, in the order in which they are looked for.
pub(super) const CONFLICTS: &[Conflict] = &[
    row(["--target-of place", "--slide"], PLACES, |a| a.target.is_of_places() && a.sliding.slide),
    row(["--target-of place", "--max-move"], PLACES, |a| {
        a.target.is_of_places() && a.max_move.is_some()
    }),
    row(["--target-of place", "--fraction"], PLACES, |a| {
        a.target.is_of_places() && a.fraction.is_some()
    }),
    row(["--target-of place", "--desired"], PLACES, |a| {
        a.target.is_of_places() && a.desired.is_some()
    }),
    row(["--target-of place", "--keep-altitude"], PLACES, |a| {
        a.target.is_of_places() && a.keep_altitude
    }),
    row(["--target-of place", "--checkpoint"], PLACES, |a| {
        a.target.is_of_places() && a.checkpoint.is_some()
    }),
    row(["--target-of place", "--continue"], PLACES, |a| {
        a.target.is_of_places() && a.continued.is_some()
    }),
    row(["--keep-altitude", "--max-move"], TOGETHER, |a| a.keep_altitude && a.max_move.is_some()),
    row(["--keep-altitude", "--checkpoint"], TOGETHER, |a| {
        a.keep_altitude && a.checkpoint.is_some()
    }),
    row(["--keep-altitude", "--continue"], TOGETHER, |a| a.keep_altitude && a.continued.is_some()),
    row(["--max-move", "--untangle"], TOGETHER, |a| a.max_move.is_some() && a.untangle),
    row(["--max-move", "--checkpoint"], TOGETHER, |a| {
        a.max_move.is_some() && a.checkpoint.is_some()
    }),
    row(["--max-move", "--continue"], TOGETHER, |a| a.max_move.is_some() && a.continued.is_some()),
    row(["--slide", "--checkpoint or --continue"], TOGETHER, |a| {
        a.sliding.slide && (a.checkpoint.is_some() || a.continued.is_some())
    }),
];

/// Pairs of which one option has no effect. They are looked for after all others.
pub(super) const WITHOUT_EFFECT: &[Conflict] = &[
    row(["--method paper", "--omega"], IDLE, |a| {
        a.method == MethodChoice::Paper && a.omega.is_some()
    }),
    row(["--method multilevel", "--omega"], IDLE, |a| {
        a.method == MethodChoice::Multilevel && a.omega.is_some()
    }),
    row(["--engine cpu", "--adapter"], IDLE, |a| {
        a.engine == EngineChoice::Cpu && a.adapter.is_some()
    }),
];

/// Words the first conflict of a table that a command line has.
pub(super) fn first(table: &[Conflict], args: &SmoothArgs) -> Option<String> {
    let found = table.iter().find(|conflict| (conflict.has_both)(args))?;
    let [a, b] = found.options;
    Some(found.reason.replace('A', a).replace('B', b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::request::command_line::checked;

    /// Returns the words that give an option of the table on a command line.
    fn words(option: &str) -> Vec<&str> {
        let value = match option {
            "--target-of place" => return vec!["--target", "keep-shape", "--target-of", "place"],
            "--checkpoint or --continue" => return vec!["--checkpoint", "state"],
            "--max-move" | "--fraction" | "--desired" | "--omega" => Some("0.5"),
            "--checkpoint" | "--continue" | "--adapter" => Some("name"),
            _ => None,
        };
        option.split(' ').chain(value).collect()
    }

    #[test]
    fn each_pair_is_refused_by_its_own_words() {
        for row in CONFLICTS.iter().chain(WITHOUT_EFFECT) {
            let [a, b] = row.options;
            let line = ["gpu-smooth", "in", "out"].into_iter().chain(words(a)).chain(words(b));
            let error = checked(line.map(Into::into)).err().map(|error| error.to_string());
            let reason = row.reason.replace('A', a).replace('B', b);
            assert!(error.is_some_and(|error| error.contains(&reason)), "{a} and {b}");
        }
    }
}
