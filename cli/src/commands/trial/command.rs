//! The command `gpu-smooth try MESH`, which compares runs with several targets.

use crate::args::TryArgs;
use crate::commands::trial::best::{self, Best};
use crate::commands::trial::table;
use crate::commands::trial::tried::Tried;
use crate::error::CliError;
use crate::load::{LoadedMesh, streams};
use crate::report::{Report, SmoothJob};
use crate::request::TrialRun;
use crate::run::engine::Engines;
use crate::run::observer::PipelineObserver;
use crate::run::run_pipeline;
use crate::terminal::Verbosity;
use crate::terminal::progress::{Display, Stage};
use crate::terminal::{interrupt, tell};
use gpu_smooth::Progress;

/// Smooths the mesh with the options of each run, and prints a table of the results, or the reason why no vertex has to
/// move. Writes no mesh.
///
/// # Errors
/// Returns the error of the first run, as an error of the mesh occurs in all runs.
pub(crate) fn run(args: &TryArgs, verbosity: Verbosity) -> Result<(), CliError> {
    if streams::is_standard(&args.mesh) {
        return Err(CliError::usage(
            "each of the tried runs reads the mesh, and standard input can be read only once",
        )
        .with_remedy("Name a file"));
    }
    if let Some(profile) = &args.profile {
        // The message on a damaged file is not that of a wrong command line.
        profile.read()?;
    }
    let runs = TrialRun::of_command_line(&args.mesh).unwrap_or_else(|error| error.exit());
    let Some(first) = runs.first() else { return Ok(()) };
    interrupt::watch(verbosity.quiet);
    let engines = Engines::new(&first.request)?;
    let mut tried = Vec::new();
    for (number, run) in (1..).zip(&runs) {
        tell::note(
            verbosity.quiet || !verbosity.verbose,
            &format!("run {number} of {}: {}", runs.len(), table::label(run)),
        );
        let mut follow = Shown::new(run, verbosity, number == 1);
        let result = smooth(args, run, &engines, &mut follow);
        follow.display.clear();
        match result {
            // An error of the mesh occurs in every run.
            Err(error) if number == 1 => return Err(error),
            Ok(Report { nothing_to_do: Some(reason), .. }) => {
                let mut json = table::json(args, &[], None);
                json["nothing_to_do"] = reason.as_str().into();
                match args.json {
                    true => tell::say_data(&format!("{json:#}")),
                    false => {
                        tell::say(&format!("{}: nothing to do: {reason}", args.mesh.display()))
                    }
                }
                return Ok(());
            }
            result => tried.push(Tried { run, result }),
        }
    }
    let gains: Vec<_> =
        tried.iter().map(|tried| tried.result.as_ref().ok().map(Into::into)).collect();
    let best: Option<Best> = best::best(&best::within_limits(&gains));
    if args.json {
        tell::say_data(&format!("{:#}", table::json(args, &tried, best)));
    } else {
        tell::say(&table::text(args, &tried, best));
    }
    Ok(())
}

fn smooth(
    args: &TryArgs,
    run: &TrialRun,
    engines: &Engines<'_>,
    follow: &mut Shown,
) -> Result<Report, CliError> {
    let quiet = Verbosity { quiet: true, verbose: false };
    let (request, input) = (&run.request, args.mesh.as_path());
    // A run of `try` does not write to `out`.
    let task = SmoothJob { request, verbosity: quiet, input, out: input, resumed: None };
    let engine = |size| Ok(engines.take(size));
    run_pipeline(&task, engine, follow, |done| Ok(done.report)).map_err(|failure| failure.error)
}

/// Observer that shows the progress of one run, and the remarks on the mesh in the first run.
struct Shown {
    display: Display,
    quiet: bool,
}

impl Shown {
    fn new(run: &TrialRun, verbosity: Verbosity, is_first: bool) -> Self {
        let request = &run.request;
        let display = Display::new(verbosity, request.estimated_end(), request.max_sweeps());
        Self { display, quiet: verbosity.quiet || !is_first }
    }
}

impl PipelineObserver for Shown {
    fn stage(&mut self, stage: Stage) {
        self.display.stage(stage);
    }

    fn has_read(
        &mut self,
        _: &LoadedMesh,
        _: Option<&mesh_io::Conversion>,
    ) -> Result<(), CliError> {
        Ok(())
    }

    fn remark(&mut self, text: &str) {
        self.display.aside(|| tell::note(self.quiet, text));
    }

    fn sweep(&mut self, progress: &Progress) {
        self.display.sweep(progress);
    }

    fn has_smoothed(&mut self) -> Result<(), CliError> {
        Ok(())
    }
}
