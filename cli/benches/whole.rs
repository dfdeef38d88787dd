//! Measurements of the whole program from file to file: time, memory, and the quality of the written mesh. Also runs
//! mmg2d for comparison if `mmg2d_O3` is on the path.
//!
//! ```text
//! cargo bench -p gpu-smooth-cli --bench whole -- 62534 1000000          # vertices
//! ```

#![allow(clippy::print_stdout)]

use std::fmt::Write;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use std::{fs, thread};

use gpu_smooth::{Mesh, Metric, Quality, Topology};

/// Number of timed runs, of which the median counts.
const REPEATS: usize = 7;

fn main() {
    let sizes: Vec<usize> = std::env::args().filter_map(|arg| arg.parse().ok()).collect();
    let sizes = if sizes.is_empty() { vec![62_534] } else { sizes };
    let outline = support::Outline::parse(include_str!("../../meshes/plate.outline")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    for vertices in sizes {
        let plate = support::triangulate(&outline, vertices).unwrap();
        let mesh = support::perturb_random(&plate, 1.0, 1);
        let input = folder.path().join("in");
        support::write_triangle(&mesh, &input, "perturbed").unwrap();
        println!("{} vertices, {} triangles", mesh.points.len(), mesh.triangles.len());
        for engine in ["cpu", "gpu"] {
            for tolerance in ["1e-3", "1e-6"] {
                let output = folder.path().join("out");
                let mut command = Command::new(env!("CARGO_BIN_EXE_gpu-smooth"));
                command.args([&input, &output]);
                command.args(["--quiet", "--engine", engine, "--tolerance", tolerance]);
                let Some(run) = measure(&mut command) else { continue };
                let mesh = support::read_mesh(&output.with_extension("node"));
                tell(&format!("gpu-smooth, {engine}, to {tolerance}"), &run, &mesh);
            }
        }
        let [input, output] = ["in.mesh", "out.mesh"].map(|name| folder.path().join(name));
        fs::write(&input, medit(&mesh)).unwrap();
        let mut command = Command::new("mmg2d_O3");
        command.args(["-optim", "-noinsert", "-noswap", "-nosurf", "-v", "0"]);
        command.arg("-in").arg(&input).arg("-out").arg(&output);
        if let Some(run) = measure(&mut command) {
            tell("mmg2d -optim -noinsert -noswap", &run, &read_medit(&output));
        }
    }
}

struct Measured {
    seconds: f64,
    /// Peak resident memory of the process in MB; 0 on systems other than Linux.
    peak: f64,
}

/// Measures a command; `None` if the program does not exist or fails.
fn measure(command: &mut Command) -> Option<Measured> {
    let mut times = Vec::new();
    let mut peak = 0f64;
    for repeat in 0..=REPEATS {
        let start = Instant::now();
        let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().ok()?;
        // The first run is not timed and serves to observe the memory.
        while repeat == 0 && child.try_wait().unwrap().is_none() {
            peak = peak.max(resident(child.id()).unwrap_or(0.0));
            thread::sleep(Duration::from_millis(1));
        }
        if !child.wait().unwrap().success() {
            println!("{command:?} failed");
            return None;
        }
        if repeat > 0 {
            times.push(start.elapsed().as_secs_f64());
        }
    }
    times.sort_by(f64::total_cmp);
    Some(Measured { seconds: times[REPEATS / 2], peak })
}

/// Returns the peak resident memory of a process so far, in MB; `None` on systems other than Linux.
fn resident(process: u32) -> Option<f64> {
    let status = fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(line.trim().trim_end_matches("kB").trim().parse::<f64>().ok()? / 1e3)
}

fn tell(what: &str, run: &Measured, mesh: &Mesh) {
    let quality = Quality::of(&mesh.points, &Topology::new(mesh).unwrap()).unwrap();
    println!(
        "  {what:<32} {:>7.3} s {:>6.0} MB   f {:.6}, worst {:.2}, {} inverted",
        run.seconds,
        run.peak,
        quality.f(Metric::Imr),
        quality.worst_imr,
        quality.inverted
    );
}

fn medit(mesh: &Mesh) -> String {
    let mut text =
        format!("MeshVersionFormatted 2\nDimension 2\nVertices\n{}\n", mesh.points.len());
    for [x, y] in &mesh.points {
        writeln!(text, "{x} {y} 0").unwrap();
    }
    writeln!(text, "Triangles\n{}", mesh.triangles.len()).unwrap();
    for [a, b, c] in &mesh.triangles {
        writeln!(text, "{} {} {} 1", a + 1, b + 1, c + 1).unwrap();
    }
    text + "End\n"
}

/// Reads the output of mmg2d, whose sections have a count and rows.
fn read_medit(path: &Path) -> Mesh {
    let text = fs::read_to_string(path).unwrap();
    let section = |name: &str, columns: usize| -> Vec<Vec<f64>> {
        let mut tokens = text.split_whitespace().skip_while(|token| *token != name).skip(1);
        let count = tokens.next().unwrap().parse::<usize>().unwrap() * columns;
        let numbers: Vec<f64> = tokens.take(count).map(|token| token.parse().unwrap()).collect();
        numbers.chunks(columns).map(<[f64]>::to_vec).collect()
    };
    let points = section("Vertices", 3).iter().map(|row| [row[0], row[1]]).collect();
    let triangles = section("Triangles", 4);
    let corner = |row: &Vec<f64>| [0, 1, 2].map(|i| row[i] as u32 - 1);
    Mesh { points, triangles: triangles.iter().map(corner).collect(), ..Mesh::default() }
}
