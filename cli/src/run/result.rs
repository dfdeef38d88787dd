//! Results of a run: measures, interpolated data and files.

use std::time::Instant;

use gpu_smooth::measure::{Change, Measured};
use gpu_smooth::{MeshError, Metric, Quality, Topology};
use mesh_io::PointField;

use crate::error::CliError;
use crate::load::{InterpolatedFields, depths, streams};
use crate::report::{
    Certificate, FileHash, ProfileChange, ProfileReport, Quantities, SpacingReport, TargetReport,
};
use crate::run::input::Input;
use crate::run::observer::PipelineObserver;
use crate::run::prepare::Ready;
use crate::run::proof::{self, MeshVersion, Proof};
use crate::run::spacing;
use crate::run::sweeps::FinishedRun;
use crate::terminal::progress::Stage;

/// Measures of a smoothed mesh.
pub(super) struct Measures {
    pub(super) after: Quality,
    pub(super) change: Change,
    pub(super) spacing: Vec<SpacingReport>,
    pub(super) target: Option<TargetReport>,
    /// The limits of the profile before and after; `None` without a profile.
    pub(super) profile: Option<ProfileChange>,
    /// A sentence on interpolated data; `None` without interpolation.
    pub(super) interpolated: Option<String>,
    /// Time at the end of the measurements.
    pub(super) at: Instant,
}

/// Result of writing a mesh.
pub(super) struct Written {
    /// Facts proved from the written files; `None` without a report or with output to a stream.
    pub(super) certificate: Option<Certificate>,
    /// Time at the end of writing.
    pub(super) at: Instant,
}

/// Measures a smoothed mesh, and interpolates vertex data at the new positions.
pub(super) fn measure(
    input: &Input<'_>,
    ready: &Ready<'_>,
    ran: &FinishedRun,
    fields: &mut InterpolatedFields,
    follow: &mut dyn PipelineObserver,
) -> Result<Measures, CliError> {
    let (request, file, outcome) = (input.request(), input.file, &ran.outcome);
    let (topology, old) = (ready.smoother.topology(), &file.mesh().points);
    let is_reported = request.outputs.report.is_some() || request.outputs.page.is_some();
    // The spacing takes one thread.
    let (measured, spacing) = rayon::join(
        || -> Result<_, MeshError> {
            let after = Quality::on(request.surface, &outcome.points, topology)?;
            Ok((after, Change::between(topology, old, &outcome.points)?))
        },
        || spacing::at_walls(file, topology, &outcome.points, is_reported),
    );
    let ((after, change), spacing) = (measured?, spacing?);
    let base = request.scheme().base();
    let start = ready.mended.map_or(file.mesh(), |mended| &mended.mesh);
    // Both in double precision, unlike the history of a run on a GPU.
    let f = || {
        let of = |points| ready.smoother.f(base, points);
        Ok([of(&start.points)?, of(&outcome.points)?])
    };
    let target = request.target.report(request.surface, ready.size_weight, f)?;
    let interpolated = fields.interpolate(file, topology, &outcome.points)?;
    let left_over = fields.add_dependents(file, &outcome.points)?;
    let has_moved = outcome.points != *old;
    let omission_remark = has_moved.then(|| fields.omission_remark(file)).flatten();
    let left_over = left_over.iter().filter(|_| has_moved);
    for note in interpolated.iter().chain(&omission_remark).chain(left_over) {
        follow.remark(note);
    }
    let profile = profile(input, topology, &outcome.points, fields.fields())?;
    Ok(Measures { after, change, spacing, target, profile, interpolated, at: Instant::now() })
}

/// Compares a mesh with the limits of its profile before and after a run, with the vertices at `points` and the data of
/// vertices in `fields` after the run.
fn profile(
    input: &Input<'_>,
    topology: &Topology<'_>,
    points: &[[f64; 2]],
    fields: &[PointField],
) -> Result<Option<ProfileChange>, CliError> {
    let (request, file) = (input.request(), input.file);
    let Some(profile) = &request.profile else { return Ok(None) };
    let report = |points: &[[f64; 2]], fields: &[PointField]| -> Result<ProfileReport, CliError> {
        let measured = Measured::on(request.surface, points, topology)?;
        let depths = if profile.needs_depths() { depths(file, fields)? } else { None };
        Ok(ProfileReport::new(profile, &Quantities::new(file, &measured, depths)))
    };
    let (before, after) = (report(&file.mesh().points, &[])?, report(points, fields)?);
    let base = request.scheme().base();
    let is_by_acute = matches!(base, Metric::Acute | Metric::AcuteSize);
    Ok(Some(ProfileChange { before, after, is_by_acute }))
}

/// Writes a smoothed mesh, and proves the statements of the report from the files. Removes the checkpoint unless the
/// run was canceled.
pub(super) fn write(
    input: &Input<'_>,
    ready: &Ready<'_>,
    ran: &FinishedRun,
    fields: &InterpolatedFields,
    follow: &mut dyn PipelineObserver,
) -> Result<Written, CliError> {
    let (request, file, out) = (input.request(), input.file, input.task.out);
    follow.stage(Stage::Writing { bytes: input.bytes });
    // Hashing precedes writing, which may replace the input files.
    let hashes = if request.outputs.report.is_some() { proof::hashes(file) } else { Vec::new() };
    input.write(&ran.outcome.points, fields)?;
    let certificate = match request.outputs.report.is_some() && !streams::is_standard(out) {
        true => Some(certificate(input, ready, fields, hashes)?),
        false => None,
    };
    if let Some(checkpoint) = &request.outputs.checkpoint {
        checkpoint.clear(ran.outcome.stop);
    }
    Ok(Written { certificate, at: Instant::now() })
}

/// Reads the written mesh again, and proves from the files alone that only movable vertices have moved.
fn certificate(
    input: &Input<'_>,
    ready: &Ready<'_>,
    fields: &InterpolatedFields,
    hashes: Vec<FileHash>,
) -> Result<Certificate, CliError> {
    let (request, file, out) = (input.request(), input.file, input.task.out);
    // Cell data may have other names in another format.
    let mut reading = request.reading.clone();
    reading.regions = reading.regions.filter(|_| input.form.is_none());
    let mut after = streams::read(out, &reading)?;
    file.lay_out_likewise(&mut after)?;
    let after = after;
    let slide = request.slide.as_ref().map(|slide| slide.slide(file)).transpose()?;
    let proof = match input.form {
        Some(_) => Proof::of_conversion(file, &after, slide.as_ref())?,
        None => {
            let mut theirs = request.fields.choose(&after)?;
            theirs.add_dependents(&after, &after.mesh().points)?;
            let after = MeshVersion { file: &after, fields: &theirs };
            Proof::of(MeshVersion { file, fields }, after, slide.as_ref())?
        }
    };
    if let Some(problem) = proof.problem() {
        let text = format!(
            "{}: the written mesh was read again, and it is wrong, by a fault of gpu-smooth: {problem}",
            out.display()
        );
        let mut list = proof.places(&after);
        list.push("Please report the fault with the mesh and the command line".into());
        return Err(CliError::run(text).with_details(list));
    }
    let surface = request.surface;
    let quality = Quality::on(surface, &after.mesh().points, ready.smoother.topology())?;
    let f = quality.f(request.scheme().base());
    Ok(Certificate {
        connectivity_identical: proof.difference.is_none(),
        moved: proof.moved.len(),
        fixed_moved: proof.held.len(),
        inverted: proof.bad.len(),
        f,
        input: hashes,
        output: proof::hashes(&after),
    })
}
