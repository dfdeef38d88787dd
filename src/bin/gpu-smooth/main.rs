//! The `gpu-smooth` command: reads a mesh, smooths it, writes it back with nothing else changed.

mod bench;
mod cli;
mod compare;
mod convert;
mod engine;
mod explain;
mod groups;
mod interrupt;
mod moving;
mod picture;
mod progress;
mod quality;
mod report;
mod riding;
mod smooth;
mod streams;
mod tell;
mod untangle;

use std::process::ExitCode;

use cli::{Cli, Command};

fn main() -> ExitCode {
    let cli = Cli::read();
    let done = match &cli.command {
        Some(Command::Quality(args)) => quality::run(args),
        Some(Command::Groups(args)) => groups::run(args),
        Some(Command::Compare(args)) => compare::run(args, &cli.output),
        Some(Command::Convert(args)) => convert::run(args, &cli.output),
        Some(Command::Adapters) => tell::adapters(),
        Some(Command::Metrics) => tell::metrics(),
        Some(Command::Bench(args)) => bench::run(args, cli.output.quiet),
        None => smooth::run(&cli.smooth, &cli.output),
    };
    match done {
        Ok(()) => interrupt::exit_code(),
        Err(message) => {
            tell::error(&message);
            ExitCode::FAILURE
        }
    }
}
