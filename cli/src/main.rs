//! The `gpu-smooth` command: reads a mesh, smooths it, writes it back with nothing else changed.

use std::process::ExitCode;

fn main() -> ExitCode {
    let program = std::env::current_exe().map(Into::into).into_iter().collect();
    gpu_smooth_cli::main_with(std::env::args_os().collect(), program).into()
}
