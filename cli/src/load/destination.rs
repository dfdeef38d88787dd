//! Checks of the files to which a run writes its mesh.

use std::path::Path;

use mesh_io::Conversion;

use crate::error::{CliError, ErrorKind};
use crate::load::overwrite::{self, Likeness};
use crate::load::{LoadedMesh, conversion, streams};
use crate::request::{MeshOutput, ReadRequest, SmoothRequest};

/// Checks, once the mesh of `input` has been read, that a run can write the mesh to `out` and replaces no foreign file.
/// `conversion` is the conversion by which the mesh is written; `None` for a rewrite of its file. `remedy` follows the error
/// of a foreign file.
pub(crate) fn check(
    request: &SmoothRequest,
    file: &LoadedMesh,
    out: &Path,
    conversion: Option<&Conversion>,
    remedy: &str,
) -> Result<(), CliError> {
    let SmoothRequest { outputs, reading, .. } = request;
    let (written, mesh) = match conversion {
        None => (streams::destinations(file, out)?, outputs.mesh),
        Some(conversion) => (conversion::destinations(conversion, out)?, MeshOutput::Converted),
    };
    outputs.check_files_of(mesh, &file.paths(), &written, ErrorKind::Output)?;
    if outputs.replaces_any {
        return Ok(());
    }
    let (reading, likeness) = match conversion {
        None => (reading.clone(), Likeness::Mesh { slides: request.slide.is_some() }),
        // Conversions write joined vertices. Other vertices at one place, such as those of a crack, stay apart.
        Some(_) => (ReadRequest { weld: false, ..reading.clone() }, Likeness::Elements),
    };
    overwrite::check(file, &written, &reading, likeness).map_err(|error| error.with_remedy(remedy))
}
