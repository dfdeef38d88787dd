//! How many tangled meshes are untangled, and how long that takes.
//!
//! `cargo bench --bench untangle -- [VERTICES...]`, 2,000 and 57,000 by default. Ten seeds of each kind.

#![allow(clippy::print_stdout)]

#[path = "../tests/support/mod.rs"]
mod support;

use std::ops::ControlFlow;
use std::time::Instant;

use gpu_smooth::{Mesh, Precision, untangle};
use support::tangle;

const SEEDS: u64 = 10;

fn main() {
    let sizes: Vec<usize> = std::env::args().filter_map(|arg| arg.parse().ok()).collect();
    let sizes = if sizes.is_empty() { vec![2_000, 57_000] } else { sizes };
    let outline = support::Outline::parse(include_str!("../meshes/plate.outline")).unwrap();
    println!(
        "| mesh | vertices | inverted or flat | untangled | sweeps: median, most | seconds: median, most |"
    );
    println!("|---|---|---|---|---|---|");
    for vertices in sizes {
        let plate = support::triangulate(&outline, vertices).unwrap();
        let columns = (vertices as f64).sqrt() as usize;
        let square = support::lattice(columns, columns);
        for (name, mesh) in [("square", &square), ("plate", &plate)] {
            let of = |kind: &str, make: &dyn Fn(u64) -> Mesh| {
                row(&format!("{name}, {kind}"), (1..=SEEDS).map(make));
            };
            of("vertices at random places", &|seed| tangle::scattered(mesh, seed));
            of("noise over three edges", &|seed| tangle::noisy(mesh, 3.0, seed));
            of("noise over ten edges", &|seed| tangle::noisy(mesh, 10.0, seed));
            of("all at one place", &|seed| tangle::collapsed(mesh, seed));
            of("a folded strip", &|seed| tangle::folded(mesh, seed));
            of("inside turned by 18 to 180 degrees", &|seed| {
                tangle::turned(mesh, seed as f64 / 20.0)
            });
        }
        // As many rings as make elements equilateral.
        let around = (vertices as f64 * 5.2).sqrt() as usize;
        for degrees in [30.0, 90.0, 180.0] {
            let mesh = tangle::turned_hole(around, degrees / 360.0);
            row(&format!("ring, hole turned by {degrees} degrees"), [mesh].into_iter());
        }
    }
}

/// Untangles meshes of one kind and prints a row on all of them.
fn row(kind: &str, meshes: impl Iterator<Item = Mesh>) {
    let (mut bad, mut sweeps, mut seconds) = (Vec::new(), Vec::new(), Vec::new());
    let (mut done, mut vertices) = (0, 0);
    for mesh in meshes {
        let start = Instant::now();
        let result =
            untangle(&mesh, Precision::Double, &mut |_| ControlFlow::Continue(())).unwrap();
        seconds.push(start.elapsed().as_secs_f64());
        bad.push(result.bad_before);
        sweeps.push(result.sweeps);
        done += usize::from(result.left.is_empty() && result.overlapping.is_none());
        vertices = mesh.points.len();
    }
    bad.sort_unstable();
    sweeps.sort_unstable();
    seconds.sort_unstable_by(f64::total_cmp);
    let (count, middle) = (bad.len(), bad.len() / 2);
    println!(
        "| {kind} | {vertices} | {} to {} | {done} of {count} | {}, {} | {:.3}, {:.3} |",
        bad[0],
        bad[count - 1],
        sweeps[middle],
        sweeps[count - 1],
        seconds[middle],
        seconds[count - 1]
    );
}
