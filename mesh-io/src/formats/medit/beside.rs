//! Files beside a Medit mesh that belong to its vertices.

use crate::content::remark::Remark;
use crate::disk::source::Source;
use crate::visit::visitor::MeshVisitor;

/// Reports a solution or metric file beside the mesh, of the same name with the ending `.sol` or `.solb`. Its numbers
/// belong to the vertices of the mesh, but no rewrite or conversion updates the file.
pub(crate) fn report_solution(source: &Source, visitor: &mut dyn MeshVisitor) {
    let paths = [".sol", ".solb"].map(|ending| source.path.with_extension(&ending[1..]));
    let Some(path) = paths.iter().find(|path| path.is_file()) else { return };
    let name = path.file_name().unwrap_or_default().display();
    visitor.remark(Remark::Text(format!(
        "{name} beside the mesh stays as it is, although its numbers belong to the vertices of this mesh"
    )));
    visitor.unsupported(&format!("the solution in {name} beside the mesh"));
}
