//! Generates a mesh of the domain enclosed by an outline, and perturbs or distorts the mesh as an input for
//! smoothing:
//!
//! ```text
//! cargo run --release --example make_mesh -- OUTLINE OUT_STEM [--vertices N] [--perturb S | --distort A] [--seed K]
//! ```
//!
//! Writes OUT_STEM.node and OUT_STEM.ele. `meshes/README.md` contains the command for the mesh in that folder.
#![allow(clippy::print_stdout, clippy::print_stderr)]

use std::process::ExitCode;
use std::time::Instant;
use support::Recipe;

fn main() -> ExitCode {
    let args: Vec<_> = std::env::args().skip(1).collect();
    match run(&args) {
        Ok(()) => ExitCode::SUCCESS,
        Err(problem) => {
            eprintln!("make_mesh: {problem}");
            ExitCode::FAILURE
        }
    }
}

fn run(args: &[String]) -> Result<(), String> {
    let recipe = Recipe::parse(args)?;
    let start = Instant::now();
    let mesh = recipe.mesh()?;
    let seconds = start.elapsed().as_secs_f64();
    println!("{} vertices, {} triangles, {seconds:.1} s", mesh.points.len(), mesh.triangles.len());
    println!(
        "f_imr {:.4}, worst {:.1}, smallest angle {:.2} degrees",
        support::f_imr(&mesh),
        support::worst_imr(&mesh),
        support::min_angle(&mesh)
    );
    support::write_triangle(&mesh, &recipe.stem, &recipe.command)
        .map_err(|e| format!("{}: {e}", recipe.stem.display()))
}
