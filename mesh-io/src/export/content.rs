//! Format-independent mesh in memory, with all cells, groups and data of its file.

use crate::content::group_label::GroupLabel;
use crate::visit::items::{CellKind, PeriodicNodes};

/// Mesh with cells of all kinds, groups and data, independent of formats.
/// [`MeshFile::content`](crate::MeshFile::content) reads the content of a file.
///
/// ```no_run
/// use mesh_io::{CellKind, MeshFile};
/// use std::path::Path;
///
/// let content = MeshFile::read(Path::new("part.msh"))?.content()?;
/// for line in content.cells().filter(|cell| cell.kind == CellKind::Line) {
///     let names: Vec<_> = line.groups().filter_map(|group| group.name()).collect();
///     println!("line {} from vertex {} to {}: {names:?}", line.id, line.vertices[0], line.vertices[1]);
/// }
/// # Ok::<(), mesh_io::ReadError>(())
/// ```
#[derive(Default)]
pub struct Content {
    /// x and y of each vertex.
    pub(crate) points: Vec<[f64; 2]>,
    /// Coordinates of the origin, which programs add to `points`.
    pub(crate) origin: [i32; 2],
    /// Name or definition of the projection of the coordinates; empty if the file has none.
    pub(crate) projection: String,
    /// The third coordinate of each vertex; empty if all are `common_z`.
    pub(crate) z_values: Vec<f64>,
    /// The third coordinate of all vertices, if `z_values` is empty.
    pub(crate) common_z: f64,
    /// Id of each vertex in the file.
    pub(crate) vertex_ids: Vec<u64>,
    pub(crate) cells: Cells,
    pub(crate) groups: Vec<ContentGroup>,
    /// Distinct sets of groups, as indices in `groups`. [`Cells::sets`] holds the index of each cell's set.
    pub(crate) sets: Vec<Vec<u32>>,
    /// Kind of the groups that the cell data of the regions make; `None` if the regions are entries of the format.
    pub(crate) region_kind: Option<String>,
    /// Kinds of the groups of elements as the file calls them, each once: in VTK's formats and XDMF, names of arrays.
    pub(crate) region_names: Vec<String>,
    /// Groups with a name in the file, but without cells and vertices.
    pub(crate) empty_groups: Vec<ContentGroup>,
    /// Groups of vertices, each with its vertices.
    pub(crate) vertex_groups: Vec<(ContentGroup, Vec<u32>)>,
    pub(crate) point_data: Vec<DataArray>,
    pub(crate) cell_data: Vec<DataArray>,
    /// Pairs of periodic vertices, as ids.
    pub(crate) periodic: Vec<PeriodicNodes>,
    /// Short descriptions of file content that the mesh does not include.
    pub(crate) unsupported: Vec<String>,
}

/// Cells of all kinds in file order.
#[derive(Default)]
pub(crate) struct Cells {
    /// The kind of each cell.
    pub(crate) kinds: Vec<CellKind>,
    /// Exclusive end of each cell's vertices in `vertices`.
    pub(crate) ends: Vec<usize>,
    pub(crate) vertices: Vec<u32>,
    /// The index of each cell's groups in [`Content::sets`].
    pub(crate) sets: Vec<u32>,
    /// The id of each cell in the file, to which cell data refer.
    pub(crate) ids: Vec<u64>,
}

/// A cell of a [`Content`].
#[derive(Clone, Copy)]
pub struct Cell<'c> {
    /// The kind of the cell.
    pub kind: CellKind,
    /// Id of the cell in the file; in formats without ids, the position in the file's list.
    pub id: u64,
    /// The indices of the cell's vertices, in the order of the file.
    pub vertices: &'c [u32],
    content: &'c Content,
    set: u32,
}

/// The identity of a group of cells or vertices in a [`Content`].
#[derive(Clone, Debug, PartialEq)]
pub struct ContentGroup {
    /// Kind of the group, such as `physical`. Equivalent kinds of several formats have a common word.
    pub(crate) kind: String,
    pub(crate) dimension: u8,
    pub(crate) label: GroupLabel,
    pub(crate) name: Option<String>,
}

impl ContentGroup {
    /// Returns the kind of the group, such as `physical`, `reference` or `nodeset`. Equivalent kinds of several formats
    /// have a common word.
    pub fn kind(&self) -> &str {
        &self.kind
    }

    /// Returns the dimension of the cells of the group: 0 for points and vertices, 1 for lines, 2 for surfaces.
    pub fn dimension(&self) -> u8 {
        self.dimension
    }

