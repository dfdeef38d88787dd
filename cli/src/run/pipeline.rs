//! The pipeline of one mesh from input to output file, for single meshes and batches.

use std::path::Path;
use std::time::Instant;

use gpu_smooth::{MeshSize, targets::Surface};

use crate::error::CliError;
use crate::load::conversion::{self, NewForm};
use crate::load::remarks;
use crate::load::streams;
use crate::load::{InterpolatedFields, LoadedMesh, MovableSelection, lay_out};
use crate::report::{Done, Failure, SmoothJob};
use crate::request::RunExtent;
use crate::run::engine::OpenEngine;
use crate::run::input::Input;
use crate::run::observer::PipelineObserver;
use crate::run::prepare::{Prepared, Subject, open, set_up};
use crate::run::result::{Written, measure, write};
use crate::run::run_report;
use crate::run::sweeps::smooth;
use crate::terminal::progress::Stage;

/// A mesh after reading, with the selection of movable vertices and interpolated fields.
pub(super) struct ReadMesh {
    pub(super) file: LoadedMesh,
    pub(super) choice: MovableSelection,
    pub(super) fields: InterpolatedFields,
    /// The format to which the mesh is converted; `None` if its file is rewritten.
    pub(super) form: Option<NewForm>,
    /// Size of the input file in bytes; 0 if the input is not a file.
    pub(super) bytes: u64,
    /// Time at the end of reading.
    at: Instant,
}

/// Reads a mesh, smooths it on the engine that `engine` returns for the mesh's size, and writes the result. Then
/// calls `finish`.
pub(crate) fn run_pipeline<T>(
    task: &SmoothJob<'_>,
    engine: impl FnOnce(MeshSize) -> Result<OpenEngine, CliError> + Send,
    follow: &mut dyn PipelineObserver,
    finish: impl FnOnce(Done<'_>) -> Result<T, CliError>,
) -> Result<T, Failure> {
    let began = Instant::now();
    let ReadMesh { file, mut choice, mut fields, form, bytes, at } = read(task, follow)?;
    let topology = choice.topology.take();
    let input = Input { task, file: &file, choice: &choice, form, bytes, began };
    let opened = open(&input, topology, &fields, engine, follow);
    let mended;
    let subject = match opened.prepared? {
        Prepared::Ready(smoother) => Subject { smoother: *smoother, mended: None },
        Prepared::UntangledInput(found) => {
            mended = found;
            Subject::of_mended(&file, &mended)?
        }
    };
    let ready = set_up(&input, subject, opened.taken?, follow)?;
    let ran = smooth(&input, &ready, follow)?;
    follow.has_smoothed()?;
    let measured = measure(&input, &ready, &ran, &mut fields, follow)?;
    let written = match task.request.extent {
        RunExtent::Unwritten => Written { certificate: None, at: measured.at },
        RunExtent::Whole | RunExtent::Prepared => write(&input, &ready, &ran, &fields, follow)?,
    };
    let seconds = run_report::Clock {
        began,
        read: at,
        prepared: ready.at,
        smoothed: measured.at,
        written: written.at,
    };
    let report = run_report::report(&input, &ready, &ran, measured, written.certificate, &seconds);
    let done = Done {
        file: &file,
        smoother: &ready.smoother,
        outcome: &ran.outcome,
        times: ran.times,
        report,
    };
    Ok(finish(done)?)
}

/// Reads a mesh, and applies the options that select vertices and fields. Passes remarks on the mesh to the
/// observer.
pub(super) fn read(
    task: &SmoothJob<'_>,
    follow: &mut dyn PipelineObserver,
) -> Result<ReadMesh, CliError> {
    let request = task.request;
    let bytes = size_of(task.input);
    follow.stage(Stage::Reading { bytes });
    let mut file = streams::read(task.input, &request.reading)?;
    let laid_out = lay_out(&mut file, request.surface, request.z)?;
    let choice = request.movable.apply(&mut file, request.slide.as_ref())?;
    let fields = request.fields.choose(&file)?;
    let converted = request.form.of_run(&file, task.out)?;
    let at = Instant::now();
    follow.has_read(&file, converted.as_ref().map(|(_, conversion)| conversion))?;
    let degrees = (request.surface == Surface::Plane).then(|| remarks::degrees(&file)).flatten();
    let remarks = remarks::remarks(&file, request.slide.is_some());
    let notes = converted.as_ref().map(|(_, conversion)| conversion::notes(&file, conversion));
    let remarks = remarks.iter().chain(&laid_out).chain(&choice.notes).chain(&degrees);
    for remark in remarks.chain(notes.iter().flatten()) {
        follow.remark(remark);
    }
    let form = converted.map(|(form, _)| form);
    Ok(ReadMesh { file, choice, fields, form, bytes, at })
}

/// Returns the size of a file in bytes; 0 if the file does not exist.
fn size_of(path: &Path) -> u64 {
    std::fs::metadata(path).map_or(0, |found| found.len())
}
