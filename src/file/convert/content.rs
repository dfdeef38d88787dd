//! A mesh in memory with all that its file says of it, in terms that no format has for itself.

use crate::file::label::Label;
use crate::file::sink::Kind;

/// A mesh with its elements of all kinds, groups and data.
#[derive(Default)]
pub(crate) struct Content {
    /// x and y of each vertex.
    pub(crate) points: Vec<[f64; 2]>,
    /// The third coordinate of each vertex; empty if all are the same, which is then `height`.
    pub(crate) heights: Vec<f64>,
    pub(crate) height: f64,
    /// The file's own number of each vertex.
    pub(crate) labels: Vec<u64>,
    pub(crate) cells: Cells,
    pub(crate) groups: Vec<Group>,
    /// The groups of cells: those of the same groups have the same number in [`Cells::sets`].
    pub(crate) sets: Vec<Vec<u32>>,
    /// Groups of vertices, each by its vertices.
    pub(crate) vertex_groups: Vec<(Group, Vec<u32>)>,
    pub(crate) point_data: Vec<Data>,
    pub(crate) cell_data: Vec<Data>,
    /// What the file has besides, a few words each.
    pub(crate) left_out: Vec<String>,
}

/// Elements of all kinds in the order of the file.
#[derive(Default)]
pub(crate) struct Cells {
    /// [`Kind::Corner`] stands for a polygon of more than four corners.
    pub(crate) kinds: Vec<Kind>,
    /// Where the vertices of each cell end in `vertices`.
    pub(crate) ends: Vec<usize>,
    pub(crate) vertices: Vec<u32>,
    /// For each cell its place in [`Content::sets`].
    pub(crate) sets: Vec<u32>,
    /// The file's own number of each cell, where cell data are by these.
    pub(crate) tags: Vec<u64>,
}

/// A group of cells or vertices.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Group {
    /// What the format calls such groups, made the same for formats that mean the same.
    pub(crate) what: String,
    pub(crate) dimension: u8,
    pub(crate) label: Label,
    pub(crate) name: Option<String>,
}

impl Group {
    /// What the group is called, if it has a name.
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
    /// Whether they are real numbers, not whole ones.
    pub(crate) is_real: bool,
    /// NaN for what the file gives none.
    pub(crate) values: Vec<f64>,
}

impl Cells {
    pub(crate) fn len(&self) -> usize {
        self.kinds.len()
    }

    /// The vertices of a cell.
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

    /// The cells of a kind, in their order.
    pub(crate) fn all(&self, kind: Kind) -> impl Iterator<Item = usize> + '_ {
        (0..self.len()).filter(move |&cell| self.kinds[cell] == kind)
    }
}

impl Content {
    /// The third coordinate of a vertex.
    pub(crate) fn z(&self, vertex: usize) -> f64 {
        self.heights.get(vertex).copied().unwrap_or(self.height)
    }

    /// The number of the first vertex, if the others follow it one by one.
    pub(crate) fn first_label(&self) -> Option<u64> {
        let first = *self.labels.first()?;
        let follow = self.labels.iter().zip(first..).all(|(&label, expected)| label == expected);
        follow.then_some(first)
    }

    /// The group of what is called so that each cell belongs to: the first of them if there are several.
    pub(crate) fn column(&self, what: &str) -> Vec<Option<u32>> {
        let of_set = |set: &Vec<u32>| {
            set.iter().copied().find(|&group| self.groups[group as usize].what == what)
        };
        let found: Vec<_> = self.sets.iter().map(of_set).collect();
        self.cells.sets.iter().map(|&set| found[set as usize]).collect()
    }

    /// What groups of a dimension are called, those first that matter most.
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