    /// Returns the number of the group. `None` if the file identifies the group by its name.
    pub fn tag(&self) -> Option<i64> {
        match self.label {
            GroupLabel::Tag(tag) => Some(tag),
            GroupLabel::Name(_) => None,
        }
    }

    /// Returns the name of the group; `None` if only a number identifies the group.
    pub fn name(&self) -> Option<&str> {
        match (&self.name, &self.label) {
            (Some(name), _) | (None, GroupLabel::Name(name)) => Some(name),
            (None, GroupLabel::Tag(_)) => None,
        }
    }
}

/// Named array of numbers on the vertices or cells of a mesh.
pub struct DataArray {
    pub(crate) name: String,
    pub(crate) components: usize,
    /// Whether the values are real numbers, not whole ones.
    pub(crate) is_real: bool,
    /// `components` values for each vertex or cell, NaN if the file gives none.
    pub(crate) values: Vec<f64>,
    /// Factor and offset by which the values were unpacked; `None` if the file does not pack them.
    pub(crate) packing: Option<[f64; 2]>,
}

impl DataArray {
    /// Sets the values from those that the file stores, which are unpacked.
    pub(crate) fn set_stored(&mut self, stored: &[f64]) {
        self.values = unpacked(stored.to_vec(), self.packing);
    }

    /// Returns the name. The second and later time steps of a result have the step's number after the name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the number of components per vertex or cell, at least 1.
    pub fn components(&self) -> usize {
        self.components
    }

    /// Returns the number of components with which gmsh displays the data: 1, 3 or 9, or any larger number.
    pub(crate) fn padded_components(&self) -> usize {
        [1, 3, 9].into_iter().find(|&size| size >= self.components).unwrap_or(self.components)
    }

    /// Returns whether some whole number is so large that `values` may have rounded it: doubles represent every whole number
    /// below 2^53 in size. The number 2^53 itself may stand for its successor.
    pub(crate) fn has_large_numbers(&self) -> bool {
        const LIMIT: f64 = 9_007_199_254_740_992.0;
        !self.is_real && self.values.iter().any(|value| value.abs() >= LIMIT)
    }

    /// Returns whether the file stores real numbers; otherwise it stores whole numbers.
    pub fn is_real(&self) -> bool {
        self.is_real
    }

    /// Returns the numbers, [`components`](Self::components) for each vertex or cell in order. A missing number is NaN.
    pub fn values(&self) -> &[f64] {
        &self.values
    }
}

/// Multiplies stored values by the factor of `packing` and adds its offset.
pub(crate) fn unpacked(mut stored: Vec<f64>, packing: Option<[f64; 2]>) -> Vec<f64> {
    if let Some([factor, offset]) = packing {
        stored.iter_mut().for_each(|value| *value = *value * factor + offset);
    }
    stored
}

impl<'c> Cell<'c> {
    /// Lists the groups that the cell belongs to.
    pub fn groups(&self) -> impl Iterator<Item = &'c ContentGroup> {
        let content = self.content;
        content.sets[self.set as usize].iter().map(|&group| &content.groups[group as usize])
    }
}

impl Cells {
    pub(crate) fn len(&self) -> usize {
        self.kinds.len()
    }

    /// Returns the vertices of a cell.
    pub(crate) fn of(&self, cell: usize) -> &[u32] {
        let start = if cell == 0 { 0 } else { self.ends[cell - 1] };
        &self.vertices[start..self.ends[cell]]
    }

    pub(crate) fn push(&mut self, kind: CellKind, vertices: &[u32], set: u32, id: u64) {
        self.kinds.push(kind);
        self.vertices.extend_from_slice(vertices);
        self.ends.push(self.vertices.len());
        self.sets.push(set);
        self.ids.push(id);
    }

    /// Returns the indices of the cells of a kind, ascending.
    pub(crate) fn all(&self, kind: CellKind) -> impl Iterator<Item = usize> + '_ {
        (0..self.len()).filter(move |&cell| self.kinds[cell] == kind)
    }
}

impl Content {
    /// Returns x and y of each vertex, in the order of the file.
    pub fn points(&self) -> &[[f64; 2]] {
        &self.points
    }

    /// Returns the id of each vertex in the file; in formats without ids, the position in the file's list.
    pub fn vertex_ids(&self) -> &[u64] {
        &self.vertex_ids
    }

