//! A mesh in memory with all that its file says of it, independent of any format.

use crate::content::label::Label;
use crate::visit::sink::Kind;

/// A mesh with its elements of all kinds, groups and data.
#[derive(Default)]
pub(crate) struct Content {
    /// x and y of each vertex.
    pub(crate) points: Vec<[f64; 2]>,
    /// The third coordinate of each vertex; empty if all are the same, which is then `height`.
    pub(crate) heights: Vec<f64>,
    pub(crate) height: f64,
    /// The file's number or tag of each vertex.
    pub(crate) labels: Vec<u64>,
    pub(crate) cells: Cells,
    pub(crate) groups: Vec<Group>,
    /// Sets of groups. Cells that belong to the same groups have the same index, in [`Cells::sets`].
    pub(crate) sets: Vec<Vec<u32>>,
    /// Groups of vertices, each with its vertices.
    pub(crate) vertex_groups: Vec<(Group, Vec<u32>)>,
    pub(crate) point_data: Vec<Data>,
    pub(crate) cell_data: Vec<Data>,
    /// Other things that the file has, in a few words each.
    pub(crate) left_out: Vec<String>,
}

/// Elements of all kinds in the order of the file.
#[derive(Default)]
pub(crate) struct Cells {
    /// The kind of each cell. [`Kind::Corner`] stands for a polygon of more than four corners.
    pub(crate) kinds: Vec<Kind>,
    /// The end of each cell's vertices in `vertices`.
    pub(crate) ends: Vec<usize>,
    pub(crate) vertices: Vec<u32>,
    /// The index of each cell's groups in [`Content::sets`].
    pub(crate) sets: Vec<u32>,
    /// The tag of each cell's element, by which cell data are given.
    pub(crate) tags: Vec<u64>,
}

/// A group of cells or vertices.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Group {
    /// The kind of group, such as `physical`. It is the same for formats that mean the same.
    pub(crate) what: String,
    pub(crate) dimension: u8,
    pub(crate) label: Label,
    pub(crate) name: Option<String>,
}

impl Group {
    /// Returns the group's name, if it has one.
    pub(crate) fn name(&self) -> Option<&str> {
        match (&self.name, &self.label) {
            (Some(name), _) | (None, Label::Name(name)) => Some(name),
            (None, Label::Tag(_)) => None,
        }
    }
}

/// Numbers for each vertex or cell.
pub(crate) struct Data {
    pub(crate) name: String,
    pub(crate) components: usize,
    /// Whether the values are real numbers, not whole ones.
    pub(crate) is_real: bool,
    /// `components` values for each vertex or cell, NaN if the file gives none.
    pub(crate) values: Vec<f64>,
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

    pub(crate) fn push(&mut self, kind: Kind, vertices: &[u32], set: u32, tag: u64) {
        self.kinds.push(kind);
        self.vertices.extend_from_slice(vertices);
        self.ends.push(self.vertices.len());
        self.sets.push(set);
        self.tags.push(tag);
    }

    /// Lists the cells of a kind, in the order of the file.
    pub(crate) fn all(&self, kind: Kind) -> impl Iterator<Item = usize> + '_ {
        (0..self.len()).filter(move |&cell| self.kinds[cell] == kind)
    }
}

impl Content {
    /// Returns the third coordinate of a vertex.
    pub(crate) fn z(&self, vertex: usize) -> f64 {
        self.heights.get(vertex).copied().unwrap_or(self.height)
    }

    /// Returns the number of the first vertex, if the vertices are numbered consecutively.
    pub(crate) fn first_label(&self) -> Option<u64> {
        let first = *self.labels.first()?;
        let follow = self.labels.iter().zip(first..).all(|(&label, expected)| label == expected);
        follow.then_some(first)
    }

    /// Returns for each cell its first group of this kind, if it has one.
    pub(crate) fn column(&self, what: &str) -> Vec<Option<u32>> {
        let of_set = |set: &Vec<u32>| {
            set.iter().copied().find(|&group| self.groups[group as usize].what == what)
        };
        let found: Vec<_> = self.sets.iter().map(of_set).collect();
        self.cells.sets.iter().map(|&set| found[set as usize]).collect()
    }

    /// Lists the kinds of groups of a dimension, the most important first.
    pub(crate) fn whats(&self, dimension: u8) -> Vec<&str> {
        // What users give names to comes before what programs number.
        const LAST: [&str; 6] = ["reference", "block", "section", "family", "entity", "zone"];
        let is_number = |what: &str| {
            let mut own = self.groups.iter().filter(|group| group.what == what);
            own.any(|group| matches!(group.label, Label::Tag(_)))
        };
        let last = |what: &str| LAST.iter().position(|last| *last == what && is_number(what));
        let mut whats: Vec<&str> = Vec::new();
        for group in self.groups.iter().filter(|group| group.dimension == dimension) {
            if !whats.contains(&group.what.as_str()) {
                whats.push(&group.what);
            }
        }
        whats.sort_by_key(|what| last(what).map_or(0, |at| at + 1));
        whats
    }
}
