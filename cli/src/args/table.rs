//! The options of the table that the command line shares with the Python package, as arguments of clap.

use std::ffi::OsStr;
use std::marker::PhantomData;
use std::ops::Deref;

use clap::builder::{PossibleValue, TypedValueParser, ValueParser};
use clap::error::ErrorKind;
use clap::parser::ValueSource;
use clap::{Arg, ArgAction, ArgMatches, Args, Command, FromArgMatches};
use clap_complete::engine::ArgValueCompleter;
use gpu_smooth_job::options::{GivenOptions, Kind, OPTIONS, OptionRow, Settings, Spelling};

use crate::args::names;

/// The options of the table that a command has.
pub(crate) trait Selection {
    /// Returns whether the command has an option.
    fn has(name: &str) -> bool;
}

macro_rules! selection {
    ($(#[$doc:meta])* $selection:ident: $names:expr) => {
        $(#[$doc])*
        pub(crate) struct $selection;

        impl Selection for $selection {
            fn has(name: &str) -> bool {
                $names.contains(&name)
            }
        }
    };
}

/// All options are options of a run.
pub(crate) struct OfRun;

impl Selection for OfRun {
    fn has(_: &str) -> bool {
        true
    }
}

selection! {
    /// Options of each run of `gpu-smooth try`.
    OfTrial: [
        "engine", "surface", "z", "slide", "corner-angle", "hausdorff", "free-lines", "only-bad", "rings", "max-move", "keep-altitude",
        "untangle",
    ]
}
selection! {
    /// Options of `gpu-smooth compare`.
    OfComparison: ["surface", "z", "slide", "corner-angle", "hausdorff", "free-lines", "only-bad", "rings"]
}
selection! {
    /// Options of `gpu-smooth bench`.
    OfBench: ["scheme", "engine", "adapter", "surface", "z"]
}
selection! {
    /// Options of commands that read a mesh.
    OfCoordinates: ["surface", "z"]
}

/// The options of the table that a command line has.
pub(crate) struct TableArgs<S> {
    given: GivenOptions,
    of: PhantomData<S>,
}

impl<S> TableArgs<S> {
    pub(crate) fn settings(&self) -> &Settings {
        self.given.settings()
    }

    /// Sets an option to a valid value, as if the command line had it.
    pub(crate) fn set(&mut self, name: &str, text: &str) {
        if let Some(row) = GivenOptions::row(name) {
            // The value is valid.
            let _ = self.given.set(row, text);
        }
    }
}

impl<S> Deref for TableArgs<S> {
    type Target = GivenOptions;

    fn deref(&self) -> &GivenOptions {
        &self.given
    }
}

impl<S: Selection> Args for TableArgs<S> {
    fn augment_args(command: Command) -> Command {
        command.args(rows::<S>().map(arg))
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl<S: Selection> FromArgMatches for TableArgs<S> {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let mut given = GivenOptions::default();
        for row in rows::<S>() {
            if matches.value_source(row.name) != Some(ValueSource::CommandLine) {
                continue;
            }
            let text = match row.kind {
                Kind::Flag(_) => "true",
                _ => matches.get_one::<String>(row.name).map_or("", String::as_str),
            };
            // The parser of the value has accepted the text.
            given.set(row, text).map_err(|text| clap::Error::raw(ErrorKind::InvalidValue, text))?;
        }
        Ok(Self { given, of: PhantomData })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

fn rows<S: Selection>() -> impl Iterator<Item = &'static OptionRow> {
    OPTIONS.iter().filter(|row| S::has(row.name))
}

/// Returns the argument of an option.
fn arg(row: &'static OptionRow) -> Arg {
    let arg = Arg::new(row.name)
        .long(row.name)
        .help(row.help(Spelling::CommandLine))
        .help_heading(row.heading)
        .conflicts_with_all(row.excludes);
    let arg = row.needs.iter().fold(arg, |arg, name| arg.requires(name));
    if let Kind::Flag(_) = row.kind {
        return arg.action(ArgAction::SetTrue);
    }
    let arg = arg.value_name(row.placeholder).value_parser(ValueParser::new(RowParser(row)));
    let arg = match row.default {
        "" => arg,
        default => arg.default_value(default),
    };
    match row.kind {
        Kind::Count(..) | Kind::Number(..) | Kind::NumberOrAuto(..) | Kind::Seconds(_) => {
            arg.allow_negative_numbers(true)
        }
        Kind::WordOrFlag([word, ..], _) => {
            arg.num_args(0..=1).require_equals(true).default_missing_value(*word)
        }
        Kind::Scheme(_) => {
            arg.hide_possible_values(true).add(ArgValueCompleter::new(names::completed_schemes))
        }
        _ => arg,
    }
}

/// The parser of the values of an option, which keeps the text.
#[derive(Clone)]
struct RowParser(&'static OptionRow);

impl TypedValueParser for RowParser {
    type Value = String;

    fn parse_ref(
        &self,
        command: &Command,
        arg: Option<&Arg>,
        value: &OsStr,
    ) -> Result<String, clap::Error> {
        if let Kind::Word(words, _) | Kind::WordOrFlag(words, _) = self.0.kind {
            let words = clap::builder::PossibleValuesParser::new(words);
            return words.parse_ref(command, arg, value);
        }
        let row = self.0;
        let checked =
            |text: &str| row.set(&mut Settings::default(), text).map(|()| text.to_owned());
        checked.parse_ref(command, arg, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        let has_words =
            !matches!(self.0.kind, Kind::NumberOrAuto(..)) && !self.0.words().is_empty();
        has_words.then(|| -> Box<dyn Iterator<Item = _>> {
            Box::new(self.0.words().into_iter().map(PossibleValue::new))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A command would lack an option without notice if the table did not have the name.
    #[test]
    fn each_name_of_a_command_is_an_option_of_the_table() {
        let count = |has: fn(&str) -> bool| OPTIONS.iter().filter(|row| has(row.name)).count();
        assert_eq!(count(OfTrial::has), 12);
        assert_eq!(count(OfComparison::has), 8);
        assert_eq!(count(OfBench::has), 5);
        assert_eq!(count(OfCoordinates::has), 2);
    }
}
