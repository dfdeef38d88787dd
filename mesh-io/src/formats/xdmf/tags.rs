//! Mesh tags of DOLFINx. A grid with mesh tags lists some cells in its own Topology, gives a number to each of these cells,
//! and refers to the Geometry of the mesh.

use super::File;
use super::cells::TagRegions;
use super::document::Item;
use crate::content::group_label::GroupLabel;
use crate::error::ReadError;
use crate::formats::vtk::cells::Cell;
use crate::formats::vtk::types;
use crate::text::cursor::CORRECT;
use crate::text::token::quoted;
use crate::visit::items::{GroupScope, RegionAttribute};
use crate::visit::visitor::MeshVisitor;
use std::collections::HashMap;

/// The number of triangles without a tag.
const UNTAGGED: i64 = i64::MIN;

/// Makes the region attribute of the tags of triangles.
fn attribute(name: &str) -> RegionAttribute {
    let label = |tag| (tag != UNTAGGED).then_some(GroupLabel::Tag(tag));
    RegionAttribute { kind: name.to_owned(), from_dimension: 2, label }
}

/// Items of one grid with mesh tags.
pub(super) struct MeshTags<'i> {
    topology: &'i Item,
    /// Lists of tags, each with a tag for each cell of `topology`. At least one.
    values: Vec<&'i Item>,
}

