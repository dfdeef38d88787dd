//! Conversion of a mesh to another format, by a run or by `convert`.

use std::io::Write;
use std::path::{Path, PathBuf};

use gpu_smooth::options::Precision;
use gpu_smooth_job::smoother_precision;
use mesh_io::{Conversion, Encoding, Format, PointField};

use crate::error::{CliError, ErrorKind};
use crate::load::LoadedMesh;
use crate::load::streams::is_standard;
use crate::request::FormRequest;
use crate::terminal::tell;

/// The format and the encoding to which a mesh is converted.
#[derive(Clone, Copy)]
pub(crate) struct NewForm {
    pub(crate) format: Format,
    encoding: Option<Encoding>,
    /// The precision with which the format stores coordinates.
    pub(crate) precision: Precision,
}

impl FormRequest {
    /// Returns the format that `--to` or the ending of `out` names.
    ///
    /// # Errors
    /// Returns a usage error if the ending names no format that conversions write.
    pub(crate) fn format(&self, out: &Path) -> Result<Format, CliError> {
        self.to.or_else(|| Conversion::target_of(out)).ok_or_else(|| {
            let (path, read) = (out.display(), Format::ALL.iter().find(|f| f.has_extension(out)));
            let problem = match read {
                Some(format) => format!("{} is read, but not written", format.family()),
                None => "its ending names no format to convert to".to_owned(),
            };
            CliError::usage(format!("{path}: {problem}")).with_remedy(known())
        })
    }

    /// Returns the format to which a run converts a mesh in the format `own` that is written to `out`. `None` if the file is
    /// rewritten with nothing but its coordinates changed.
    fn format_of_run(&self, own: Format, out: &Path) -> Result<Option<Format>, CliError> {
        if let Some(to) = self.to {
            let is_own = Conversion::target_like(own) == Some(to) && self.encoding.is_none();
            return Ok((!is_own).then_some(to));
        }
        let keeps =
            is_standard(out) || own.has_extension(out) || Format::name_of_extension(out).is_none();
        match (keeps, self.encoding) {
            (true, None) => Ok(None),
            (true, Some(_)) => Conversion::target_like(own).map(Some).ok_or_else(|| {
                CliError::usage(format!("{own} is read, but not written in another --encoding"))
                    .with_remedy(known())
            }),
            // The command line is right by itself, as IN may be in the format of OUT.
            (false, _) => {
                self.format(out).map(Some).map_err(|error| error.of_kind(ErrorKind::Output))
            }
        }
    }

    /// Returns the conversion by which a run writes a mesh to `out`; `None` if the run rewrites the file.
    ///
    /// # Errors
    /// Returns an error if the format is not written, or if the format does not hold all of the mesh and `--lossy` is
    /// missing.
    pub(crate) fn of_run(
        &self,
        file: &LoadedMesh,
        out: &Path,
    ) -> Result<Option<(NewForm, Conversion)>, CliError> {
        let format = self.format_of_run(file.source.format(), out)?;
        format.map(|format| self.checked(file, format, out)).transpose()
    }

    /// Returns the conversion of a mesh to `format`.
    ///
    /// # Errors
    /// Returns an error if the format is not written in the encoding, or if the format does not hold all of the mesh and
    /// `--lossy` is missing.
    pub(crate) fn checked(
        &self,
        file: &LoadedMesh,
        format: Format,
        out: &Path,
    ) -> Result<(NewForm, Conversion), CliError> {
        let mut form = NewForm { format, encoding: self.encoding, precision: Precision::Double };
        let conversion = form.conversion(file, file.source.points(), &[], out)?;
        form.precision = smoother_precision(conversion.precision());
        if file.source.triangles().is_empty() && !conversion.holds_quadrilaterals() {
            let (path, out) = (file.source.path().display(), out.display());
            return Err(CliError::input(format!(
                "{path}: the mesh has quadrilaterals alone, and {format} holds none, so that {out} would have no element"
            ))
            .with_remedy("Name an OUT of another format"));
        }
        let lost = conversion.losses();
        if !self.is_lossy && !lost.is_empty() {
            let path = file.source.path().display();
            return Err(CliError::input(format!(
                "{path}: {format} does not hold all of this mesh; --lossy writes it without"
            ))
            .with_details(lost.to_vec()));
        }
        Ok((form, conversion))
    }
}

