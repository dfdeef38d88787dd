//! Finds ghosts by cell data, in formats whose readers pass no ghosts.

use crate::content::remark::Remark;
use crate::disk::source::Source;
use crate::error::ReadError;
use crate::visit::cell_values::cell_values;
use crate::visit::ghosts::vtk_ghosts;
use crate::visit::parsed_mesh::ParsedMesh;
use crate::visit::reader::ReaderFunctions;

/// Constrains the vertices of the elements that cell data named like VTK's mark as ghosts.
///
/// # Errors
/// If the file cannot be read.
pub(super) fn constrain(
    parsed: &mut ParsedMesh,
    reader: &ReaderFunctions,
    source: &Source,
) -> Result<(), ReadError> {
    let Some(name) = parsed.ghost_array.take() else { return Ok(()) };
    let Some(is_ghost) = vtk_ghosts(name.as_bytes()) else { return Ok(()) };
    let values = cell_values(reader, source, &[name])?.concat();
    let marked = parsed.elements().zip(values).filter(|&(_, value)| is_ghost(value));
    let ghosts: Vec<&[u32]> = marked.map(|(corners, _)| corners).collect();
    let (count, vertices) = (ghosts.len() as u64, ghosts.concat());
    if count > 0 {
        parsed.constraints.vertices.extend_from_slice(&vertices);
        parsed.constraints.anchored.extend_from_slice(&vertices);
        parsed.remarks.push(Remark::elements(count, "ghost element", ""));
    }
    Ok(())
}
