//! Whole runs by phase: `gpu-smooth bench --runs`.

use std::time::{Duration, Instant};

use gpu_smooth::internal::{DeviceCounts, device_counts};
use gpu_smooth::{Backend, CheckpointPolicy, Mesh, Options, Outcome, SmoothError, Smoother};
use serde::Serialize;

use crate::args::BenchArgs;
use crate::commands::bench::{lattice, machine};
use crate::error::CliError;
use crate::load::{LoadedMesh, explain};
use crate::render::columns::right;
use crate::run::engine;
use crate::terminal::tell;

/// Largest number of runs after the first, of which the median counts.
const AGAIN: usize = 15;

/// An engine whose runs are timed.
struct Place {
    name: String,
    /// Driver and kind of the adapter; empty for the CPU.
    driver: String,
    software: bool,
    backend: Backend,
    /// Time to open the device, with the trial of the driver in a child process.
    open: Duration,
}

/// A timed run.
#[derive(Serialize)]
struct Row {
    version: String,
    machine: String,
    engine: String,
    driver: String,
    software: bool,
    /// Seconds to open the device; zero for the CPU. An engine opens its device once, so all its rows have one value.
    open_seconds: f64,
    scheme: String,
    vertices: usize,
    triangles: usize,
    /// Whether this is the first run of an engine on the mesh. Otherwise the row is the median of `runs` later runs.
    first: bool,
    runs: usize,
    /// Seconds to prepare the mesh: windings, boundary, colors and layout.
    prepare_seconds: f64,
    /// Seconds from the start of a run to its result.
    smooth_seconds: f64,
    /// Seconds of a run in which the host builds levels, compiles kernels, and waits for the device. Compilation and
    /// levels may overlap with waits. The host takes the rest of `smooth_seconds` for other work.
    levels_seconds: f64,
    compiling_seconds: f64,
    waiting_seconds: f64,
    sweeps: u32,
    corrections: u32,
    newton_steps: u32,
    /// f by the first metric, before and after.
    f: [f64; 2],
    /// The work given to a device; zeros for the CPU.
    dispatches: u64,
    submissions: u64,
    waits: u64,
    kernels: u64,
    kernels_after_first_sweep: u64,
    uploaded_bytes: u64,
    read_back_bytes: u64,
    allocated_bytes: u64,
}

pub(super) fn run(
    args: &BenchArgs,
    file: Option<&LoadedMesh>,
    quiet: bool,
) -> Result<(), CliError> {
    let places = places(args, quiet)?;
    if !args.json {
        tell::say(&head(args, &places));
    }
    let mut rows = Vec::new();
    let mut measured = |row: Row| {
        if !args.json {
            tell::say(&line(args, fields(&row), &row.engine));
        }
        rows.push(row);
    };
    match file {
        Some(file) => {
            let explain = |error| match error {
                SmoothError::Mesh(error) => explain::mesh_error(file, &error),
                error => error.into(),
            };
            measure(args, file.mesh(), &places, &mut measured).map_err(explain)?;
        }
        None => {
            for &vertices in &args.vertices {
                measure(args, &lattice::lattice(vertices), &places, &mut measured)?;
            }
        }
    }
    if args.json {
        tell::say_data(&serde_json::to_string_pretty(&rows)?);
    }
    Ok(())
}

/// Opens the engines that options select, by default the CPU and the best adapter.
fn places(args: &BenchArgs, quiet: bool) -> Result<Vec<Place>, CliError> {
    let mut places = Vec::new();
    if args.has_cpu() {
        places.push(Place {
            name: format!("cpu, {} threads", rayon::current_num_threads()),
            driver: String::new(),
            software: false,
            backend: Backend::Cpu,
            open: Duration::ZERO,
        });
    }
    if args.has_gpu() {
        let began = Instant::now();
        match engine::open_adapter(args.adapter()) {
            Ok(gpu) => places.push(Place {
                name: gpu.adapter().name.clone(),
                driver: tell::adapter(gpu.adapter()),
                software: gpu.adapter().is_software(),
                backend: Backend::Gpu(gpu),
                open: began.elapsed(),
            }),
            Err(error) if places.is_empty() => return Err(error),
            Err(error) => tell::note(args.json || quiet, &error.to_string()),
        }
    }
    Ok(places)
}

fn measure(
    args: &BenchArgs,
    mesh: &Mesh,
    places: &[Place],
    measured: &mut dyn FnMut(Row),
) -> Result<(), SmoothError> {
    let began = Instant::now();
    let smoother = Smoother::new(mesh)?;
    let prepare = began.elapsed();
    let options = Options::default().scheme(args.scheme());
    for place in places {
        let row = |first, mut runs: Vec<Timed>| {
            runs.sort_by_key(|run| run.outcome.smooth);
            row(args, mesh, place, prepare, first, runs.len(), &runs[runs.len() / 2])
        };
        let began = Instant::now();
        let more = |count: usize| {
            count == 0 || count < AGAIN && began.elapsed().as_secs_f64() < args.seconds
        };
        match timed(&smoother, &options, place) {
            Ok(first) => measured(row(true, vec![first])),
            // The failure of one engine does not stop the measurements on others.
            Err(SmoothError::Gpu(error)) if places.len() > 1 => {
                tell::note(false, &format!("{}: {error}", place.name));
                continue;
            }
            Err(error) => return Err(error),
        }
        let mut again = Vec::new();
        while more(again.len()) {
            again.push(timed(&smoother, &options, place)?);
        }
        measured(row(false, again));
    }
    Ok(())
}

/// A run with the work that it gave to its device.
struct Timed {
    outcome: Outcome,
    work: Option<DeviceCounts>,
}

