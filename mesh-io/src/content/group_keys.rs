//! Groups by what tells them apart, with their numbers and names.

use crate::content::group_label::GroupLabel;
use std::collections::HashMap;

/// Numbers groups in the order in which they are first met, and knows the names that files give to tags.
#[derive(Default)]
pub(crate) struct GroupKeys {
    numbers: HashMap<(String, u8, GroupLabel), usize>,
    /// The names of groups, by kind, dimension (`None` for all) and tag.
    names: HashMap<(String, Option<u8>, i64), String>,
}

impl GroupKeys {
    /// Returns the number of a group, from 0 on, and whether it is new.
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

    /// Names the groups with a tag, of one dimension or of all.
    pub(crate) fn set_name(&mut self, kind: &str, dimension: Option<u8>, tag: i64, name: String) {
        self.names.insert((kind.to_owned(), dimension, tag), name);
    }

    /// Returns the name that the file gives to the tag of a group.
    pub(crate) fn name_of(&self, kind: &str, dimension: u8, label: &GroupLabel) -> Option<String> {
        let &GroupLabel::Tag(tag) = label else { return None };
        let of = |dimension| self.names.get(&(kind.to_owned(), dimension, tag));
        of(Some(dimension)).or_else(|| of(None)).cloned()
    }
}
