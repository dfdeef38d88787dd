//! Numbers and names of groups, by kind, dimension and label.

use crate::content::group_label::GroupLabel;
use std::collections::HashMap;

/// Map from kind, dimension and label of groups to their numbers, with the names of tags in the file. Groups are
/// numbered from 0 in the order of first occurrence.
#[derive(Default)]
pub(crate) struct GroupKeys {
    numbers: HashMap<(String, u8, GroupLabel), usize>,
    /// The names of groups, by kind, dimension (`None` for all) and tag.
    names: HashMap<(String, Option<u8>, i64), String>,
}

impl GroupKeys {
    /// Returns the 0-based number of a group, and whether this call added the group.
    pub(crate) fn number(
        &mut self,
        kind: &str,
        dimension: u8,
        label: &GroupLabel,
    ) -> (usize, bool) {
        let next = self.numbers.len();
        let key = (kind.to_owned(), dimension, label.clone());
        let number = *self.numbers.entry(key).or_insert(next);
        (number, number == next)
    }

    /// Sets the name of the groups with a tag in one dimension; `None` sets the name in all dimensions.
    pub(crate) fn set_name(&mut self, kind: &str, dimension: Option<u8>, tag: i64, name: String) {
        self.names.insert((kind.to_owned(), dimension, tag), name);
    }

    /// Returns whether a group has been numbered.
    pub(crate) fn contains(&self, kind: &str, dimension: u8, label: &GroupLabel) -> bool {
        self.numbers.contains_key(&(kind.to_owned(), dimension, label.clone()))
    }

    /// Lists kind, dimension, tag and name of each name for one dimension, in ascending order.
    pub(crate) fn names_of_dimensions(&self) -> Vec<(&str, u8, i64, &str)> {
        let of_one = self.names.iter().filter_map(|((kind, dimension, tag), name)| {
            Some((kind.as_str(), (*dimension)?, *tag, name.as_str()))
        });
        let mut all: Vec<_> = of_one.collect();
        all.sort_unstable();
        all
    }

    /// Returns the name that the file gives to the tag of a group; `None` for an unnamed tag, or a label that is a name
    /// itself. A name for the dimension takes precedence over a name for all dimensions.
    pub(crate) fn name_of(&self, kind: &str, dimension: u8, label: &GroupLabel) -> Option<String> {
        let &GroupLabel::Tag(tag) = label else { return None };
        let of = |dimension| self.names.get(&(kind.to_owned(), dimension, tag));
        of(Some(dimension)).or_else(|| of(None)).cloned()
    }
}
