//! Groups of elements and single vertices that a user can name in a mesh file.

use crate::content::curve_edges::{CurveEdges, MeshEdges};
use crate::content::group::Groups;
use crate::content::group_ends::group_ends;
use crate::content::id_index::IdIndex;
use crate::disk::source::Source;
use crate::error::ReadError;
use crate::export::content::Content;
use crate::export::content_builder::common_kind;
use crate::mesh_file::mesh::MeshFile;
use crate::text::cursor::Cursor;
use crate::visit::group_table::GroupTable;
use crate::visit::group_visitor;
use crate::visit::items::CellKind;
use std::path::Path;

impl MeshFile {
    /// Parses the bytes of the file again, and returns all groups with a name or number.
    ///
    /// | format | groups |
    /// |---|---|
    /// | gmsh | `physical`, with their names, and `entity`; in partitioned meshes, the parts of an entity belong to the entity's group |
    /// | SU2 | `marker`, and `zone` if there are several |
    /// | Medit | `reference` of vertices, edges, triangles and quadrilaterals; `list`: Corners, Ridges, RequiredVertices, RequiredEdges, RequiredTriangles and RequiredQuadrilaterals |
    /// | FreeFem | `label` of vertices, triangles and edges |
    /// | SMS 2dm | `material`, with the names of MAT rows, and `nodestring`, numbered in their order |
    /// | ADCIRC, SCHISM | `boundary`: `open1`, `land1`, `island2` and so on, as the file lists them; a weir has both banks |
    /// | OBJ | `material`, `object` and `group` |
    /// | Exodus II | `block`, `sideset` and `nodeset`, with their names |
    /// | CGNS | `section`, `boundary` and its `family`, by name |
    /// | MED | `group` of elements and of nodes, by name; `family` of elements |
    /// | Triangle | `attribute` (`attribute1` and so on if there are several), `marker` of vertices and segments |
    /// | VTK, XDMF | values of the cell data that define [regions](Self#regions); the name of the array is the kind |
    /// | all with cell data | also the values of the array that [`ReadOptions::regions`](crate::ReadOptions::regions) names, or that looks like regions |
    /// | STL | `solid` |
    /// | Abaqus | `elset`, `surface` and `nset`, by name |
    /// | Nastran | `property`, with the names that comments of preprocessors give |
    /// | MFEM | `attribute` of elements and of the boundary |
    /// | JIGSAW | `tag` of points, edges, triangles and quadrilaterals |
    /// | MIKE | `code` of vertices |
    /// | others | none |
    ///
    /// Points, lines and surfaces with equal tags are separate groups. The tag 0 is no group where programs write 0 for
    /// untagged items, as in gmsh and for markers and references of vertices. Tags without names that differ for nearly
    /// every element count elements, and are no groups.
    ///
    /// # Errors
    /// [`ReadError`] if the description of groups is damaged, such as gmsh's `$Entities`, which [`read`](Self::read)
    /// skips.
    pub fn groups(&self) -> Result<Groups, ReadError> {
        let mut table = group_visitor::groups(self.reader(), self.source())?;
        if let Some(array) = self.region_array() {
            add_regions(&mut table, &self.content()?, array);
        }
        let quadrilaterals = self.quadrilaterals().len();
        Ok(table.finish(self.triangles(), quadrilaterals, self.points().len()))
    }

    /// Returns whether [`groups`](Self::groups) may have a group of lines, without parsing the bytes of the file again.
    pub fn may_name_lines(&self) -> bool {
        !self.constraints().lines.is_empty() || self.reader().names_other_lines
    }

    /// Parses the bytes of the file again, and returns the vertices at which groups of lines and groups of vertices end,
    /// on the boundary or inside the mesh, ascending. Programs that move vertices along lines keep these vertices, so
    /// that each group keeps its extent.
    ///
    /// A group of lines ends where other than two of its edges meet. A group of vertices, such as the codes of MIKE and
    /// node sets, ends where an edge of the boundary or of a line leads to a vertex outside the group. Numbers that
    /// differ for nearly every line or vertex are no groups.
    ///
    /// # Errors
    /// As for [`groups`](Self::groups).
    pub fn group_ends(&self) -> Result<Vec<u32>, ReadError> {
        let mesh = MeshEdges {
            vertices: self.points().len(),
            triangles: self.triangles(),
            other_faces: self.faces(),
            lines: &self.constraints().lines,
            interfaces: self.interfaces_of_elements().1,
        };
        let groups = self.groups()?;
        Ok(group_ends(&groups, &CurveEdges::new(&groups, &mesh)))
    }

    /// Reads a text file with the ids of vertices in the mesh file, as in
    /// [`SourceLocation::id`](crate::SourceLocation::id). Ids are separated by blanks or line ends, and `#` starts a
    /// comment. Returns the indices of the vertices in [`MeshFile::points`](crate::MeshFile::points), in the order of
    /// the list.
    ///
    /// # Errors
    /// [`ReadError`] if the list cannot be read, holds anything but whole numbers, or has an id without a vertex.
    pub fn read_vertices(&self, list: &Path) -> Result<Vec<u32>, ReadError> {
        let list = &Source::load(list)?;
        let labels = self.vertex_ids()?;
        // Each id belongs to one vertex, as files with repeated ids are refused.
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

/// Adds the groups of the cell data `array` that number the regions. Does nothing if the groups of the array are entries of
/// the format, which the table has.
fn add_regions(table: &mut GroupTable, content: &Content, array: &str) {
    if table.has_kind(array) {
        return;
    }
    let (mut triangles, mut quadrilaterals) = (0, 0);
    for cell in content.cells() {
        for group in cell.groups().filter(|group| group.kind == common_kind(array)) {
            let number = table.number(array, group.dimension, &group.label);
            match cell.kind {
                CellKind::Triangle => table.add_triangle(number, triangles),
                CellKind::Quadrilateral => {
                    table.add_quadrilateral(number, quadrilaterals, cell.vertices);
                }
                kind => table.add(number, kind, cell.vertices),
            }
        }
        triangles += u32::from(cell.kind == CellKind::Triangle);
        quadrilaterals += u32::from(cell.kind == CellKind::Quadrilateral);
    }
}