    /// Lists the cells in the order of the file.
    pub fn cells(&self) -> impl Iterator<Item = Cell<'_>> {
        (0..self.cells.len()).map(|cell| Cell {
            kind: self.cells.kinds[cell],
            id: self.cells.ids[cell],
            vertices: self.cells.of(cell),
            content: self,
            set: self.cells.sets[cell],
        })
    }

    /// Lists the groups to which the file assigns single vertices, each with the indices of its vertices.
    pub fn vertex_groups(&self) -> impl Iterator<Item = (&ContentGroup, &[u32])> {
        self.vertex_groups.iter().map(|(group, vertices)| (group, &vertices[..]))
    }

    /// Returns whether a vertex is in two groups of vertices.
    pub(crate) fn has_vertex_in_several_groups(&self) -> bool {
        let mut is_in = vec![false; self.points.len()];
        self.vertex_groups.iter().any(|(_, vertices)| {
            let again = vertices.iter().any(|&vertex| is_in[vertex as usize]);
            vertices.iter().for_each(|&vertex| is_in[vertex as usize] = true);
            again
        })
    }

    /// Returns the data of vertices, without third coordinates, which [`z`](Self::z) returns.
    pub fn point_data(&self) -> &[DataArray] {
        &self.point_data
    }

    /// Returns the data of cells, with numbers in the order of [`cells`](Self::cells). Data that define groups are
    /// stored as groups instead.
    pub fn cell_data(&self) -> &[DataArray] {
        &self.cell_data
    }

    /// Returns short descriptions of file content that the mesh does not include.
    pub fn unsupported(&self) -> &[String] {
        &self.unsupported
    }

    /// Returns the third coordinate of a vertex, 0 if the file has none.
    pub fn z(&self, vertex: usize) -> f64 {
        self.z_values.get(vertex).copied().unwrap_or(self.common_z)
    }

    /// Returns the id of the first vertex; `None` unless the ids of all vertices are consecutive.
    pub(crate) fn first_vertex_id(&self) -> Option<u64> {
        let first = *self.vertex_ids.first()?;
        let follow =
            self.vertex_ids.iter().zip(first..).all(|(&label, expected)| label == expected);
        follow.then_some(first)
    }

    /// Returns each cell's first group with the given kind; `None` if the cell lacks one.
    pub(crate) fn column(&self, kind: &str) -> Vec<Option<u32>> {
        let of_set = |set: &Vec<u32>| {
            set.iter().copied().find(|&group| self.groups[group as usize].kind == kind)
        };
        let found: Vec<_> = self.sets.iter().map(of_set).collect();
        self.cells.sets.iter().map(|&set| found[set as usize]).collect()
    }

    /// Returns whether the groups of a kind hold the numbers of cell data, which define regions. Cells without a group have no number or
    /// the number 0.
    pub(super) fn has_groups_of(&self, kind: &str, data: &DataArray) -> bool {
        if self.groups.iter().all(|group| group.kind != kind) {
            return false;
        }
        let is_given = |value: &f64| !value.is_nan() && *value != 0.0;
        let given = data.values.chunks(data.components).map(|own| own.iter().any(is_given));
        self.column(kind).iter().zip(given).all(|(group, is_given)| group.is_some() || !is_given)
    }

    /// Lists the kinds of groups in a dimension, sorted by descending importance.
    pub(crate) fn group_kinds(&self, dimension: u8) -> Vec<&str> {
        // Kinds that programs number come last, in this order. Users name the groups of all other kinds.
        const LAST: [&str; 6] = ["reference", "block", "section", "family", "entity", "zone"];
        let is_number = |kind: &str| {
            let mut own = self.groups.iter().filter(|group| group.kind == kind);
            own.any(|group| matches!(group.label, GroupLabel::Tag(_)))
        };
        let last = |kind: &str| LAST.iter().position(|last| *last == kind && is_number(kind));
        let mut group_kinds: Vec<&str> = Vec::new();
        for group in self.groups.iter().filter(|group| group.dimension == dimension) {
            if !group_kinds.contains(&group.kind.as_str()) {
                group_kinds.push(&group.kind);
            }
        }
        // A user has named the cell data of the regions, or the mesh has no other regions.
        let is_of_regions = |kind: &str| self.region_kind.as_deref() == Some(kind);
        group_kinds.sort_by_key(|kind| match last(kind) {
            _ if is_of_regions(kind) => 0,
            None => 1,
            Some(at) => at + 2,
        });
        group_kinds
    }
}
