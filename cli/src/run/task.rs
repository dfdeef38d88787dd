//! Takes a mesh from file to file, in a run by itself or as one of many.

use crate::load::LoadedMesh;
use std::cell::RefCell;
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

use gpu_smooth::{
    Backend, Change, Checkpoint, MeshError, MeshSize, Options, Outcome, Phase, Precision, Progress,
    Quality, SmoothError, Smoother, Stop,
};

use crate::args::{History, SmoothArgs};
use crate::load::Choice;
use crate::load::Riding;
use crate::load::explain::{self, BadTriangleReport};
use crate::load::remarks;
use crate::load::streams;
use crate::report::{
    self, Certificate, Done, EngineReport, FaultReport, FileHash, GoalReport, MeshReport, Report,
    Seconds, Task, UntangleReport,
};
use crate::run::checkpoint::{self, Kept};
use crate::run::engine::{self, Taken};
use crate::run::observer::Follow;
use crate::run::proof::{self, Proof};
use crate::run::untangle;
use crate::terminal::interrupt;
use crate::terminal::progress::Stage;

/// Why a mesh was not smoothed.
pub(crate) struct Failure {
    pub(crate) message: String,
    /// All inverted and flat triangles in the order of the file, if they are the reason and a report was asked for;
    /// else empty.
    pub(crate) triangles: Vec<BadTriangleReport>,
}

impl From<String> for Failure {
    fn from(message: String) -> Self {
        Self { message, triangles: Vec::new() }
    }
}

fn told(error: impl std::error::Error) -> String {
    error.to_string()
}

