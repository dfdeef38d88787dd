//! Finds names of commands that were mistyped, and therefore taken for the input mesh.

use std::path::Path;

use clap::CommandFactory;

use crate::args::Cli;
use crate::error::CliError;

/// Largest number of inserted, deleted, replaced or swapped letters of a mistyped name.
const MAX_EDITS: usize = 2;
/// Length of the shortest word that is taken for the name of a command.
const MIN_LENGTH: usize = 5;

/// Checks that the input is not the mistyped name of a command.
///
/// # Errors
/// If no file has the name, and the name resembles that of a command.
pub(crate) fn check(input: &Path) -> Result<(), CliError> {
    let Some(word) = input.to_str().filter(|word| word.chars().all(|c| c.is_ascii_lowercase()))
    else {
        return Ok(());
    };
    if word.len() < MIN_LENGTH || input.exists() {
        return Ok(());
    }
    let program = Cli::command();
    let names = program.get_subcommands().map(|command| command.get_name());
    let edits = |name: &&str| strsim::osa_distance(word, name);
    match names.min_by_key(edits).filter(|name| edits(name) <= MAX_EDITS) {
        None => Ok(()),
        Some(name) => Err(CliError::usage(format!("`{word}` is neither a file nor a command"))
            .with_remedy(format!("There is a command `{name}`"))),
    }
}
