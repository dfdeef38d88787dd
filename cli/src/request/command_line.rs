//! The command line of the process, parsed and checked.

use std::ffi::OsString;
use std::path::Path;

use clap::error::ErrorKind;
use clap::parser::ValueSource;
use clap::{Arg, ArgMatches, CommandFactory, FromArgMatches};
use gpu_smooth::options::WorstBy;

use crate::args::{self, Cli, Command, OutputArgs};
use crate::request::conflicts::{self, OF_BENCH, OF_COMPARE, OF_CONVERT, OF_QUALITY, OF_RUN};
use crate::request::mistyped;
use crate::terminal::{Verbosity, process};

/// Parses the command line of this process.
///
/// # Errors
/// If the command line is invalid, or asks for help or the version, prints the answer and returns the exit code.
pub(crate) fn command_line() -> Result<Cli, u8> {
    let words = process::command_line();
    checked(words.clone()).map_err(|error| {
        // A mistyped command is taken for a mesh, for which its options and arguments may be wrong.
        let mistyped = Some(mistyped::message(&words)).filter(|_| error.use_stderr()).flatten();
        let error = mistyped
            .map(|text| Cli::command().error(ErrorKind::InvalidSubcommand, text))
            .unwrap_or(error);
        answered(&error)
    })
}

/// Prints an error of the command line, or the requested help or version. Returns the exit code.
pub(crate) fn answered(error: &clap::Error) -> u8 {
    // A closed terminal is no reason for another error.
    let _ = error.print();
    u8::try_from(error.exit_code()).unwrap_or(2)
}

/// Parses a command line, whose first word is the name of the program. Checks the values of options, and that
/// no options contradict each other.
///
/// # Errors
/// The error describes the invalid words, or contains the requested help or version.
pub(crate) fn checked(words: impl IntoIterator<Item = OsString>) -> Result<Cli, clap::Error> {
    let matches = args::command().try_get_matches_from(words)?;
    let refused = |kind, text: String| Err(Cli::command().error(kind, text));
    if let Some(text) = misplaced(&matches) {
        return refused(ErrorKind::ArgumentConflict, text);
    }
    let mut cli = Cli::from_arg_matches(&matches)?;
    cli.smooth.take_metric_of_profile();
    if let (None, Some(extra)) = (&cli.smooth.out_dir, cli.smooth.more.first()) {
        let extra = extra.display();
        // Options whose value may be left out take a value only after `=`.
        let is_measure = WorstBy::ALL.iter().any(|by| by.name() == extra.to_string());
        // The usual first words of other programs.
        let verb =
            [&cli.smooth.input, &cli.smooth.output].map(|path| path.clone().unwrap_or_default());
        let is_verb =
            ["smooth", "run"].iter().any(|word| verb[0] == Path::new(word)) && !verb[0].exists();
        let text = match is_measure {
            true => format!(
                "unexpected argument '{extra}' after IN and OUT: write --improve-worst={extra}"
            ),
            false if is_verb => format!(
                "'{}' is no command: write gpu-smooth {} {extra}",
                verb[0].display(),
                verb[1].display()
            ),
            false => format!(
                "unexpected argument '{extra}' after IN and OUT: give one mesh per run, or --out-dir DIR for several meshes"
            ),
        };
        return refused(ErrorKind::UnknownArgument, text);
    }
    match contradiction(&cli) {
        Some(text) => Err(command_of(&matches).error(ErrorKind::ArgumentConflict, text)),
        None => Ok(cli),
    }
}

impl From<&OutputArgs> for Verbosity {
    fn from(args: &OutputArgs) -> Self {
        Self { quiet: args.quiet, verbose: args.verbose }
    }
}

/// Returns a message about the first pair of conflicting options; `None` without conflicts.
fn contradiction(cli: &Cli) -> Option<String> {
    match &cli.command {
        None => {
            let first = conflicts::first(OF_RUN, &cli.smooth);
            first.or_else(|| conflicts::of_table(&cli.smooth))
        }
        Some(Command::Quality(args)) => conflicts::first(OF_QUALITY, args),
        Some(Command::Bench(args)) => conflicts::first(OF_BENCH, args),
        Some(Command::Compare(args)) => conflicts::first(OF_COMPARE, args),
        Some(Command::Convert(args)) => conflicts::first(OF_CONVERT, args),
        Some(
            Command::Groups(_)
            // The tried runs are checked one by one.
            | Command::Try(_)
            | Command::Adapters(_)
            | Command::Metrics
            | Command::Completions(_)
            | Command::Man(_),
        ) => None,
    }
}

/// Returns the definition of the command that a command line names, for the usage in an error.
fn command_of(matches: &ArgMatches) -> clap::Command {
    let mut program = Cli::command();
    program.build();
    let named = matches.subcommand_name().and_then(|name| program.find_subcommand(name));
    named.cloned().unwrap_or(program)
}

/// Returns the error message if a command follows arguments of a run; `None` if none does.
fn misplaced(matches: &ArgMatches) -> Option<String> {
    let name = matches.subcommand_name()?;
    let command = Cli::command();
    let given = |arg: &&Arg| {
        let source = matches.value_source(arg.get_id().as_str());
        !arg.is_global_set() && source == Some(ValueSource::CommandLine)
    };
    let arg = command.get_arguments().find(given)?;
    Some(match arg.get_long() {
        Some(long) => {
            format!(
                "'--{long}' stands before the command '{name}': put the options of a command after it"
            )
        }
        None => format!(
            "'{name}' is a command, and commands precede meshes; write ./{name} for a file of that name"
        ),
    })
}