/// Reads a mesh, smooths it on the engine that `engine` returns for its size, and writes it. Then calls `finish`.
pub(crate) fn carry_out<T>(
    task: &Task<'_>,
    engine: impl FnOnce(MeshSize) -> Result<Taken, String> + Send,
    follow: &mut dyn Follow,
    finish: impl FnOnce(Done<'_>) -> Result<T, String>,
) -> Result<T, Failure> {
    let Task { args, show, input, out, .. } = *task;
    let start = Instant::now();
    let bytes = std::fs::metadata(input).map_or(0, |found| found.len());
    follow.stage(Stage::Reading { bytes });
    let mut file = streams::read(input, args.reading)?;
    let laid_out = args.target.surface.lay_out(&mut file)?;
    let choice = args.moving.apply(&mut file)?;
    let mut riding = args.riding.choose(&file)?;
    let file = file;
    let read_done = Instant::now();
    follow.has_read(&file)?;
    let degrees = args.target.is_on_plane().then(|| remarks::degrees(&file)).flatten();
    let remarks = remarks::remarks(&file, args.sliding.slide);
    for remark in remarks.iter().chain(&laid_out).chain(&choice.notes).chain(&degrees) {
        follow.remark(remark);
    }
    let mesh = file.mesh();
    let size = MeshSize { vertices: mesh.points.len(), triangles: mesh.triangles.len() };
    follow.stage(Stage::Preparing { vertices: size.vertices });
    // The driver may start while the mesh is prepared.
    let (prepared, taken) = std::thread::scope(|scope| {
        let opening = scope.spawn(move || engine(size));
        let prepared = match smoother(args, &file) {
            prepared if args.untangle && untangle::can_mend(&prepared) => {
                drop(prepared);
                follow.stage(Stage::Untangling);
                riding
                    .check_untangled()
                    .and_then(|()| untangle::mend((args, show), start, &file, out))
                    .map(Prepared::Mended)
                    .map_err(Failure::from)
            }
            Err(error) => Err(refusal(args, &choice, &file, &error)),
            Ok(smoother) => Ok(Prepared::Ready(Box::new(smoother))),
        };
        let taken = opening.join().map_err(|_| "the graphics driver crashed on start".to_owned());
        (prepared, taken)
    });
    let mended;
    let (mut smoother, mending) = match prepared? {
        Prepared::Ready(smoother) => (*smoother, None),
        Prepared::Mended(it) => {
            mended = it;
            let smoother = Smoother::new(&mended.mesh);
            let smoother = smoother.map_err(|error| explain::mesh_error(&file, &error))?;
            (smoother, Some(&mended))
        }
    };
    let taken = match (taken??, smoother.topology().free_count()) {
        (_, 0) => {
            Taken::new(Backend::Cpu, Some("no vertex is free, and sliding is on the CPU".into()))
        }
        (taken, _) => taken,
    };
    let points = mending.map_or(&mesh.points, |mended| &mended.mesh.points);
    if let Some(remark) = mending.and_then(|mended| mended.remark.as_ref()) {
        follow.remark(remark);
    }
    let hanging = smoother.topology().hanging_nodes(&mesh.points).map_err(told)?;
    if let Some(remark) = explain::hanging(&file, &hanging) {
        follow.remark(&remark);
    }
    if let Some(remark) = args.target.set(&file, &mut smoother, points)? {
        follow.remark(&remark);
    }
    if let Some(remark) = args.sliding.set(&file, &mut smoother)? {
        follow.remark(&remark);
    }
    let smoother = smoother;
    let quality = |points: &[[f64; 2]]| {
        Quality::on(args.target.surface(), points, smoother.topology()).map_err(told)
    };
    let before = quality(&mesh.points)?;
    let prepared = Instant::now();

    let options = options(args, &choice, file.precision());
    follow.stage(Stage::Smoothing);
    let prepared_run = (&smoother, &file, taken);
    let ran = smooth(task, &options, prepared_run, start, follow)?;
    let Ran { outcome, taken, times, out_of_time } = ran;
    follow.has_smoothed()?;
    let after = quality(&outcome.points)?;
    let change =
        Change::between(smoother.topology(), &mesh.points, &outcome.points).map_err(told)?;
    let base = args.scheme().base();
    let f_before = outcome.history.first().and_then(|first| first.of(base)).unwrap_or(f64::NAN);
    let f_after = || smoother.f(base, &outcome.points).map_err(told);
    let target = args.target.report(f_before, f_after)?;
    let interpolated = riding.carry(&file, smoother.topology(), &outcome.points)?;
    let left_over = riding.add_dependents(&file, &outcome.points)?;
    let has_moved = outcome.points != mesh.points;
    let left_behind = has_moved.then(|| riding.left_behind(&file)).flatten();
    let left_over = left_over.iter().filter(|_| has_moved);
    for note in interpolated.iter().chain(&left_behind).chain(left_over) {
        follow.remark(note);
    }
    let smoothed = Instant::now();

    follow.stage(Stage::Writing { bytes });
    let input = if args.report.is_some() { proof::hashes(&file) } else { Vec::new() };
    streams::write(&file, out, &outcome.points, riding.fields())?;
    let certificate = match args.report.is_some() && !streams::is_standard(out) {
        true => Some(certificate(args, &file, &riding, input, (out, &smoother))?),
        false => None,
    };
    checkpoint::clear(args, outcome.stop);
    let written = Instant::now();

    let seconds = Seconds {
        read: (read_done - start).as_secs_f64(),
        prepare: (prepared - read_done).as_secs_f64(),
        smooth: (smoothed - prepared).as_secs_f64(),
        write: (written - smoothed).as_secs_f64(),
        total: (written - start).as_secs_f64(),
    };
    let report = Report {
        engine: engine_report(&taken, &outcome),
        mesh: mesh_report(&file, &smoother),
        target,
        untangled: mending.map(|mended| UntangleReport {
            bad_before: mended.bad_before,
            sweeps: mended.sweeps,
            moved: mended.moved,
        }),
        scheme: args.scheme().to_string(),
        sweeps: outcome.sweeps,
        corrections: outcome.corrections,
        opening_sweeps: outcome.opening_sweeps,
        levels_left_out: outcome.levels_left_out,
        best_sweep: outcome.best_sweep,
        remaining: outcome.remaining,
        stop: match choice.nothing_to_do {
            Some(_) => "nothing-to-do",
            None if out_of_time => "time-limit",
            None => outcome.stop.name(),
        },
        continued_from: task.resumed.map(Checkpoint::sweeps),
        nothing_to_do: choice.nothing_to_do,
        choices: choice.notes,
        interpolated,
        held_back: outcome.held_back,
        lost: outcome.lost,
        goal: goal_report(&outcome),
        returned: outcome.returned,
        slid: outcome.slid.map(Into::into),
        improved: outcome.improved.map(Into::into),
        max_move: args.max_move,
        change: change.into(),
        before: (&before).into(),
        after: (&after).into(),
        certificate,
        history: report::history(&outcome, &args.scheme(), args.history == History::All),
        seconds,
    };
    let done = Done { file: &file, smoother: &smoother, outcome: &outcome, times, report };
    Ok(finish(done)?)
}

/// Prepares a mesh to be smoothed. If vertices slide, none needs to be free.
fn smoother<'f>(args: &SmoothArgs, file: &'f LoadedMesh) -> Result<Smoother<'f>, MeshError> {
    let slides = |error| match args.sliding.slide(file) {
        Ok(Some(slide)) => Smoother::with_slide(file.mesh(), &slide).map_err(|_| error),
        _ => Err(error),
    };
    match Smoother::new(file.mesh()) {
        Err(error @ MeshError::NothingFree { .. }) => slides(error),
        made => made,
    }
}

