//! Measures how fast mesh files are read, in megabytes per second, and the memory this takes, as a multiple of their size.
//!
//! ```text
//! cargo bench -p mesh-io --bench reading -- MESH...
//! ```
//!
//! A process of its own reads each file five times. There are two times, the least of five each:
//!
//! - by the clock;
//! - what two idle cores would need: the processor time of the main thread, or half of that of all threads if that is more.
//!
//! Memory is the most that the process used in the first reading. Both are known on Linux only.

#![allow(clippy::print_stdout)]

use mesh_io::ReadOptions;
use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

/// The environment variable that tells a child process which file to read.
const CHILD: &str = "GPU_SMOOTH_READING";
const RUNS: usize = 5;

fn main() {
    if let Some(path) = env::var_os(CHILD) {
        return measure(Path::new(&path));
    }
    let meshes: Vec<PathBuf> =
        env::args_os().skip(1).filter(|name| name != "--bench").map(PathBuf::from).collect();
    if meshes.is_empty() {
        println!("Name mesh files: cargo bench -p mesh-io --bench reading -- MESH...");
        return;
    }
    let program = env::current_exe().expect("this program has a name");
    println!(
        "| file | MB | MB/s by the clock | MB/s by processor time | memory / size |\n|---|---|---|---|---|"
    );
    for mesh in meshes {
        let done = Command::new(&program).env(CHILD, &mesh).status();
        if !done.is_ok_and(|status| status.success()) {
            println!("| {} | not read |", mesh.display());
        }
    }
}

/// Reads a file and prints its row.
fn measure(path: &Path) {
    let (mut clock, mut processor) = (f64::MAX, f64::MAX);
    let mut sizes = 0;
    let mut most = None;
    for _ in 0..RUNS {
        let (start, before) = (Instant::now(), times());
        let file =
            ReadOptions::new().weld(true).read(path).unwrap_or_else(|error| panic!("{error}"));
        clock = clock.min(start.elapsed().as_secs_f64());
        let [all, main] = [0, 1].map(|of| times()[of] - before[of]);
        processor = processor.min(main.max(all / 2.0));
        sizes = file.paths().filter_map(|path| fs::metadata(path).ok()).map(|m| m.len()).sum();
        // Only the first reading counts: later ones may find memory in pieces.
        most = most.or_else(peak);
    }
    let size = sizes as f64;
    let memory = most.map_or("–".into(), |most| format!("{:.1}", most as f64 / size));
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let speed = |seconds: f64| size / 1e6 / seconds;
    println!(
        "| {name} | {:.0} | {:.0} | {:.0} | {memory} |",
        size / 1e6,
        speed(clock),
        speed(processor)
    );
}

/// Processor time in seconds: of all threads of this process, and of this thread. Zero where the system does not tell.
fn times() -> [f64; 2] {
    ["/proc/self/stat", "/proc/thread-self/stat"].map(|path| {
        let stat = fs::read_to_string(path).unwrap_or_default();
        let fields: Vec<&str> = stat.rsplit(')').next().unwrap_or("").split_whitespace().collect();
        let ticks =
            |field: usize| fields.get(field).and_then(|f| f.parse::<f64>().ok()).unwrap_or(0.0);
        (ticks(11) + ticks(12)) / 100.0
    })
}

/// The most memory that this process has used, in bytes.
fn peak() -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()? * 1024)
}
