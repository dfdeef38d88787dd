//! Selection of one group and number per element, for formats that store only one.

use super::content::{Content, ContentGroup};
use crate::content::group_label::GroupLabel;
use std::collections::{HashMap, HashSet};

/// Group numbers for a writer, and the group of each cell.
pub(crate) struct GroupNumbers {
    /// For each dimension, the most important group of each cell.
    columns: [Vec<Option<u32>>; 3],
    /// The number of each group; 0 only for a group with the tag 0.
    numbers: Vec<i64>,
}

impl GroupNumbers {
    /// Selects a group for each cell, and numbers all groups. `negative` permits negative numbers.
    pub(crate) fn new(content: &Content, negative: bool) -> GroupNumbers {
        let column = |dimension| match content.group_kinds(dimension).first() {
            Some(kind) => content.column(kind),
            None => Vec::new(),
        };
        let numbers = numbers(content.groups.iter(), negative);
        GroupNumbers { columns: [0, 1, 2].map(column), numbers }
    }

    /// Returns the most important group of a cell.
    pub(crate) fn group(&self, content: &Content, cell: usize) -> Option<u32> {
        let dimension = usize::from(content.cells.kinds[cell].dimension());
        self.columns[dimension].get(cell).copied().flatten()
    }

    /// Returns the number of the most important group of a cell, or 0.
    pub(crate) fn number_of_cell(&self, content: &Content, cell: usize) -> i64 {
        self.group(content, cell).map_or(0, |group| self.numbers[group as usize])
    }

    /// Returns the number of a group.
    pub(crate) fn number(&self, group: u32) -> i64 {
        self.numbers[group as usize]
    }
}

/// Returns a number for each group, unique within its kind and dimension. The number is the group's tag, if the tag
/// fits into 32 bits with a permitted sign, else a positive number unequal to every tag.
pub(crate) fn numbers<'g>(
    groups: impl Iterator<Item = &'g ContentGroup> + Clone,
    negative: bool,
) -> Vec<i64> {
    let is_fit = |tag: i64| !is_wide(tag) && (negative || tag >= 0);
    let mut taken: HashSet<(&str, u8, i64)> = HashSet::new();
    for group in groups.clone() {
        if let GroupLabel::Tag(tag) = group.label {
            taken.insert((&group.kind, group.dimension, tag));
        }
    }
    let mut next: HashMap<(&str, u8), i64> = HashMap::new();
    let number = |group: &'g ContentGroup| match group.label {
        GroupLabel::Tag(tag) if is_fit(tag) => tag,
        _ => {
            let (kind, dimension) = (&*group.kind, group.dimension);
            let next = next.entry((kind, dimension)).or_insert(1);
            while taken.contains(&(kind, dimension, *next)) {
                *next += 1;
            }
            *next += 1;
            *next - 1
        }
    };
    groups.map(number).collect()
}

/// Returns whether a number does not fit into 32 bits.
pub(crate) fn is_wide(tag: i64) -> bool {
    i32::try_from(tag).is_err()
}

/// Returns whether a group is a region of surfaces with the tag 0 beside regions with other tags of the same kind. A tag of 0
/// on all surfaces, or on lines and points, stands for no group.
pub(crate) fn is_region_zero(content: &Content, group: &ContentGroup) -> bool {
    let is_beside = |other: &ContentGroup| {
        other.kind == group.kind && other.dimension == 2 && other.tag() != Some(0)
    };
    group.dimension == 2 && group.tag() == Some(0) && content.groups.iter().any(is_beside)
}

/// Returns whether elements of the dimension with equal `main` groups have equal `other` groups, which have no names
/// besides those of the `main` groups. Leaving out `other` then loses only its numbers. The file stores all groups of
/// an element if `is_several`, and otherwise the first group of each kind.
pub(crate) fn determines(
    content: &Content,
    dimension: u8,
    main: &str,
    other: &str,
    is_several: bool,
) -> bool {
    let of = |set: u32, kind: &str| -> Vec<u32> {
        let all = content.sets[set as usize].iter().copied();
        let own = all.filter(|&group| content.groups[group as usize].kind == kind);
        let mut own: Vec<u32> = own.take(if is_several { usize::MAX } else { 1 }).collect();
        own.sort_unstable();
        own
    };
    let name = |group: u32| content.groups[group as usize].name();
    let cells = content.cells.kinds.iter().zip(&content.cells.sets);
    let own = cells.filter(|(kind, _)| kind.dimension() == dimension);
    let sets: HashSet<u32> = own.map(|(_, &set)| set).collect();
    let mut told: HashMap<Vec<u32>, Vec<u32>> = HashMap::new();
    sets.into_iter().all(|set| {
        let (main, other) = (of(set, main), of(set, other));
        let is_named_so = |own: &str| main.iter().any(|&group| name(group) == Some(own));
        other.iter().all(|&group| name(group).is_none_or(is_named_so))
            && *told.entry(main).or_insert_with(|| other.clone()) == other
    })
}
