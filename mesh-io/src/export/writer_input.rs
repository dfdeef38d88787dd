//! Input of the writers of formats.

use super::capabilities::Capabilities;
use super::content::{Content, ContentGroup, DataArray};
use super::group_numbers::{self, GroupNumbers};
use crate::visit::items::CellKind;

/// Mesh to be written in a format, with the format's capabilities and the group numbers.
pub(crate) struct WriterInput<'a> {
    pub(crate) content: &'a Content,
    /// The name of the program, for titles of files.
    pub(crate) creator: &'a str,
    pub(crate) capabilities: Capabilities,
    pub(crate) group_numbers: GroupNumbers,
    /// For each set of groups in [`Content::sets`], the groups that the format stores, most important first.
    stored_sets: Vec<Vec<u32>>,
    /// Ids of the vertices in the original file; `None` if an id is 0, which many formats cannot store.
    numbers: Option<&'a [u64]>,
}

impl<'a> WriterInput<'a> {
    pub(crate) fn new(
        content: &'a Content,
        holds: Capabilities,
        creator: &'a str,
    ) -> WriterInput<'a> {
        let numbers = (!content.vertex_ids.contains(&0)).then_some(content.vertex_ids.as_slice());
        let kinds = [0, 1, 2].map(|dimension| holds.stored_kinds(content, dimension));
        let rank = |&group: &u32| {
            let group = &content.groups[group as usize];
            kinds[usize::from(group.dimension)].iter().position(|kind| *kind == group.kind)
        };
        let stored = |set: &Vec<u32>| {
            let mut groups: Vec<u32> =
                set.iter().copied().filter(|group| rank(group).is_some()).collect();
            groups.sort_by_key(rank);
            groups
        };
        WriterInput {
            stored_sets: content.sets.iter().map(stored).collect(),
            content,
            creator,
            capabilities: holds,
            group_numbers: GroupNumbers::new(content, holds.allows_negative_numbers),
            numbers,
        }
    }

    /// Numbers the vertices by their positions, counted from 1.
    pub(crate) fn renumbered(self) -> WriterInput<'a> {
        WriterInput { numbers: None, ..self }
    }

    /// Lists the cells that the format holds, in the order of the file.
    pub(crate) fn cells(&self) -> impl Iterator<Item = usize> + '_ {
        let content = self.content;
        (0..content.cells.len())
            .filter(|&cell| self.capabilities.supports_cell(content, &self.group_numbers, cell))
    }

    /// Lists the cells of a kind that the format holds.
    pub(crate) fn all(&self, kind: CellKind) -> impl Iterator<Item = usize> + '_ {
        self.cells().filter(move |&cell| self.content.cells.kinds[cell] == kind)
    }

    pub(crate) fn count(&self, kind: CellKind) -> usize {
        self.all(kind).count()
    }

    /// Returns the id of a vertex in the file that was read. If some vertex has the id 0, returns the position of the
    /// vertex, counted from 1.
    pub(crate) fn vertex_id(&self, vertex: usize) -> u64 {
        self.numbers.map_or(vertex as u64 + 1, |numbers| numbers[vertex])
    }

    /// Returns the [ids](Self::vertex_id) of the vertices of a cell, separated by blanks.
    pub(crate) fn vertex_ids(&self, cell: usize) -> String {
        self.joined(cell, |vertex| self.vertex_id(vertex))
    }

    /// Returns the positions of the vertices of a cell, counted from `first` and separated by blanks.
    pub(crate) fn positions(&self, cell: usize, first: u64) -> String {
        self.joined(cell, |vertex| vertex as u64 + first)
    }

    fn joined(&self, cell: usize, number: impl Fn(usize) -> u64) -> String {
        let vertices = self.content.cells.of(cell).iter();
        let numbers: Vec<String> = vertices.map(|&v| number(v as usize).to_string()).collect();
        numbers.join(" ")
    }

    /// Returns x and y of a vertex as text.
    pub(crate) fn xy(&self, vertex: usize) -> String {
        let [x, y] = self.content.points[vertex];
        format!("{x:?} {y:?}")
    }

    /// Returns x, y and z of a vertex as text.
    pub(crate) fn xyz(&self, vertex: usize) -> String {
        format!("{} {:?}", self.xy(vertex), self.content.z(vertex))
    }

    /// Returns the number of the most important group of a cell, or 0.
    pub(crate) fn group_number(&self, cell: usize) -> i64 {
        self.group_numbers.number_of_cell(self.content, cell)
    }

    /// Returns the most important group of a cell.
    pub(crate) fn group(&self, cell: usize) -> Option<&'a ContentGroup> {
        let group = self.group_numbers.group(self.content, cell)?;
        Some(&self.content.groups[group as usize])
    }

    /// Returns the groups of a cell that the format stores, most important first.
    pub(crate) fn stored_groups(&self, cell: usize) -> &[u32] {
        &self.stored_sets[self.content.cells.sets[cell] as usize]
    }

    /// Returns the name of a group; for unnamed groups, the group number as text.
    pub(crate) fn name_or_number(&self, group: u32) -> String {
        let name = self.content.groups[group as usize].name().map(str::to_owned);
        name.unwrap_or_else(|| self.group_numbers.number(group).to_string())
    }

    /// Returns whether all vertices have z = 0, so that a file can have two axes.
    pub(crate) fn is_flat(&self) -> bool {
        (0..self.content.points.len()).all(|vertex| self.content.z(vertex) == 0.0)
    }

    /// Returns a coordinate of every vertex; axis 2 is z.
    pub(crate) fn axis(&self, axis: usize) -> impl Iterator<Item = f64> + '_ {
        let content = self.content;
        (0..content.points.len()).map(move |vertex| match axis {
            2 => content.z(vertex),
            _ => content.points[vertex][axis],
        })
    }

    /// Returns the number of the first vertex group of each vertex; 0 for vertices without groups.
    pub(crate) fn vertex_group_numbers(&self) -> Vec<i64> {
        let groups = &self.content.vertex_groups;
        let numbers = group_numbers::numbers(groups.iter().map(|(group, _)| group), true);
        let mut of_vertices = vec![0; self.content.points.len()];
        for ((_, vertices), number) in groups.iter().zip(numbers).rev() {
            vertices.iter().for_each(|&vertex| of_vertices[vertex as usize] = number);
        }
        of_vertices
    }

    /// Lists the data of vertices that the format holds.
    pub(crate) fn point_data(&self) -> impl Iterator<Item = &'a DataArray> + '_ {
        self.content.point_data.iter().filter(|data| self.capabilities.point_data.supports(data))
    }

    /// Lists the data of elements that the format holds.
    pub(crate) fn cell_data(&self) -> impl Iterator<Item = &'a DataArray> + '_ {
        self.content.cell_data.iter().filter(|data| self.capabilities.cell_data.supports(data))
    }
}

/// Formats a value of some data, without a fraction if the data are whole numbers.
pub(crate) fn text_of(data: &DataArray, value: f64) -> String {
    match data.is_real {
        true => format!("{value:?}"),
        false => format!("{}", value as i64),
    }
}
