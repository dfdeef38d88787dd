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

use args::{Command, LogForm};
use commands::{adapters, batch, bench, compare, convert, groups, metrics, quality, shell, smooth};
use terminal::{interrupt, panics, tell};

#[cfg(fuzzing)]
libfuzzer_sys::fuzz_target!(|bytes: &[u8]| request::checks::any_line(bytes));

fn main() -> ExitCode {
    panics::told(run)
}

fn run() -> ExitCode {
    let cli = request::read();
    if cli.output.log == LogForm::Json {
        tell::log_json();
    }
    interrupt::survive_large_files();
    let done = match &cli.command {
        Some(Command::Quality(args)) => quality::run(args),
        Some(Command::Groups(args)) => groups::run(args),
        Some(Command::Compare(args)) => compare::run(args, &cli.output),
        Some(Command::Convert(args)) => convert::run(args, &cli.output),
        Some(Command::Adapters(args)) => adapters::run(args),
        Some(Command::Metrics) => metrics::run(),
        Some(Command::Bench(args)) => bench::run(args, cli.output.quiet),
        Some(Command::Completions(args)) => shell::completions(args),
        Some(Command::Man(args)) => shell::man(args),
        None => match &cli.smooth.out_dir {
            Some(directory) => batch::run(&cli.smooth, directory, &cli.output),
            None => smooth::run(&cli.smooth, &cli.output),
        },
    };
    match done {
        Ok(()) => interrupt::exit_code(),
        Err(error) => {
            tell::error(&error);
            error.kind.exit_code()
        }
    }
}
