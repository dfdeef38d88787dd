//! One number an element for formats that have no more.

use super::content::{Content, Group};
use crate::file::label::Label;
use std::collections::{HashMap, HashSet};

/// The group that matters most of each element, and a number for each group.
pub(crate) struct Tags {
    /// For each dimension the group of each cell that matters most.
    columns: [Vec<Option<u32>>; 3],
    /// The number of each group, none of which is zero but that of a group with this number.
    numbers: Vec<i64>,
}

impl Tags {
    /// `negative` says whether numbers may be negative.
    pub(crate) fn new(content: &Content, negative: bool) -> Tags {
        let column = |dimension| match content.whats(dimension).first() {
            Some(what) => content.column(what),
            None => Vec::new(),
        };
        Tags { columns: [0, 1, 2].map(column), numbers: numbers(&content.groups, negative) }
    }

    /// The group of a cell that matters most.
    pub(crate) fn group(&self, content: &Content, cell: usize) -> Option<u32> {
        let dimension = usize::from(content.cells.kinds[cell].dimension());
        self.columns[dimension].get(cell).copied().flatten()
    }

    /// The number of that group; zero if there is none.
    pub(crate) fn tag(&self, content: &Content, cell: usize) -> i64 {
        self.group(content, cell).map_or(0, |group| self.numbers[group as usize])
    }

    /// The number of a group.
    pub(crate) fn number(&self, group: u32) -> i64 {
        self.numbers[group as usize]
    }
}

/// A number for each group, different from those of others of the same kind and dimension: its own tag, or for a name one that
/// no tag has.
fn numbers(groups: &[Group], negative: bool) -> Vec<i64> {
    let is_fit = |tag: i64| i32::try_from(tag).is_ok_and(|tag| negative || tag >= 0);
    let mut taken: HashSet<(&str, u8, i64)> = HashSet::new();
    for group in groups {
        if let Label::Tag(tag) = group.label {
            taken.insert((&group.what, group.dimension, tag));
        }
    }
    let mut next: HashMap<(&str, u8), i64> = HashMap::new();
    let number = |group: &'_ Group| -> i64 {
        match group.label {
            Label::Tag(tag) if is_fit(tag) => tag,
            _ => {
                let (what, dimension) = (groups_what(groups, group), group.dimension);
                let next = next.entry((what, dimension)).or_insert(1);
                while taken.contains(&(what, dimension, *next)) {
                    *next += 1;
                }
                *next += 1;
                *next - 1
            }
        }
    };
    groups.iter().map(number).collect()
}

fn groups_what<'g>(groups: &'g [Group], group: &Group) -> &'g str {
    groups.iter().find(|own| own.what == group.what).map_or("", |own| &own.what)
}

/// Whether the group of one kind that an element of a dimension belongs to tells that of another kind, so that nothing is lost
/// with the other one but its number.
pub(crate) fn decides(content: &Content, dimension: u8, main: &str, other: &str) -> bool {
    let named = |group: &Group| group.dimension == dimension && group.name().is_some();
    if content.groups.iter().any(|group| group.what == other && named(group)) {
        return false;
    }
    let (main, other) = (content.column(main), content.column(other));
    let mut told: HashMap<Option<u32>, Option<u32>> = HashMap::new();
    let cells =
        (0..content.cells.len()).filter(|&cell| content.cells.kinds[cell].dimension() == dimension);
    cells.into_iter().all(|cell| *told.entry(main[cell]).or_insert(other[cell]) == other[cell])
}
