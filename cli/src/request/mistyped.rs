//! Finds names of commands that were mistyped, and therefore taken for the input mesh.

use std::ffi::OsString;
use std::path::Path;

use clap::CommandFactory;

use crate::args::Cli;
use crate::error::CliError;
use crate::similar;

/// Checks that the input is not the mistyped name of a command.
///
/// # Errors
/// If no file has the name, and the name resembles that of a command.
pub(crate) fn check(input: &Path) -> Result<(), CliError> {
    match meant(input) {
        None => Ok(()),
        Some(name) => Err(CliError::usage(problem(input)).with_remedy(remedy(&name))),
    }
}

/// Returns the message for a refused command line whose first word is the mistyped name of a command; `None` for any
/// other command line. `words` begins with the name of the program.
pub(crate) fn message(words: &[OsString]) -> Option<String> {
    let is_option = |word: &OsString| word.as_encoded_bytes().starts_with(b"-");
    let input = Path::new(words.iter().skip(1).find(|word| !is_option(word))?);
    Some(format!("{}. {}", problem(input), remedy(&meant(input)?)))
}

fn problem(input: &Path) -> String {
    format!("`{}` is neither a file nor a command", input.display())
}

fn remedy(name: &str) -> String {
    format!("There is a command `{name}`")
}

/// Returns the command whose name resembles `input` and differs from `input`. `None` if no command has such a name, or if
/// `input` is the name of a file.
fn meant(input: &Path) -> Option<String> {
    let word = input.to_str().filter(|word| word.chars().all(|c| c.is_ascii_alphabetic()))?;
    // A Triangle mesh may be given without an extension.
    let is_mesh =
        input.exists() || ["node", "ele"].iter().any(|e| input.with_extension(e).exists());
    if is_mesh {
        return None;
    }
    let program = Cli::command();
    let names = program.get_subcommands().map(|command| command.get_name()).chain(["help"]);
    similar::nearest(word, names.map(str::to_owned))
}
