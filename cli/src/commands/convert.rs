//! The command `gpu-smooth convert IN OUT`, which writes a mesh in another format.

use std::fs;
use std::io::Write;
use std::path::PathBuf;
use std::slice;

use mesh_io::{Conversion, Format};

use crate::args::{ConvertArgs, OutputArgs};
use crate::error::{CliError, ErrorKind};
use crate::load::LoadedMesh;
use crate::load::overwrite::{self, Likeness};
use crate::load::streams::{self, is_standard};
use crate::request::{MeshOutput, Outputs, ReadRequest};
use crate::terminal::{interrupt, tell};

/// Writes a mesh in another format. Without `--lossy`, returns an error if that format cannot hold all of the mesh.
pub(crate) fn run(args: &ConvertArgs, show: &OutputArgs) -> Result<(), CliError> {
    let format = format(args)?;
    // From here on, a signal leaves no temporary file behind.
    interrupt::watch(show.quiet);
    let outputs = Outputs::of_mesh(MeshOutput::Converted);
    let (read, written) = (slice::from_ref(&args.input), slice::from_ref(&args.output));
    outputs.check(read, written)?;
    let file = streams::read(&args.input, &(&args.reading).into())?;
    let conversion = Conversion::new(&file.source, format)?;
    let (path, out) = (file.source.path().display(), args.output.display());
    let Some(mut conversion) = conversion else {
        return Err(CliError::usage(format!("{out}: {format} is not written by convert"))
            .with_remedy(known()));
    };
    conversion.set_creator("gpu-smooth");
    if let Some(encoding) = args.encoding
        && !conversion.set_encoding(encoding.into())
    {
        return Err(CliError::usage(format!("{out}: {format} is not written in this --encoding"))
            .with_remedy(
                "gmsh, legacy VTK and PLY take text and binary, VTK XML takes text, binary and compressed",
            ));
    }
    let lost = conversion.losses();
    if !args.lossy && !lost.is_empty() {
        return Err(CliError::input(format!(
            "{path}: {format} does not hold all of this mesh; --lossy writes it without"
        ))
        .with_details(lost.to_vec()));
    }
    for what in lost {
        tell::note(show.quiet, &format!("lost: {what}"));
    }
    for what in conversion.renamings() {
        tell::note(show.quiet, &format!("renamed, as {format} cannot hold it so: {what}"));
    }
    if is_standard(&args.output) {
        let Some(content) = conversion.bytes() else {
            return Err(CliError::output(
                "a Triangle mesh has several files and cannot go to standard output: name OUT",
            ));
        };
        let mut out = std::io::stdout();
        let written = out.write_all(&content).and_then(|()| out.flush());
        return written.map_err(|error| CliError::output(format!("standard output: {error}")));
    }
    let written = conversion.destinations(&args.output);
    outputs.check_files(&file.paths(), &written, ErrorKind::Output)?;
    if !args.force {
        check_overwrite(&file, &conversion, &written, (&args.reading).into())?;
    }
    conversion.write(&args.output)?;
    if !show.quiet {
        let mesh = file.mesh();
        let (vertices, triangles) = (mesh.points.len(), mesh.triangles.len());
        tell::say(&format!(
            "{vertices} vertices and {triangles} triangles, with all else that {format} holds of {}: {out}",
            file.source.format()
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
    // An existing mesh may be an STL, independent of the format of IN.
    let reading = ReadRequest { weld: true, ..reading };
    let found = overwrite::check(file, written, reading.options_of_output(), Likeness::Triangles);
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

/// Returns the format selected by `--to`, or else by the extension of OUT.
fn format(args: &ConvertArgs) -> Result<Format, CliError> {
    let by_ending = || Conversion::target_of(&args.output);
    args.to.or_else(by_ending).ok_or_else(|| {
        CliError::usage(format!(
            "{}: its ending names no format to convert to",
            args.output.display()
        ))
        .with_remedy(known())
    })
}

fn known() -> String {
    let names: Vec<_> = Conversion::targets().map(|(name, _)| name).collect();
    format!("--to takes one of {}", names.join(", "))
}
