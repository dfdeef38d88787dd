//! The way of a mesh from file to file, in a run by itself or as one of many.

use std::path::Path;
use std::time::Instant;

use gpu_smooth::{MeshSize, targets::Surface};

use crate::error::CliError;
use crate::load::remarks;
use crate::load::streams;
use crate::load::{Choice, LoadedMesh, Riding, lay_out};
use crate::report::{Done, Failure, Task};
use crate::run::engine::Taken;
use crate::run::input::Input;
use crate::run::observer::Follow;
use crate::run::prepare::{Prepared, Subject, open, set_up};
use crate::run::result::{measure, write};
use crate::run::run_report;
use crate::run::sweeps::smooth;
use crate::terminal::progress::Stage;

/// A mesh that was read, with what its options chose in it.
struct ReadMesh {
    file: LoadedMesh,
    choice: Choice,
    riding: Riding,
    /// The size of the input file, or 0 if the input is no file.
    bytes: u64,
    /// The time at which reading ended.
    at: Instant,
}

/// Reads a mesh, smooths it on the engine that `engine` returns for its size, and writes it. Then calls `finish`.
pub(crate) fn carry_out<T>(
    task: &Task<'_>,
    engine: impl FnOnce(MeshSize) -> Result<Taken, CliError> + Send,
    follow: &mut dyn Follow,
    finish: impl FnOnce(Done<'_>) -> Result<T, CliError>,
) -> Result<T, Failure> {
    let began = Instant::now();
    let ReadMesh { file, choice, mut riding, bytes, at } = read(task, follow)?;
    let input = Input { task, file: &file, choice: &choice, bytes, began };
    let opened = open(&input, &riding, engine, follow);
    let mended;
    let subject = match opened.prepared? {
        Prepared::Ready(smoother) => Subject { smoother: *smoother, mended: None },
        Prepared::Mended(found) => {
            mended = found;
            Subject::of_mended(&file, &mended)?
        }
    };
    let ready = set_up(&input, subject, opened.taken?, follow)?;
    let ran = smooth(&input, &ready, follow)?;
    follow.has_smoothed()?;
    let measured = measure(&input, &ready, &ran, &mut riding, follow)?;
    let written = write(&input, &ready, &ran, &riding, follow)?;
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

/// Reads a mesh and chooses what may move in it. Tells the remarks on the mesh.
fn read(task: &Task<'_>, follow: &mut dyn Follow) -> Result<ReadMesh, CliError> {
    let request = task.request;
    let bytes = size_of(task.input);
    follow.stage(Stage::Reading { bytes });
    let mut file = streams::read(task.input, request.reading)?;
    let laid_out = lay_out(&mut file, request.surface)?;
    let choice = request.movable.apply(&mut file)?;
    let riding = request.fields.choose(&file)?;
    let at = Instant::now();
    follow.has_read(&file)?;
    let degrees = (request.surface == Surface::Plane).then(|| remarks::degrees(&file)).flatten();
    let remarks = remarks::remarks(&file, request.slide.is_some());
    for remark in remarks.iter().chain(&laid_out).chain(&choice.notes).chain(&degrees) {
        follow.remark(remark);
    }
    Ok(ReadMesh { file, choice, riding, bytes, at })
}

/// Returns the size of a file, or 0 if there is no such file.
fn size_of(path: &Path) -> u64 {
    std::fs::metadata(path).map_or(0, |found| found.len())
}