impl File<'_> {
    /// Lists all mesh tags.
    ///
    /// # Errors
    /// If a grid has a second Topology, or other items than lists of tags for its cells.
    fn tags(&self) -> Result<Vec<MeshTags<'_>>, ReadError> {
        let mut found = Vec::new();
        for topology in self.tagged.iter().filter(|item| item.section == "Topology") {
            let is_other = |item: &&Item| item.grid == topology.grid && item.at != topology.at;
            let values: Vec<&Item> = self.tagged.iter().filter(is_other).collect();
            if values.is_empty() || values.iter().any(|item| item.center != "cell") {
                let problem = "this is the second Topology, and not one of mesh tags";
                let remedy = "Save each mesh to a separate file";
                return Err(self.cursor(topology).error(problem, remedy));
            }
            found.push(MeshTags { topology, values });
        }
        Ok(found)
    }

    /// Returns the tags of triangles of the mesh as regions, and all other mesh tags.
    ///
    /// # Errors
    /// If tags are damaged, or name a triangle that the mesh does not have.
    pub(super) fn tag_regions(
        &self,
        mesh: &Item,
    ) -> Result<(TagRegions, Vec<MeshTags<'_>>), ReadError> {
        let (mut regions, mut lines) = (TagRegions::default(), Vec::new());
        for tags in self.tags()? {
            match self.tags_of_triangles(&tags, mesh)? {
                Some(numbers) => {
                    let attributes = tags.values.iter().map(|values| attribute(&values.name));
                    regions.numbers.extend(attributes.zip(numbers));
                }
                None => lines.push(tags),
            }
        }
        // Lines of mesh tags have no numbers in the arrays of the mesh.
        if !lines.is_empty() {
            regions.from_dimension = 2;
        }
        Ok((regions, lines))
    }

    /// Returns the nodes of all cells of a Topology of one type.
    fn all_nodes(&self, topology: &Item) -> Result<Vec<u64>, ReadError> {
        let words = &mut self.words(topology)?;
        let mut nodes = Vec::new();
        while words.has_next() {
            nodes.push(words.take("a node of a cell")?);
        }
        Ok(nodes)
    }

    /// Reads the cells of mesh tags: VTK's cell type, the number of nodes of a cell, the nodes of all cells, and the lists of
    /// tags.
    fn tagged_cells(&self, tags: &MeshTags<'_>) -> Result<TaggedCells, ReadError> {
        let (cell_type, corners) = self.uniform(tags.topology, &tags.topology.kind)?;
        let nodes = self.all_nodes(tags.topology)?;
        let values = tags.values.iter().map(|item| self.integers(item));
        let values = values.collect::<Result<Vec<_>, _>>()?;
        for (item, values) in tags.values.iter().zip(&values) {
            if corners == 0 || nodes.len() as u64 != corners.saturating_mul(values.len() as u64) {
                let problem = format!(
                    "there are {} tags for {} nodes of cells with {corners} nodes",
                    values.len(),
                    nodes.len()
                );
                return Err(self.cursor(item).error(problem, CORRECT));
            }
        }
        Ok(TaggedCells { cell_type, corners: corners as usize, nodes, values })
    }

    /// Returns each list of tags with the tag of each triangle of the mesh, [`UNTAGGED`] for a triangle without a tag. `None`
    /// for tags of other cells.
    ///
    /// # Errors
    /// If the tags are damaged, or name a triangle that the mesh does not have.
    fn tags_of_triangles(
        &self,
        tags: &MeshTags<'_>,
        mesh: &Item,
    ) -> Result<Option<Vec<Vec<i64>>>, ReadError> {
        if tags.topology.kind != "triangle" || mesh.kind != "triangle" {
            return Ok(None);
        }
        let nodes = self.all_nodes(mesh)?;
        let key = |corners: &[u64]| {
            let mut key = [corners[0], corners[1], corners[2]];
            key.sort_unstable();
            key
        };
        let triangles: HashMap<[u64; 3], usize> = nodes.chunks_exact(3).map(key).zip(0..).collect();
        let tagged = self.tagged_cells(tags)?;
        let mut numbers = vec![vec![UNTAGGED; nodes.len() / 3]; tagged.values.len()];
        for (own, corners) in tagged.nodes.chunks_exact(3).enumerate() {
            let Some(&triangle) = triangles.get(&key(corners)) else {
                let name = quoted(tags.values[0].name.as_bytes());
                let problem = format!(
                    "`{name}` tags a triangle of the points {corners:?}, which the mesh does not have"
                );
                return Err(self
                    .cursor(tags.values[0])
                    .error(problem, "Save the mesh and its tags again"));
            };
            for (numbers, values) in numbers.iter_mut().zip(&tagged.values) {
                numbers[triangle] = values[own];
            }
        }
        Ok(Some(numbers))
    }

    /// Visits the lines and points of mesh tags as elements in groups, with ids from `id` on.
    ///
    /// # Errors
    /// If the tags are damaged, or belong to cells of another kind.
    pub(super) fn lines_of_tags(
        &self,
        tags: MeshTags<'_>,
        mut id: u64,
        visitor: &mut dyn MeshVisitor,
    ) -> Result<u64, ReadError> {
        let cursor = &self.cursor(tags.topology);
        let cells = self.tagged_cells(&tags)?;
        if !matches!(cells.cell_type, types::LINE | types::VERTEX) {
            let problem = "mesh tags of cells that are neither triangles, lines nor points";
            return Err(cursor.error(problem, "Save the mesh without these tags"));
        }
        let mut last = Vec::new();
        for (own, points) in cells.nodes.chunks_exact(cells.corners).enumerate() {
            let values: Vec<i64> = cells.values.iter().map(|values| values[own]).collect();
            if last != values && visitor.asks_for_groups() {
                let tags = tags.values.iter().zip(&values);
                let scopes: Vec<GroupScope<'_>> = tags
                    .map(|(item, &tag)| {
                        let label = GroupLabel::Tag(tag);
                        GroupScope { kind: &item.name, label, dimension: None }
                    })
                    .collect();
                visitor.group_scopes(&scopes);
            }
            last = values;
            let region = [UNTAGGED; 2];
            Cell { id, cell_type: cells.cell_type, points, region }.send(cursor, visitor)?;
            id += 1;
        }
        if visitor.asks_for_groups() {
            visitor.group_scopes(&[]);
        }
        Ok(id)
    }
}

struct TaggedCells {
    /// VTK's cell type.
    cell_type: u64,
    /// Number of nodes of each cell.
    corners: usize,
    nodes: Vec<u64>,
    /// A tag of each cell, for each list.
    values: Vec<Vec<i64>>,
}
