//! Checks, before the work is done, that all files of a run can be written.

use crate::error::CliError;
use crate::load::LoadedMesh;
use std::path::{Path, PathBuf};

use mesh_io::atomic;

use crate::args::SmoothArgs;
use crate::load::streams::is_standard;
use crate::render::html;
use crate::render::picture;
use crate::run::checkpoint;

/// Returns the files that the smoothed mesh is written to; none for the standard output. Returns an error if they
/// cannot be written.
pub(crate) fn of_mesh(file: &LoadedMesh, out: &Path) -> Result<Vec<PathBuf>, CliError> {
    if !is_standard(out) {
        file.source.check_destination(out)?;
        return Ok(file.source.destinations(out)?);
    }
    match file.source.paths().count() {
        1 => Ok(Vec::new()),
        _ => Err(CliError::output(
            "the mesh has several files and cannot go to standard output: name OUT",
        )),
    }
}

/// Refuses files that cannot be written, or that would replace each other or the mesh.
pub(crate) fn check(args: &SmoothArgs, file: &LoadedMesh, out: &Path) -> Result<(), CliError> {
    let written = of_mesh(file, out)?;
    let of_meshes = || file.source.paths().chain(written.iter().map(PathBuf::as_path));
    let report = args.report.as_deref();
    picture::check(&args.picture, of_meshes().chain(report))?;
    let others = of_meshes().chain(report).chain(args.picture.picture.as_deref());
    html::check(args.html.as_deref(), others)?;
    check_report(args, of_meshes())?;
    let named = [report, args.picture.picture.as_deref(), args.html.as_deref()];
    checkpoint::check(args, of_meshes().chain(named.into_iter().flatten()))?;
    let is_own = |path: &PathBuf| file.source.paths().any(|own| atomic::same_file(own, path));
    match (checkpoint::file(args), written.iter().find(|path| is_own(path))) {
        (Some(_), Some(path)) => Err(CliError::output(format!(
            "{}: a run can only be continued while IN is as it was",
            path.display()
        ))
        .with_remedy("With a checkpoint, OUT must be another file")),
        _ => Ok(()),
    }
}

/// Refuses a report that cannot be written, or that has the name of a mesh or would replace one of these files.
pub(crate) fn check_report<'p>(
    args: &SmoothArgs,
    mut meshes: impl Iterator<Item = &'p Path>,
) -> Result<(), CliError> {
    let Some(report) = &args.report else { return Ok(()) };
    let is_mesh = ["node", "ele", "poly", "msh"]
        .iter()
        .any(|ending| report.extension().is_some_and(|found| found.eq_ignore_ascii_case(ending)));
    if is_mesh || meshes.any(|path| atomic::same_file(path, report)) {
        let name = report.display();
        return Err(CliError::output(format!("{name}: the report is JSON, not a mesh"))
            .with_remedy("End its name in .json"));
    }
    can_write_report(args)
}

/// Checks whether the report can be written, as this may have changed during a long run.
pub(crate) fn can_write_report(args: &SmoothArgs) -> Result<(), CliError> {
    let Some(report) = &args.report else { return Ok(()) };
    atomic::check(report)
        .map_err(|error| CliError::from(error).within("the report cannot be written"))
}
