//! Finds ghosts by cell data, in formats whose readers pass no ghosts.

use crate::content::remark::Remark;
use crate::disk::source::Source;
use crate::error::ReadError;
use crate::visit::cell_values::cell_values;
use crate::visit::ghosts::vtk_ghosts;
use crate::visit::parsed_mesh::ParsedMesh;
use crate::visit::reader::ReaderFunctions;

/// Constrains the vertices of the triangles that cell data named like VTK's mark as ghosts.
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
    let of_quadrilaterals = values.get(parsed.triangles.len()..).unwrap_or_default();
    let marked = parsed.triangles.iter().zip(&values).filter(|&(_, &value)| is_ghost(value));
    let ghosts: Vec<[u32; 3]> = marked.map(|(&corners, _)| corners).collect();
    // Vertices of quadrilaterals are constrained anyway, unless a program lets them move.
    let marked = parsed.quadrilaterals.iter().zip(of_quadrilaterals);
    let marked = marked.filter(|&(_, &value)| is_ghost(value));
    parsed.held.extend(marked.flat_map(|(corners, _)| corners));
    if !ghosts.is_empty() {
        parsed.constraints.vertices.extend(ghosts.iter().flatten());
        parsed.constraints.anchored.extend(ghosts.iter().flatten());
        parsed.remarks.push(Remark::elements(ghosts.len() as u64, "ghost element", ""));
    }
    Ok(())
}