impl NewForm {
    /// Returns the conversion of a mesh with its vertices at `points`, in the units of the file, and the values of `fields`.
    ///
    /// # Errors
    /// Returns an error if the format is not written in the encoding, or if names of groups in the file are damaged.
    pub(crate) fn conversion(
        &self,
        file: &LoadedMesh,
        points: &[[f64; 2]],
        fields: &[PointField],
        out: &Path,
    ) -> Result<Conversion, CliError> {
        let (format, out) = (self.format, out.display());
        let conversion = Conversion::moved(&file.source, format, points, fields)?;
        let mut conversion = conversion.ok_or_else(|| {
            CliError::usage(format!("{out}: {format} is read, but not written"))
                .with_remedy(known())
        })?;
        conversion.set_creator("gpu-smooth");
        match self.encoding {
            Some(encoding) if !conversion.set_encoding(encoding) => {
                let problem = format!("{out}: {format} is not written in this --encoding");
                let remedy = "gmsh, legacy VTK and PLY take text and binary, VTK XML takes text, binary and compressed";
                Err(CliError::usage(problem).with_remedy(remedy))
            }
            _ => Ok(conversion),
        }
    }
}

/// Returns a note for each loss and each change of names of a conversion, and for heights of `file` that become third
/// coordinates.
pub(crate) fn notes(file: &LoadedMesh, conversion: &Conversion) -> Vec<String> {
    let format = conversion.format();
    let lost = conversion.losses().iter().chain(conversion.omissions());
    let lost = lost.map(|what| format!("lost: {what}"));
    let renamed = conversion.renamings().iter();
    let renamed = renamed.map(|what| format!("renamed, as {format} cannot hold it so: {what}"));
    let notes = lost.chain(renamed);
    notes.chain(heights_note(file, conversion)).collect()
}

/// Returns a note if the third number of a vertex is a height by definition in the format of `file`, and becomes a
/// coordinate. Commands refuse such coordinates as no plane. `None` otherwise.
fn heights_note(file: &LoadedMesh, conversion: &Conversion) -> Option<String> {
    let (from, to) = (file.source.format(), conversion.format());
    let has_heights = matches!(from, Format::Sms2dm | Format::Mike) && file.source.has_data("z");
    let keeps_heights = matches!(
        to,
        Format::Sms2dm | Format::Mike | Format::Adcirc | Format::Selafin | Format::Ugrid
    );
    let is_lost = || conversion.losses().iter().any(|lost| lost == "third coordinates");
    (has_heights && !keeps_heights && !is_lost()).then(|| {
        format!("heights of the {from} become third coordinates of the {to}: add --z data to commands that read OUT")
    })
}

/// Returns the paths of the files to which a conversion is written; no path for standard output.
///
/// # Errors
/// Returns an error if the mesh cannot be written to `out`, or has several files and `out` is standard output.
pub(crate) fn destinations(conversion: &Conversion, out: &Path) -> Result<Vec<PathBuf>, CliError> {
    let all = conversion.destinations(out);
    match is_standard(out) {
        true if all.len() > 1 => Err(CliError::output(
            "a Triangle mesh has several files and cannot go to standard output: name OUT",
        )),
        true => Ok(Vec::new()),
        false => {
            conversion.check_destination(out)?;
            Ok(all)
        }
    }
}

/// Writes a conversion to a file, or to standard output if the path is `-`.
pub(crate) fn write(conversion: &Conversion, out: &Path) -> Result<(), CliError> {
    match conversion.bytes() {
        Some(content) if is_standard(out) => {
            let mut out = std::io::stdout();
            let written = out.write_all(&content).and_then(|()| out.flush());
            written.map_err(|error| {
                tell::end_if_closed(&error);
                CliError::output(format!("standard output: {error}"))
            })
        }
        _ => Ok(conversion.write(out)?),
    }
}

fn known() -> String {
    let names: Vec<_> = Conversion::targets().map(|(name, _)| name).collect();
    format!("--to takes one of {}", names.join(", "))
}
