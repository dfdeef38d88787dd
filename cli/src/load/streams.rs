//! Reads and writes meshes. The name `-` stands for the standard input or output.

use std::io::Read;
use std::path::{Path, PathBuf};

use mesh_io::{MeshFile, PointField};

use crate::error::CliError;
use crate::load::LoadedMesh;
use crate::request::ReadRequest;
use crate::terminal::tell;

/// Reads a mesh from a file, or from the standard input if its name is `-`.
pub(crate) fn read(path: &Path, request: ReadRequest) -> Result<LoadedMesh, CliError> {
    read_source(path, request).map(LoadedMesh::new)
}

fn read_source(path: &Path, request: ReadRequest) -> Result<MeshFile, CliError> {
    let options = request.options();
    if !is_standard(path) {
        return Ok(options.read(path)?);
    }
    let mut bytes = Vec::new();
    std::io::stdin()
        .read_to_end(&mut bytes)
        .map_err(|error| CliError::input(format!("standard input: {error}")))?;
    Ok(options.from_bytes(Path::new("standard input"), bytes)?)
}

/// Whether a name stands for the standard input or output.
pub(crate) fn is_standard(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Writes a mesh with these data to a file, or to the standard output if its name is `-`.
pub(crate) fn write(
    file: &LoadedMesh,
    out: &Path,
    points: &[[f64; 2]],
    fields: &[PointField],
) -> Result<(), CliError> {
    let written = match is_standard(out) {
        true => {
            let name = Path::new("standard output");
            file.write_to_with(name, &mut std::io::stdout(), points, fields)
        }
        false => file.write_with(out, points, fields),
    };
    Ok(written?)
}

/// Lists the files that a mesh is written to; none for the standard output.
///
/// # Errors
/// If the mesh cannot be written there.
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

/// Prints a text to the standard output, or to the standard error if the mesh goes to the standard output.
pub(crate) fn say_beside(out: &Path, text: &str) {
    match is_standard(out) {
        true => tell::aside(text),
        false => tell::say(text),
    }
}