/// A policy that never saves positions, so that counts do not depend on the time of a run. The default policy saves them
/// each second, with a readback.
struct NeverSaved;

impl CheckpointPolicy for NeverSaved {
    fn interval(&self) -> Duration {
        Duration::MAX
    }
}

fn timed(smoother: &Smoother<'_>, options: &Options, place: &Place) -> Result<Timed, SmoothError> {
    let counts = || match &place.backend {
        Backend::Gpu(gpu) => Some(device_counts(gpu)),
        _ => None,
    };
    let before = counts();
    let run = smoother.run(options).on(&place.backend).checkpoints(NeverSaved);
    let outcome = run.block()?;
    let work = counts().zip(before).map(|(now, before)| now.since(&before));
    Ok(Timed { outcome, work })
}

fn row(
    args: &BenchArgs,
    mesh: &Mesh,
    place: &Place,
    prepare: Duration,
    first: bool,
    runs: usize,
    run: &Timed,
) -> Row {
    let base = args.scheme().base();
    let f = |k: usize| run.outcome.history.get(k).and_then(|f| f.of(base)).unwrap_or(f64::NAN);
    let count = |of: fn(&DeviceCounts) -> u64| run.work.as_ref().map_or(0, of);
    let seconds = |of: fn(&DeviceCounts) -> Duration| {
        run.work.as_ref().map_or(0.0, |work| of(work).as_secs_f64())
    };
    Row {
        version: machine::version(),
        machine: machine::machine(),
        engine: place.name.clone(),
        driver: place.driver.clone(),
        software: place.software,
        open_seconds: place.open.as_secs_f64(),
        scheme: args.scheme().to_string(),
        vertices: mesh.points.len(),
        triangles: mesh.triangles.len(),
        first,
        runs,
        prepare_seconds: prepare.as_secs_f64(),
        smooth_seconds: run.outcome.smooth.as_secs_f64(),
        levels_seconds: run.outcome.levels.as_secs_f64(),
        compiling_seconds: seconds(|work| work.compiling),
        waiting_seconds: seconds(|work| work.waiting),
        sweeps: run.outcome.sweeps,
        corrections: run.outcome.corrections,
        newton_steps: run.outcome.newton_steps,
        f: [f(0), f(run.outcome.history.len() - 1)],
        dispatches: count(|work| work.dispatches),
        submissions: count(|work| work.submissions),
        waits: count(|work| work.waits),
        kernels: count(|work| work.kernels),
        kernels_after_first_sweep: count(|work| work.late_kernels),
        uploaded_bytes: count(|work| work.uploaded),
        read_back_bytes: count(|work| work.read_back),
        allocated_bytes: count(|work| work.allocated),
    }
}

/// Columns of the table before the engine. Times are in milliseconds, bytes for each vertex.
const COLUMNS: [(&str, usize); 15] = [
    ("vertices", 9),
    ("run", 6),
    ("prepare", 9),
    ("smooth", 9),
    ("levels", 8),
    ("compile", 8),
    ("waiting", 9),
    ("sweeps", 6),
    ("dispatches", 10),
    ("submits", 7),
    ("waits", 5),
    ("late kernels", 12),
    ("bytes up", 8),
    ("back", 5),
    ("allocated", 9),
];

/// Returns the lines on version, machine and engines, and the head of the table.
fn head(args: &BenchArgs, places: &[Place]) -> String {
    let mark = if args.markdown { "- " } else { "" };
    let mut text = format!("{mark}{}\n{mark}{}\n", machine::version(), machine::machine());
    for Place { name, driver, open, .. } in places.iter().filter(|place| !place.driver.is_empty()) {
        let seconds = open.as_secs_f64();
        text += &format!(
            "{mark}{name} {driver}: opened in {seconds:.3} s, with the trial in a process if there was one\n"
        );
    }
    text += &format!(
        "\nWhole runs by {} to the default tolerance, in ms: the first on its engine and mesh, then the median of others. \
         Levels and waits are parts of smoothing; compilation is the sum over all threads; bytes are for each vertex\n\n",
        args.scheme()
    );
    text += &line(args, COLUMNS.map(|(name, _)| name.to_owned()), "engine");
    if args.markdown {
        text += &format!("\n|{}---|", "---:|".repeat(COLUMNS.len()));
    }
    text
}

fn fields(row: &Row) -> [String; COLUMNS.len()] {
    let ms = |seconds: f64| format!("{:.2}", 1e3 * seconds);
    let each = |bytes: u64| format!("{:.0}", bytes as f64 / row.vertices as f64);
    let run = if row.first { "first".to_owned() } else { format!("of {}", row.runs) };
    [
        row.vertices.to_string(),
        run,
        ms(row.prepare_seconds),
        ms(row.smooth_seconds),
        ms(row.levels_seconds),
        ms(row.compiling_seconds),
        ms(row.waiting_seconds),
        row.sweeps.to_string(),
        row.dispatches.to_string(),
        row.submissions.to_string(),
        row.waits.to_string(),
        row.kernels_after_first_sweep.to_string(),
        each(row.uploaded_bytes),
        each(row.read_back_bytes),
        each(row.allocated_bytes),
    ]
}

fn line(args: &BenchArgs, fields: [String; COLUMNS.len()], engine: &str) -> String {
    if args.markdown {
        return format!("| {} | {engine} |", fields.join(" | "));
    }
    let padded = fields.iter().zip(COLUMNS).map(|(field, (_, width))| right(field, width));
    format!("{}  {engine}", padded.collect::<Vec<_>>().join(" "))
}