/// Reads the written mesh again, and proves from the files alone that only vertices which may move have moved.
fn certificate(
    args: &SmoothArgs,
    file: &LoadedMesh,
    riding: &Riding,
    input: Vec<FileHash>,
    (out, smoother): (&Path, &Smoother<'_>),
) -> Result<Certificate, String> {
    let mut after = streams::read(out, args.reading)?;
    file.lay_out_likewise(&mut after);
    let after = after;
    let mut theirs = args.riding.choose(&after)?;
    theirs.add_dependents(&after, &after.mesh().points)?;
    let proof = Proof::of([file, &after], [riding, &theirs], args.sliding.slide(file)?.as_ref());
    let proof = proof.map_err(told)?;
    if let Some(problem) = proof.problem() {
        return Err(format!(
            "{}: the written mesh was read again, and it is wrong: {problem}",
            out.display()
        ));
    }
    let surface = args.target.surface();
    let quality = Quality::on(surface, &after.mesh().points, smoother.topology()).map_err(told)?;
    let f = quality.f(args.scheme().base());
    Ok(Certificate {
        connectivity_identical: proof.difference.is_none(),
        moved: proof.moved.len(),
        fixed_moved: proof.held.len(),
        inverted: proof.bad.len(),
        f,
        input,
        output: proof::hashes(&after),
    })
}

/// A mesh that can be smoothed: as it was read, or after it was untangled.
enum Prepared<'a> {
    Ready(Box<Smoother<'a>>),
    Mended(untangle::Mended),
}

/// Returns the options of the run. If there is nothing to do, the run has no sweeps.
fn options(args: &SmoothArgs, choice: &Choice, stored: Precision) -> Options {
    let options = args.options(stored);
    match choice.nothing_to_do {
        Some(_) => Options { max_sweeps: 0, goal: None, improve_worst: None, ..options },
        None => options,
    }
}

/// A finished run, its engine, and the times in seconds after which sweeps were done.
struct Ran {
    outcome: Outcome,
    taken: Taken,
    times: Vec<(u32, f64)>,
    /// Whether the time limit ended the run.
    out_of_time: bool,
}

/// Smooths. Falls back to the CPU if the GPU cannot hold the mesh and the user left the choice of engine open, or if
/// the GPU fails. The time limit counts from `began`.
fn smooth(
    task: &Task<'_>,
    options: &Options,
    (smoother, file, mut taken): (&Smoother<'_>, &LoadedMesh, Taken),
    began: Instant,
    follow: &mut dyn Follow,
) -> Result<Ran, String> {
    let Task { args, resumed, .. } = *task;
    let start = Instant::now();
    let mut times = Vec::new();
    let mut out_of_time = false;
    let follow = RefCell::new(follow);
    let mut kept = Kept::new(args, &follow);
    let mut observe = |progress: &Progress| {
        if progress.phase == Phase::Smoothing {
            times.push((progress.sweep, start.elapsed().as_secs_f64()));
        }
        follow.borrow_mut().sweep(progress);
        out_of_time = args.time_limit.is_some_and(|limit| began.elapsed() >= limit);
        match interrupt::is_requested() || out_of_time {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    };
    let turn = taken.turn();
    let run = |backend: &Backend,
               kept: &mut Kept<'_, '_>,
               observe: &mut dyn FnMut(&Progress) -> ControlFlow<()>| {
        smoother.run_kept(options, backend, resumed, kept, observe)
    };
    let mut outcome = run(&taken.backend, &mut kept, &mut observe);
    drop(turn);
    if let Err(error) = &outcome
        && engine::is_open(args)
        && engine::is_too_large(error)
    {
        taken = Taken::new(Backend::Cpu, Some(error.to_string()));
        outcome = run(&taken.backend, &mut kept, &mut observe);
    }
    if let Ok(outcome) = &outcome {
        times.retain(|time| time.0 < outcome.sweeps);
        times.push((outcome.sweeps, start.elapsed().as_secs_f64()));
        if outcome.stop == Stop::Canceled {
            kept.left();
        }
    }
    let ran = outcome.map(|outcome| {
        let out_of_time =
            out_of_time && outcome.stop == Stop::Canceled && !interrupt::is_requested();
        Ran { outcome, taken, times, out_of_time }
    });
    ran.map_err(|error: SmoothError| match &error {
        SmoothError::Mesh(error) => explain::mesh_error(file, error),
        SmoothError::Checkpoint(_) => {
            let path = args.continued.as_deref().unwrap_or(Path::new(""));
            format!("{}: {error}", path.display())
        }
        error if engine::is_too_large(error) => {
            format!("{error}. Smooth on the CPU: --engine cpu")
        }
        error => error.to_string(),
    })
}

/// Words why a mesh is not smoothed, with its inverted and flat triangles if a report was asked for.
fn refusal(args: &SmoothArgs, choice: &Choice, file: &LoadedMesh, error: &MeshError) -> Failure {
    if let Some(message) = choice.nothing_free(file, error) {
        return message.into();
    }
    let message = match error {
        MeshError::NothingFree { .. }
            if args.sliding.slide && file.interface_vertices().is_empty() =>
        {
            let (path, error) = (file.source.path().display(), explain::nothing_free(file));
            format!(
                "{path}: {error}, and none can slide, as all are corners or held. Refine the mesh, so that it has vertices between"
            )
        }
        _ => explain::mesh_error(file, error),
    };
    let triangles = match error {
        MeshError::Infeasible { triangles } if args.report.is_some() => {
            explain::bad_triangles(file, triangles)
        }
        _ => Vec::new(),
    };
    Failure { message, triangles }
}

fn engine_report(taken: &Taken, outcome: &Outcome) -> EngineReport {
    let adapter = match &*taken.backend {
        Backend::Cpu => None,
        Backend::Gpu(gpu) => Some(gpu.adapter()),
    };
    EngineReport {
        kind: if adapter.is_some() { "gpu" } else { "cpu" },
        adapter: adapter.map(|adapter| adapter.name.clone()),
        driver: adapter.map(|adapter| adapter.driver.clone()),
        reason: taken.reason.clone(),
        fault: outcome
            .device_fault
            .as_ref()
            .map(|fault| FaultReport { sweep: fault.sweep, error: fault.error.to_string() }),
    }
}

fn mesh_report(file: &LoadedMesh, smoother: &Smoother<'_>) -> MeshReport {
    MeshReport {
        format: file.source.format().to_string(),
        vertices: file.source.points().len(),
        triangles: file.mesh().triangles.len(),
        free: smoother.topology().free_count(),
        colors: smoother.colors(),
    }
}

fn goal_report(outcome: &Outcome) -> Option<GoalReport> {
    outcome.goal.as_ref().map(|goal| GoalReport {
        fraction: goal.fraction,
        desired: goal.desired,
        origin: goal.origin.clone(),
        reached: outcome.stop == Stop::Reached,
        best_fraction: goal.best_fraction,
    })
}
