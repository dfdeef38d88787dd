//! Success rate and duration of untangling, by the way in which meshes are tangled.
//!
//! `cargo bench --bench untangle -- [VERTICES...] [WORD...]`, 2,000 and 57,000 vertices by default. With words, only
//! kinds of meshes are measured whose name contains one of them. Each kind has ten seeds. Seconds are elapsed time.
//! Processor seconds, summed over threads and averaged over seeds, depend less on other work of the machine (Linux
//! only).

#![allow(clippy::print_stdout)]

use std::time::Instant;

use gpu_smooth::{Mesh, Untangle};
use support::{boundaries, tangle};

const SEEDS: u64 = 10;

fn main() {
    let sizes: Vec<usize> = std::env::args().skip(1).filter_map(|arg| arg.parse().ok()).collect();
    let sizes = if sizes.is_empty() { vec![2_000, 57_000] } else { sizes };
    let outline = support::Outline::parse(include_str!("../meshes/plate.outline")).unwrap();
    println!(
        "| mesh | vertices | inverted or flat | untangled | sweeps: median, most | seconds: median, most | of the processor |"
    );
    println!("|---|---|---|---|---|---|---|");
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
        moved_boundaries(vertices);
        // The number of rings for which elements are equilateral.
        let around = (vertices as f64 * 5.2).sqrt() as usize;
        for degrees in [30.0, 90.0, 180.0] {
            let mesh = tangle::turned_hole(around, degrees / 360.0);
            row(&format!("ring, hole turned by {degrees} degrees"), [mesh].into_iter());
        }
    }
}

/// Untangles meshes with moved boundaries or inner lines, and layers of thin triangles.
fn moved_boundaries(vertices: usize) {
    let of = |kind: &str, make: &dyn Fn(u64) -> Mesh| row(kind, (1..=SEEDS).map(make));
    let columns = (vertices as f64).sqrt() as usize;
    let square = support::lattice(columns, columns);
    of("square, a bump pushed through", &|seed| boundaries::bumped(&square, columns, seed));
    of("square, sides bent by 130 to 324 degrees", &|seed| {
        boundaries::bent(&square, 0.3 + 0.06 * seed as f64)
    });
    of("a channel with a bent boundary", &|seed| boundaries::channel(vertices, seed));
    of("square, opposite sides pushed in past each other", &|seed| {
        boundaries::pushed(vertices, seed)
    });
    let three = boundaries::holes(3, vertices);
    of("three holes, each moved to the place of the next", &|seed| {
        boundaries::permuted(&three, 3, seed)
    });
    let five = boundaries::holes(5, vertices);
    of("five holes, each moved to the place of the next", &|seed| {
        boundaries::permuted(&five, 5, seed)
    });
    let two = boundaries::two_holes(vertices);
    of("two holes, one dragged past the other", &|seed| boundaries::past(&two, seed));
    of("two holes swapped", &|seed| boundaries::swapped(&two, seed));
    let regions = boundaries::regions(vertices);
    of("regions, vertices at random places", &|seed| tangle::scattered(&regions, seed));
    of("regions, the round one turned by 18 to 180 degrees", &|seed| {
        boundaries::turned_inside(&regions, 1.1, seed as f64 / 20.0)
    });
    let layers = boundaries::layers((vertices as f64 * 2.4).sqrt() as usize);
    of("layers 1:100, vertices at random places", &|seed| tangle::scattered(&layers, seed));
    of("layers 1:100, a folded strip", &|seed| tangle::folded(&layers, seed));
    of("layers 1:100, hole turned by 18 to 180 degrees", &|seed| {
        boundaries::turned_inside(&layers, 0.5001, seed as f64 / 20.0)
    });
}

/// Untangles several meshes of one kind, and prints a row of results.
fn row(kind: &str, meshes: impl Iterator<Item = Mesh>) {
    let is_word = |arg: &String| !arg.starts_with("--") && arg.parse::<usize>().is_err();
    let words: Vec<String> = std::env::args().skip(1).filter(is_word).collect();
    if !words.is_empty() && !words.iter().any(|word| kind.contains(word)) {
        return;
    }
    let (mut bad, mut sweeps, mut seconds) = (Vec::new(), Vec::new(), Vec::new());
    let (mut done, mut vertices, mut processor) = (0, 0, Some(0.0));
    for mesh in meshes {
        let before = processor_seconds();
        let start = Instant::now();
        let result = Untangle::new(&mesh).run().unwrap();
        seconds.push(start.elapsed().as_secs_f64());
        let spent = processor_seconds().zip(before).map(|(now, before)| now - before);
        processor = processor.zip(spent).map(|(sum, spent)| sum + spent);
        bad.push(result.bad_before);
        sweeps.push(result.sweeps);
        done += usize::from(result.left.is_empty() && result.overlapping.is_none());
        vertices = mesh.points.len();
    }
    bad.sort_unstable();
    sweeps.sort_unstable();
    seconds.sort_unstable_by(f64::total_cmp);
    let (count, middle) = (bad.len(), bad.len() / 2);
    let mean = processor.map_or("-".to_owned(), |sum: f64| format!("{:.3}", sum / count as f64));
    println!(
        "| {kind} | {vertices} | {} to {} | {done} of {count} | {}, {} | {:.3}, {:.3} | {mean} |",
        bad[0],
        bad[count - 1],
        sweeps[middle],
        sweeps[count - 1],
        seconds[middle],
        seconds[count - 1]
    );
}

/// Returns the processor time of this process in seconds, with a resolution of 0.01 s.
fn processor_seconds() -> Option<f64> {
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    // Fields 14 and 15; field 2 is a name in parentheses.
    let fields: Vec<&str> = stat.rsplit(')').next()?.split_whitespace().collect();
    let ticks: f64 = fields.get(11)?.parse::<f64>().ok()? + fields.get(12)?.parse::<f64>().ok()?;
    Some(ticks / 100.0)
}
