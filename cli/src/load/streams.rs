//! Input and output of meshes. The path `-` denotes standard input or output.

use std::io::Read;
use std::path::{Path, PathBuf};

use mesh_io::{MeshFile, PointField, WriteError};

use crate::error::CliError;
use crate::load::LoadedMesh;
use crate::request::ReadRequest;
use crate::terminal::tell;

/// Reads a mesh from a file, or from standard input if the path is `-`.
pub(crate) fn read(path: &Path, request: &ReadRequest) -> Result<LoadedMesh, CliError> {
    let source = read_source(path, request)?;
    if source.triangles().is_empty() && !request.has_elements_of(&source) {
        return Err(quadrilaterals_alone(&source));
    }
    Ok(match request.has_elements_of(&source) {
        true => LoadedMesh::of_elements(source),
        false => LoadedMesh::new(source),
    })
}

fn read_source(path: &Path, request: &ReadRequest) -> Result<MeshFile, CliError> {
    // A pipe is read once, so the mesh is refused after it was read if it has quadrilaterals alone.
    let options = request.options().allow_quadrilaterals_alone(true);
    if !is_standard(path) {
        return Ok(options.read(path)?);
    }
    let mut bytes = Vec::new();
    std::io::stdin()
        .read_to_end(&mut bytes)
        .map_err(|error| CliError::input(format!("standard input: {error}")))?;
    Ok(options.from_bytes(Path::new("standard input"), bytes)?)
}

/// Returns the error for a mesh that has quadrilaterals and no triangle, for a run that keeps quadrilaterals.
fn quadrilaterals_alone(file: &MeshFile) -> CliError {
    let (path, vertices) = (file.path().display(), file.points().len());
    let quadrilaterals = match file.quadrilaterals().len() {
        1 => "1 quadrilateral".to_owned(),
        count => format!("{count} quadrilaterals"),
    };
    CliError::input(format!("{path}: {vertices} vertices and {quadrilaterals}, but no triangle"))
        .with_remedy("Let their vertices move: leave out --quadrilaterals keep")
}

/// Returns whether a path denotes standard input or output.
pub(crate) fn is_standard(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Writes a mesh with the values of `fields` to a file, or to standard output if the path is `-`.
pub(crate) fn write(
    file: &LoadedMesh,
    out: &Path,
    points: &[[f64; 2]],
    fields: &[PointField],
) -> Result<(), CliError> {
    let written = match is_standard(out) {
        true => {
            let name = Path::new("standard output");
            let written = file.write_to_with(name, &mut std::io::stdout(), points, fields);
            if let Err(WriteError::Io { source, .. }) = &written {
                tell::end_if_closed(source);
            }
            written
        }
        false => file.write_with(out, points, fields),
    };
    Ok(written?)
}

/// Returns the paths of the files to which a mesh is rewritten; no path for standard output.
///
/// # Errors
/// Returns an error if the mesh cannot be written to `out`, or has several files and `out` is standard
/// output.
pub(crate) fn destinations(file: &LoadedMesh, out: &Path) -> Result<Vec<PathBuf>, CliError> {
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

/// Prints a text to standard output, or to standard error if standard output receives the mesh.
pub(crate) fn say_beside(out: &Path, text: &str) {
    match is_standard(out) {
        true => tell::aside(text),
        false => tell::say(text),
    }
}
