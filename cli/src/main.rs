//! The `gpu-smooth` command: reads a mesh, smooths it, writes it back with nothing else changed.
//!
//! With `--cfg fuzzing` it is a target of cargo-fuzz instead (`fuzz/Cargo.toml`), which tries command lines.

#![cfg_attr(fuzzing, no_main)]
#![cfg_attr(fuzzing, allow(dead_code))]

mod adapters;
mod bench;
mod cli;
mod columns;
mod compare;
mod convert;
mod engine;
mod explain;
mod follow;
mod groups;
mod html;
mod interrupt;
mod keep;
mod load;
mod many;
mod moving;
mod numbers;
mod panics;
mod picture;
mod progress;
mod proof;
mod quality;
mod read_args;
mod report;
mod riding;
mod run_args;
mod shell;
mod slide_args;
mod smooth;
mod streams;
mod summary;
mod surface_args;
mod target_args;
mod task;
mod tell;
mod trial;
mod untangle;
mod worst_args;

use std::process::ExitCode;

use cli::{Cli, Command, LogForm};

#[cfg(fuzzing)]
libfuzzer_sys::fuzz_target!(|bytes: &[u8]| cli::checks::any_line(bytes));

fn main() -> ExitCode {
    panics::told(run)
}

fn run() -> ExitCode {
    let cli = Cli::read();
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
        Some(Command::Metrics) => tell::metrics(),
        Some(Command::Bench(args)) => bench::run(args, cli.output.quiet),
        Some(Command::Completions(args)) => shell::completions(args),
        Some(Command::Man(args)) => shell::man(args),
        None => match &cli.smooth.out_dir {
            Some(directory) => many::run(&cli.smooth, directory, &cli.output),
            None => smooth::run(&cli.smooth, &cli.output),
        },
    };
    match done {
        Ok(()) => interrupt::exit_code(),
        Err(message) => {
            tell::error(&message);
            ExitCode::FAILURE
        }
    }
}
