//! The `gpu-smooth` command: reads a mesh, smooths it, writes it back with nothing else changed.
//!
//! With `--cfg fuzzing` it is a target of cargo-fuzz instead (`fuzz/Cargo.toml`), which tries command lines.

#![cfg_attr(fuzzing, no_main)]
#![cfg_attr(fuzzing, allow(dead_code))]

mod args;
mod commands;
mod error;
mod load;
mod render;
mod report;
mod request;
mod run;
mod terminal;

use std::process::ExitCode;

use args::{Cli, Command, LogForm, SmoothArgs};
use commands::{
    adapters, batch, bench, compare, convert, groups, metrics, quality, shell, smooth, trial,
};
use error::CliError;
use request::{Meshes, SmoothRequest, mistyped};
use terminal::{Verbosity, interrupt, panics, tell};

#[cfg(fuzzing)]
libfuzzer_sys::fuzz_target!(|bytes: &[u8]| request::checks::any_line(bytes));

fn main() -> ExitCode {
    panics::reporting_panics(run)
}

fn run() -> ExitCode {
    shell::complete();
    let Cli { command, smooth, output } = request::command_line();
    if output.log == LogForm::Json {
        tell::log_json();
    }
    interrupt::survive_large_files();
    let done = match command {
        Some(Command::Quality(args)) => quality::run(&args, (&output).into()),
        Some(Command::Try(args)) => trial::run(&args, (&output).into()),
        Some(Command::Groups(args)) => groups::run(&args),
        Some(Command::Compare(args)) => compare::run(args, &output),
        Some(Command::Convert(args)) => convert::run(&args, &output),
        Some(Command::Adapters(args)) => adapters::run(&args),
        Some(Command::Metrics) => metrics::run(),
        Some(Command::Bench(args)) => bench::run(&args, output.quiet),
        Some(Command::Completions(args)) => shell::completions(&args),
        Some(Command::Man(args)) => shell::man(&args),
        None => smooth_meshes(smooth, (&output).into()),
    };
    match done {
        Ok(()) => interrupt::exit_code(),
        Err(error) => {
            tell::error(&error);
            error.kind.exit_code()
        }
    }
}

/// Smooths the mesh, or the meshes, of the command line.
fn smooth_meshes(args: SmoothArgs, verbosity: Verbosity) -> Result<(), CliError> {
    let request = SmoothRequest::new(args)?;
    match &request.meshes {
        Meshes::One { input, output } => {
            mistyped::check(input)?;
            smooth::run(&request, input, output, verbosity)
        }
        Meshes::Many(meshes) => batch::run(&request, meshes, verbosity),
    }
}
