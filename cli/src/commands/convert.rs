//! `gpu-smooth convert IN OUT`: writes a mesh in another format.

use std::io::Write;
use std::slice;

use mesh_io::{Conversion, Format};

use crate::args::{ConvertArgs, OutputArgs};
use crate::error::{CliError, ErrorKind};
use crate::load::streams::{self, is_standard};
use crate::request::{MeshOutput, Outputs};
use crate::terminal::tell;

/// Writes a mesh in another format. Returns an error if the format does not hold all of the mesh, unless `--lossy` is
/// given.
pub(crate) fn run(args: &ConvertArgs, show: &OutputArgs) -> Result<(), CliError> {
    let format = format(args)?;
    let outputs = Outputs::of_mesh(MeshOutput::Converted);
    let (read, written) = (slice::from_ref(&args.input), slice::from_ref(&args.output));
    outputs.check(read, written)?;
    let file = streams::read(&args.input, args.reading.into())?;
    let conversion = Conversion::new(&file.source, format)?;
    let (path, out) = (file.source.path().display(), args.output.display());
    let Some(mut conversion) = conversion else {
        return Err(CliError::usage(format!("{out}: {format} is not written by convert"))
            .with_remedy(known()));
    };
    conversion.set_creator("gpu-smooth");
    let lost = conversion.lost();
    if !args.lossy && !lost.is_empty() {
        return Err(CliError::input(format!(
            "{path}: {format} does not hold all of this mesh; --lossy writes it without"
        ))
        .with_details(lost.to_vec()));
    }
    for what in lost {
        tell::note(show.quiet, &format!("lost: {what}"));
    }
    for what in conversion.renamed() {
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

/// Returns the format to write: that of `--to`, or that of the ending of OUT.
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
