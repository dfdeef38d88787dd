//! The commands `gpu-smooth completions` and `gpu-smooth man`, which derive completions and manual pages from
//! the definitions of the options.

use std::ffi::OsString;
use std::fs;
use std::path::Path;

use clap::parser::ValueSource;
use clap::{Args, Command, CommandFactory};
use clap_complete::env::{CompleteEnv, Elvish, Fish, Powershell, Shells, Zsh};
use clap_mangen::Man;
use mesh_io::atomic;

use crate::args::{Cli, CompletionsArgs, ManArgs, OutputArgs, SmoothArgs};
use crate::commands::bash_words::BashWords;
use crate::error::CliError;
use crate::terminal::{process, tell};

/// Name of the program in scripts of shells.
const PROGRAM: &str = "gpu-smooth";
/// Environment variable by which a script of a shell asks the program for completions. The value is the name of the
/// shell.
const VARIABLE: &str = "GPU_SMOOTH_COMPLETE";
/// The shells with completions.
const SHELLS: Shells<'static> = Shells(&[&BashWords, &Elvish, &Fish, &Powershell, &Zsh]);

/// Answers a script of a shell that asks for completions, and returns true. Does nothing in all other calls, and returns
/// false.
pub(crate) fn complete() -> bool {
    let line = process::command_line();
    // The script passes the words of the command line after `--`. The last word is incomplete.
    let mut words: Vec<OsString> = line.iter().skip_while(|word| *word != "--").cloned().collect();
    words.pop();
    let program = move || program_after(words.get(1..).unwrap_or_default());
    let script = CompleteEnv::with_factory(program).var(VARIABLE).bin(PROGRAM).shells(SHELLS);
    let directory = std::env::current_dir().ok();
    script.try_complete(line, directory.as_deref()).unwrap_or_else(|error| error.exit())
}

/// Returns the definition of the program for the completion of the word after `words`, the first of which is the name
/// of the program. Commands precede meshes, so the definition has no commands if the words have a mesh.
fn program_after(words: &[OsString]) -> Command {
    let matches = Cli::command().ignore_errors(true).try_get_matches_from(words);
    let has_mesh =
        matches.is_ok_and(|found| found.value_source("input") == Some(ValueSource::CommandLine));
    match has_mesh {
        true => {
            let program = Command::new(PROGRAM).version(env!("CARGO_PKG_VERSION"));
            OutputArgs::augment_args(SmoothArgs::augment_args(program))
        }
        false => Cli::command(),
    }
}

/// Prints the script by which a shell asks the program for completions.
pub(crate) fn completions(args: &CompletionsArgs) -> Result<(), CliError> {
    let mut text = Vec::new();
    let shell = args.shell.to_string();
    let written = SHELLS.completer(&shell).map(|completer| {
        completer.write_registration(VARIABLE, PROGRAM, PROGRAM, PROGRAM, &mut text)
    });
    if !matches!(written, Some(Ok(()))) {
        return Err(CliError::run(format!("there are no completions for {shell}")));
    }
    tell::say_data(String::from_utf8_lossy(&text).trim_end());
    Ok(())
}

/// Prints the manual page of the program, or writes all pages into a directory.
pub(crate) fn man(args: &ManArgs) -> Result<(), CliError> {
    let mut program = Cli::command();
    program.build();
    let Some(directory) = &args.directory else {
        tell::say_data(String::from_utf8_lossy(&page(program)?).trim_end());
        return Ok(());
    };
    let refused = |error| {
        CliError::output(format!("{}: the directory cannot be made: {error}", directory.display()))
    };
    fs::create_dir_all(directory).map_err(refused)?;
    let commands: Vec<Command> = program.get_subcommands().cloned().collect();
    write(directory, "gpu-smooth", program)?;
    for command in commands.into_iter().filter(|command| command.get_name() != "help") {
        write(directory, &format!("gpu-smooth-{}", command.get_name()), command)?;
    }
    Ok(())
}

fn write(directory: &Path, name: &str, command: Command) -> Result<(), CliError> {
    let path = directory.join(format!("{name}.1"));
    Ok(atomic::write(&path, &page(command)?)?)
}

/// Returns a manual page in roff.
fn page(command: Command) -> Result<Vec<u8>, CliError> {
    let mut page = Vec::new();
    Man::new(command).render(&mut page).map_err(|error| CliError::run(error.to_string()))?;
    Ok(page)
}
