//! Files beside a Medit mesh that belong to its vertices.

use crate::compress::file::inner_name;
use crate::content::remark::Remark;
use crate::disk::source::Source;
use crate::visit::visitor::MeshVisitor;

/// Reports a solution or metric file beside the mesh, of the same name with the ending `.sol` or `.solb` in small or
/// capital letters. Its numbers belong to the vertices of the mesh, but no rewrite or conversion updates the file.
pub(crate) fn report_solution(source: &Source, visitor: &mut dyn MeshVisitor) {
    // The mesh may be compressed, as `a.mesh.gz`.
    let name = source.name();
    let length = inner_name(&name.to_ascii_lowercase()).len();
    let mesh = source.path.with_file_name(&name[..length]);
    let paths = ["sol", "solb", "SOL", "SOLB"].map(|ending| mesh.with_extension(ending));
    let Some(path) = paths.iter().find(|path| path.is_file()) else { return };
    let name = path.file_name().unwrap_or_default().display();
    visitor.remark(Remark::Text(format!(
        "{name} beside the mesh stays as it is, although its numbers belong to the vertices of this mesh"
    )));
    visitor.unsupported(&format!("the solution in {name} beside the mesh"));
}
