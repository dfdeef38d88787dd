//! The command line `gpu-smooth` as a function, for the program of this crate and for the Python package, which runs the
//! command line in its own process and draws with the same colors.
//!
//! With `--cfg fuzzing` it is a target of cargo-fuzz instead (`fuzz/Cargo.toml`), which tries command lines.

#![cfg_attr(fuzzing, no_main)]
#![cfg_attr(fuzzing, allow(dead_code))]

mod args;
mod color_scale;
mod commands;
mod error;
mod kept_layers;
mod limits;
mod load;
mod profiles;
mod render;
mod report;
mod request;
mod run;
mod similar;
mod terminal;

use std::ffi::OsString;
use std::io::Write;

use args::{Cli, Command, LogForm, SmoothArgs};
use commands::{
    adapters, batch, bench, compare, convert, groups, metrics, quality, shell, smooth, trial,
};
use error::CliError;
use request::{Meshes, SmoothRequest, mistyped};
use terminal::{Verbosity, interrupt, panics, process, tell, threads};

#[cfg(fuzzing)]
libfuzzer_sys::fuzz_target!(|bytes: &[u8]| request::checks::any_line(bytes));

/// The colors of pictures, which the Python package shares.
pub mod colors {
    pub use crate::color_scale::ColorScale;
    pub use crate::render::picture::{BAD, VIRIDIS};
}

/// The search for the name that a user has mistyped, which the Python package shares.
pub mod mistyped_names {
    pub use crate::similar::nearest;
}

/// Runs the command line `words`, whose first word is the name of the program, and returns the exit code for the process.
///
/// `program` are the words that start this program again in another process, such as the path of the executable. A run
/// tries the drivers of GPUs in such a process, as a driver may crash.
///
/// The function is the main function of a process, which calls it once and then ends. The function sets handlers of
/// signals and of panics, prints to standard output and standard error, and may end the process.
pub fn main_with(words: Vec<OsString>, program: Vec<OsString>) -> u8 {
    process::start(words, program);
    threads::join_pool();
    let code = panics::reporting_panics(run);
    // A process whose main function is not Rust's loses what is left in the buffer.
    let _ = std::io::stdout().flush();
    code
}

fn run() -> u8 {
    if shell::complete() {
        return 0;
    }
    let Cli { command, smooth, output } = match request::command_line() {
        Ok(cli) => cli,
        Err(code) => return code,
    };
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
