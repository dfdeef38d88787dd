//! The command `gpu-smooth MESH... --out-dir DIR`, which smooths many meshes.

use crate::commands::batch::{listing, table, workers};
use crate::error::{CliError, ErrorKind};
use crate::load::{LoadedMesh, destination};
use std::path::Path;
use std::time::Instant;

use gpu_smooth::Progress;
use mesh_io::{Conversion, atomic};

use crate::commands::batch::entry::{BatchStatus, Entry};
use crate::commands::batch::listing::BatchItem;
use crate::commands::batch::workers::Watch;
use crate::render::columns;
use crate::report::SmoothJob;
use crate::request::{Batch, Outputs, SmoothRequest, TableForm};
use crate::run::engine::Engines;
use crate::run::observer::PipelineObserver;
use crate::run::run_pipeline;
use crate::terminal::Verbosity;
use crate::terminal::interrupt;
use crate::terminal::progress::{Stage, Tally};
use crate::terminal::tell;

/// Verbosity of each run: silent, because other runs are active at the same time.
const SILENT: Verbosity = Verbosity { quiet: true, verbose: false };

/// Smooths all meshes of a batch. After the last mesh, returns an error if any mesh failed.
pub(crate) fn run(
    request: &SmoothRequest,
    batch: &Batch,
    verbosity: Verbosity,
) -> Result<(), CliError> {
    let start = Instant::now();
    let list = listing::list(batch.inputs.iter(), &batch.directory, request.form.to)?;
    let outputs = &request.outputs;
    outputs.check_names()?;
    for mesh in &list {
        outputs.check_files(&mesh.inputs, &mesh.outputs, ErrorKind::Usage)?;
    }
    outputs.check_disk()?;
    interrupt::watch(verbosity.quiet);
    // The first signal lets runs under way be canceled and finished ones be reported, instead of ending the
    // process.
    interrupt::has_result();
    make(&batch.directory)?;
    let is_done = |mesh: &BatchItem| batch.skips_done && mesh.is_done();
    let (skipped, open): (Vec<_>, Vec<_>) = (0..list.len()).partition(|&i| is_done(&list[i]));
    let mut statuses: Vec<Option<BatchStatus>> = list.iter().map(|_| None).collect();
    skipped.iter().for_each(|&i| statuses[i] = Some(BatchStatus::Skipped));
    if !open.is_empty() {
        let engines = Engines::new(request)?;
        let tally = Tally::new(verbosity, open.len());
        let mut watch = Watched { list: &list, verbosity, tally, statuses: &mut statuses };
        workers::run(&list, &open, &|mesh| smooth(request, &engines, mesh), &mut watch);
        watch.tally.clear();
    }
    let entry = |(mesh, status): (BatchItem, Option<BatchStatus>)| {
        let status = status.unwrap_or(BatchStatus::Interrupted);
        let BatchItem { input, out, inputs, .. } = mesh;
        Entry { input, out, files: inputs, status }
    };
    let entries: Vec<Entry> = list.into_iter().zip(statuses).map(entry).collect();
    let seconds = start.elapsed().as_secs_f64();
    let reported = write_report(outputs, &entries, seconds);
    match batch.table {
        TableForm::Json => tell::say_data(&table::json(&entries)?),
        TableForm::Csv => tell::say_data(&table::csv(&entries)),
        TableForm::Text if verbosity.quiet => {}
        TableForm::Text => {
            tell::say(&table::text(&entries, seconds, columns::of_terminal()));
        }
    }
    table::notes(&entries).iter().for_each(|note| tell::note(verbosity.quiet, note));
    let failures = table::failures(&entries);
    if reported.is_err() {
        failures.iter().for_each(tell::error);
    }
    reported?;
    match failures {
        Some(error) if interrupt::is_requested() => {
            tell::error(&error);
            Ok(())
        }
        Some(error) => Err(error),
        None => match entries.iter().filter(|entry| entry.status.fell_short()).count() {
            short if short > 0 && request.is_strict => Err(CliError::run(format!(
                "{short} of {} runs neither converged nor reached their goal; --strict makes this an error",
                entries.len()
            ))),
            _ => Ok(()),
        },
    }
}

/// Creates the output directory if necessary.
fn make(directory: &Path) -> Result<(), CliError> {
    std::fs::create_dir_all(directory).map_err(|error| {
        CliError::output(format!("{}: the directory cannot be made: {error}", directory.display()))
            .with_remedy("Give another one to --out-dir")
    })
}

/// Observer of a batch: shows the progress, and collects the results.
struct Watched<'a> {
    list: &'a [BatchItem],
    verbosity: Verbosity,
    tally: Tally,
    statuses: &'a mut [Option<BatchStatus>],
}

impl Watch for Watched<'_> {
    fn done(&mut self, mesh: usize, status: BatchStatus) {
        let problem = status.problem();
        self.tally.add(&self.list[mesh].input, problem.as_deref(), &status.text());
        self.statuses[mesh] = Some(status);
    }

    fn waits(&mut self) {
        self.tally.waits();
    }

    fn interrupted(&mut self) {
        let text =
            "interrupted: unfinished meshes are not written (interrupt again to end at once)";
        self.tally.aside(|| tell::note(self.verbosity.quiet, text));
    }
}

/// Smooths one mesh of the batch.
fn smooth(request: &SmoothRequest, engines: &Engines<'_>, mesh: &BatchItem) -> BatchStatus {
    let (input, out) = (&mesh.input, &mesh.out);
    let task = SmoothJob { request, verbosity: SILENT, input, out, resumed: None };
    let mut follow = Followed { mesh, request, remarks: Vec::new() };
    let engine = |size| Ok(engines.take(size));
    match run_pipeline(&task, engine, &mut follow, |done| Ok(done.report)) {
        Ok(report) => BatchStatus::Smoothed { report: Box::new(report), remarks: follow.remarks },
        Err(_) if interrupt::is_requested() => BatchStatus::Interrupted,
        Err(failure) => BatchStatus::Failed(failure),
    }
}

/// Observer of one mesh: collects remarks, and checks output files.
struct Followed<'a> {
    mesh: &'a BatchItem,
    request: &'a SmoothRequest,
    remarks: Vec<String>,
}

impl PipelineObserver for Followed<'_> {
    fn has_read(
        &mut self,
        file: &LoadedMesh,
        conversion: Option<&Conversion>,
    ) -> Result<(), CliError> {
        if interrupt::is_requested() {
            return Err(CliError::run("interrupted"));
        }
        // A file may have two names, which the check of the list could not detect.
        let remedy = "Give another directory to --out-dir, or replace the file by --force";
        destination::check(self.request, file, &self.mesh.out, conversion, remedy)
    }

    fn remark(&mut self, text: &str) {
        self.remarks.push(text.to_owned());
    }

    fn stage(&mut self, _: Stage) {}

    fn sweep(&mut self, _: &Progress) {}

    fn has_smoothed(&mut self) -> Result<(), CliError> {
        match interrupt::is_requested() {
            true => Err(CliError::run("interrupted")),
            false => Ok(()),
        }
    }
}

/// Writes the report on all meshes if requested.
fn write_report(outputs: &Outputs, entries: &[Entry], seconds: f64) -> Result<(), CliError> {
    let Some(path) = &outputs.report else { return Ok(()) };
    let text = table::report(entries, seconds)?;
    atomic::write(path, text.as_bytes()).map_err(|error| {
        CliError::from(error)
            .within("the report was not written")
            .followed_by("The meshes were written")
    })
}
