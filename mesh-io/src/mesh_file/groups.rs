//! Groups of elements and single vertices that a user can name in a mesh file.

use crate::content::group::Groups;
use crate::content::id_index::IdIndex;
use crate::disk::source::Source;
use crate::error::ReadError;
use crate::mesh_file::mesh::MeshFile;
use crate::text::cursor::Cursor;
use crate::visit::group_visitor;
use std::path::Path;

impl MeshFile {
    /// Returns all groups that the file names or numbers. The file's content is searched again for them.
    ///
    /// | format | groups |
    /// |---|---|
    /// | gmsh | `physical`, with their names, and `entity`; parts of an entity, for partitions, are the one they are parts of |
    /// | SU2 | `marker`, and `zone` if there are several |
    /// | Medit | `reference` of vertices, edges, triangles and quadrilaterals; `list`: Corners, RequiredVertices and RequiredTriangles |
    /// | FreeFem | `label` of vertices, triangles and edges |
    /// | SMS 2dm | `material`, with the names of MAT rows, and `nodestring`, numbered in their order |
    /// | ADCIRC, SCHISM | `boundary`: `open1`, `land1`, `island2` and so on, as the file lists them |
    /// | OBJ | `material`, `object` and `group` |
    /// | Exodus II | `block`, `sideset` and `nodeset`, with their names |
    /// | CGNS | `section`, `boundary` and its `family`, by name |
    /// | MED | `group` of elements and of nodes, by name; `family` of elements |
    /// | Triangle | `attribute` (`attribute1` and so on if there are several), `marker` of vertices and segments |
    /// | VTK, XDMF | values of the cell data that tell [regions](Self#regions), called as these arrays are |
    /// | STL | `solid` |
    /// | Abaqus | `elset`, `surface` and `nset`, by name |
    /// | Nastran | `property`, with the names that comments of preprocessors give |
    /// | others | none |
    ///
    /// Points, lines and surfaces with the same tag are separate groups. Zero is no group where programs write it for
    /// no tag, as in gmsh and for markers and references of vertices.
    ///
    /// # Errors
    /// [`ReadError`] if the names of groups, such as gmsh's `$Entities`, are damaged. Reading the mesh does not need
    /// them.
    pub fn groups(&self) -> Result<Groups, ReadError> {
        let table = group_visitor::groups(self.reader(), self.source())?;
        Ok(table.finish(self.triangles(), self.points().len()))
    }

    /// Reads a list of vertices by the mesh file's own numbers, those of [`SourceLocation::id`](crate::SourceLocation::id). Numbers
    /// are separated by blanks or line ends, and `#` starts a comment. Returns indices in
    /// [`MeshFile::points`](crate::MeshFile::points), in the order of the list.
    ///
    /// # Errors
    /// [`ReadError`] if the list cannot be read, holds anything but whole numbers, or has a number that no vertex has.
    pub fn read_vertices(&self, list: &Path) -> Result<Vec<u32>, ReadError> {
        let list = &Source::load(list)?;
        let labels = self.vertex_ids()?;
        // Each label belongs to one vertex, as files with repeated labels are refused.
        let map = IdIndex::new(&labels).ok();
        let cursor = &mut Cursor::new(list);
        let mut vertices = Vec::new();
        while cursor.next_word() {
            let label = cursor.integer("the number of a vertex")?;
            let vertex = map.as_ref().and_then(|map| map.index(label));
            vertices.push(vertex.ok_or_else(|| {
                let problem = format!("{} has no vertex {label}", self.path().display());
                cursor.error(problem, self.range_of(&labels))
            })?);
        }
        Ok(vertices)
    }

    fn range_of(&self, labels: &[u64]) -> String {
        let least = labels.iter().min().copied().unwrap_or(0);
        let most = labels.iter().max().copied().unwrap_or(0);
        format!("Its vertices are numbered from {least} to {most}")
    }

    /// Returns the id of each vertex in the file.
    fn vertex_ids(&self) -> Result<Vec<u64>, ReadError> {
        group_visitor::vertex_ids(self.reader(), self.source())
    }
}
