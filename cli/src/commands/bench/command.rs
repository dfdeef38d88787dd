//! The command `gpu-smooth bench`, which measures the speed of sweeps on this machine.

use std::path::Path;

use gpu_smooth::{
    Mesh, Method, Options, SmoothError, Stopping,
    gpu::Kernel,
    internal::{Plan, Problem, Stepwise, prepare, run_on_cpu, run_on_gpu},
};

use crate::args::BenchArgs;
use crate::commands::bench::baseline::Baseline;
use crate::commands::bench::machine::Place;
use crate::commands::bench::report::{Form, KernelRow, Row};
use crate::commands::bench::{kernels, lattice, machine, rates, runs, sweeps};
use crate::error::CliError;
use crate::load::streams::read;
use crate::load::{LoadedMesh, explain, lay_out};
use crate::request::{ReadRequest, ThirdCoordinate};
use crate::run::engine;
use crate::terminal::tell;

/// Converts an error of the library to the user's terms.
type Explain<'a> = dyn Fn(SmoothError) -> CliError + 'a;

pub(crate) fn run(args: &BenchArgs, quiet: bool) -> Result<(), CliError> {
    let file = args.mesh.as_deref().map(|mesh| laid_out(mesh, args, quiet)).transpose()?;
    if args.runs {
        return runs::run(args, file.as_ref(), quiet);
    }
    let baseline = args.baseline.as_deref().map(Baseline::read).transpose()?;
    let places = places(args, quiet)?;
    let form = Form::new(args);
    let mut rows = Vec::new();
    if !args.json {
        tell::say(&form.head(args, &places));
    }
    let mut measured = |mut row: Row| {
        row.baseline_seconds_per_sweep =
            baseline.as_ref().and_then(|baseline| baseline.seconds(&row));
        if !args.json {
            tell::say(&form.row(&row));
        }
        rows.push(row);
    };
    if let Some(file) = &file {
        let explain = |error| match error {
            SmoothError::Mesh(error) => explain::mesh_error(file, &error),
            error => error.into(),
        };
        measure_all(args, file.mesh(), &places, &explain, &mut measured)?;
    } else {
        for &vertices in &args.vertices {
            let mesh = lattice::lattice(vertices);
            measure_all(args, &mesh, &places, &CliError::from, &mut measured)?;
        }
    }
    if args.json {
        tell::say_data(&serde_json::to_string_pretty(&rows)?);
    } else {
        tell::say(&form.kernels(&rows));
    }
    Ok(())
}

/// Reads a mesh, and lays the mesh out in its plane or on the sphere, as a run does.
fn laid_out(path: &Path, args: &BenchArgs, quiet: bool) -> Result<LoadedMesh, CliError> {
    let mut file = read(path, &ReadRequest::from(&args.reading).taking_quadrilaterals())?;
    let z = ThirdCoordinate::of(args.options.settings(), &[]);
    for remark in lay_out(&mut file, args.options.settings().surface, z)? {
        tell::note(args.json || quiet, &remark);
    }
    Ok(file)
}

fn measure_all(
    args: &BenchArgs,
    mesh: &Mesh,
    places: &[Place],
    explain: &Explain<'_>,
    measured: &mut dyn FnMut(Row),
) -> Result<(), CliError> {
    let (_, problem) = prepare(mesh).map_err(|error| explain(error.into()))?;
    if problem.free_count() == 0 {
        return Err(CliError::input("the mesh has no free vertex: there is nothing to measure"));
    }
    let mut count = 0;
    for place in places {
        match measure(args, mesh, &problem, place) {
            Ok(row) => {
                count += 1;
                measured(row);
            }
            // The failure of one adapter does not stop the measurements on others.
            Err(SmoothError::Gpu(error)) if places.len() > 1 || count > 0 => {
                tell::note(false, &format!("{}: {error}", place.name));
            }
            Err(error) => return Err(explain(error)),
        }
    }
    Ok(())
}

fn measure(
    args: &BenchArgs,
    mesh: &Mesh,
    problem: &Problem,
    place: &Place,
) -> Result<Row, SmoothError> {
    let options = Options::default()
        .scheme(args.scheme())
        .stopping(Stopping::Tolerance(0.0))
        .max_sweeps(u32::MAX);
    let plan = Plan::new(&options);
    let (seconds, kernels, corrected, step) = match &place.gpu {
        None => {
            let mut engine = run_on_cpu(problem, problem.positions(), plan);
            (sweeps::time(&mut engine, args.seconds)?, None, None, None)
        }
        Some(gpu) => {
            let mut engine: Box<dyn Stepwise> =
                Box::new(run_on_gpu(gpu, problem, problem.positions(), plan)?);
            let seconds = sweeps::time(&mut *engine, args.seconds)?;
            drop(engine);
            let corrected = options.clone().method(Method::Multilevel);
            let corrected = match kernels::time(gpu, mesh, &corrected) {
                // No frame corrects sweeps by EDGE or by alternating metrics.
                Err(SmoothError::Option(_)) => None,
                timed => timed?,
            };
            let step = kernels::time_step(gpu, problem, Plan::new(&options))?;
            (seconds, kernels::time(gpu, mesh, &options)?, corrected, step)
        }
    };
    let (sweep, objective) = (sweeps::sweep_bytes(problem), sweeps::objective_bytes(problem));
    let kernel_row = |known: kernels::KernelTime| {
        let bytes = match known.kernel {
            Kernel::Sweep(..) => Some(sweep),
            Kernel::Objective(..) => Some(objective),
            _ => None,
        };
        KernelRow::new(&known, bytes, place.copy_rate)
    };
    Ok(Row {
        version: machine::version(),
        machine: machine::machine(),
        engine: place.name.clone(),
        software: place.gpu.as_ref().is_some_and(|gpu| gpu.adapter().is_software()),
        scheme: args.scheme().to_string(),
        vertices: mesh.points.len(),
        triangles: mesh.triangles.len(),
        free: problem.free_count(),
        colors: problem.colors().len(),
        seconds_per_sweep: seconds,
        baseline_seconds_per_sweep: None,
        vertex_updates_per_second: problem.free_count() as f64 / seconds,
        bytes_per_second: (sweep + objective) as f64 / seconds,
        share_of_copy_rate: (sweep + objective) as f64 / seconds / place.copy_rate,
        kernels: kernels.map(|kernels| kernels.into_iter().map(kernel_row).collect()),
        corrected_kernels: corrected.map(|kernels| kernels.into_iter().map(kernel_row).collect()),
        step_kernels: step.map(|kernels| kernels.into_iter().map(kernel_row).collect()),
    })
}

/// Opens the engines to measure: those selected by options, by default the CPU and the best
/// adapter.
fn places(args: &BenchArgs, quiet: bool) -> Result<Vec<Place>, CliError> {
    let mut places = Vec::new();
    if args.has_cpu() {
        let threads = rayon::current_num_threads();
        let name = format!("cpu, {threads} threads");
        places.push(Place { gpu: None, name, copy_rate: rates::on_cpu(args.seconds) });
    }
    if args.has_gpu() {
        match engine::open_adapter(args.adapter()) {
            Ok(gpu) => places.push(Place {
                name: gpu.adapter().name.clone(),
                copy_rate: rates::on_gpu(&gpu, args.seconds),
                gpu: Some(gpu),
            }),
            Err(error) if places.is_empty() => return Err(error),
            Err(error) => tell::note(args.json || quiet, &error.to_string()),
        }
    }
    Ok(places)
}
