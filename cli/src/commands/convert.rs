//! The command `gpu-smooth convert IN OUT`, which writes a mesh in another format.

use std::fs;
use std::path::PathBuf;
use std::slice;

use mesh_io::Conversion;

use crate::args::{ConvertArgs, OutputArgs};
use crate::error::{CliError, ErrorKind};
use crate::load::overwrite::{self, Likeness};
use crate::load::{LoadedMesh, conversion, streams};
use crate::request::{FormRequest, MeshOutput, Outputs, ReadRequest};
use crate::terminal::numbers::elements;
use crate::terminal::{interrupt, tell};

/// Writes a mesh in another format. Without `--lossy`, returns an error if that format cannot hold all of the mesh.
pub(crate) fn run(args: &ConvertArgs, show: &OutputArgs) -> Result<(), CliError> {
    let form = FormRequest::from(&args.form);
    let format = form.format(&args.output)?;
    // From here on, a signal leaves no temporary file behind.
    interrupt::watch(show.quiet);
    let outputs = Outputs::of_mesh(MeshOutput::Converted);
    let (read, out) = (slice::from_ref(&args.input), &args.output);
    outputs.check(read, slice::from_ref(out))?;
    let reading = ReadRequest::from(&args.reading).taking_quadrilaterals();
    let file = streams::read(&args.input, &reading)?;
    let (_, converted) = form.checked(&file, format, out)?;
    for note in conversion::notes(&file, &converted) {
        tell::note(show.quiet, &note);
    }
    let written = conversion::destinations(&converted, out)?;
    outputs.check_files(&file.paths(), &written, ErrorKind::Output)?;
    if !args.force {
        check_overwrite(&file, &converted, &written, reading)?;
    }
    conversion::write(&converted, out)?;
    if !show.quiet && !streams::is_standard(out) {
        let mesh = file.mesh();
        let vertices = mesh.points.len();
        let elements = elements(mesh.triangles.len(), mesh.quadrilaterals.len());
        tell::say(&format!(
            "{vertices} vertices and {elements}, with all else that {format} holds of {}: {}",
            file.source.format(),
            out.display()
        ));
    }
    Ok(())
}

/// Checks that the files in `written` are new, or hold an earlier result of this conversion or the same triangles.
fn check_overwrite(
    file: &LoadedMesh,
    conversion: &Conversion,
    written: &[PathBuf],
    reading: ReadRequest,
) -> Result<(), CliError> {
    // Conversions write joined vertices. Other vertices at one place, such as those of a crack, stay apart.
    let reading = ReadRequest { weld: false, ..reading };
    let found = overwrite::check(file, written, &reading, Likeness::Elements);
    let Err(error) = found else { return Ok(()) };
    // A format may renumber vertices. Equal bytes then identify an earlier result of this conversion.
    let is_same = |path: &PathBuf, new: Vec<u8>| fs::read(path).is_ok_and(|old| old == new);
    if let ([path], Some(new)) = (written, conversion.bytes())
        && is_same(path, new)
    {
        return Ok(());
    }
    Err(error.with_remedy("Give OUT another name, or replace the file by --force"))
}
