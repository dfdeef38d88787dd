//! Removes groups whose numbers count elements from a content.

use super::content::{Content, ContentGroup};
use crate::content::numbering::{Different, counts_elements};
use crate::visit::items::CellKind;
use std::collections::{HashMap, HashSet};

/// Kinds of elements that numbers may count.
const KINDS: [CellKind; 2] = [CellKind::Triangle, CellKind::Quadrilateral];

impl Content {
    /// Removes the unnamed groups of surfaces of each kind whose numbers count elements. Returns the kinds.
    pub(crate) fn remove_counters(&mut self) -> HashSet<String> {
        let elements = self.cells.kinds.iter().filter(|kind| KINDS.contains(kind)).count();
        // Each group has at most a number of triangles and a number of quadrilaterals.
        if !counts_elements(KINDS.len() * self.groups.len(), elements) {
            return HashSet::new();
        }
        let kinds = self.counting_kinds(elements);
        let is_counter =
            |group: &ContentGroup| is_numbered(group) && kinds.contains(group.kind.as_str());
        let (mut left, mut numbers) = (Vec::new(), Vec::with_capacity(self.groups.len()));
        for group in &self.groups {
            numbers.push((!is_counter(group)).then_some(left.len() as u32));
            if !is_counter(group) {
                left.push(group.clone());
            }
        }
        // Sets that differed by removed groups alone become one set, as writers make a block of elements for each set.
        let (mut sets, mut known) = (Vec::new(), HashMap::new());
        let renumbered = self.sets.iter().map(|set| {
            let set: Vec<u32> = set.iter().filter_map(|&group| numbers[group as usize]).collect();
            *known.entry(set.clone()).or_insert_with(|| {
                sets.push(set);
                sets.len() as u32 - 1
            })
        });
        let renumbered: Vec<u32> = renumbered.collect();
        self.cells.sets.iter_mut().for_each(|set| *set = renumbered[*set as usize]);
        (self.groups, self.sets) = (left, sets);
        kinds
    }

    /// Returns the kinds of groups whose numbers count elements.
    fn counting_kinds(&self, elements: usize) -> HashSet<String> {
        let mut has_elements = vec![[false; 2]; self.groups.len()];
        for (kind, &set) in self.cells.kinds.iter().zip(&self.cells.sets) {
            if let Some(place) = KINDS.iter().position(|own| own == kind) {
                let own = self.sets[set as usize].iter();
                own.for_each(|&group| has_elements[group as usize][place] = true);
            }
        }
        let mut numbers: HashMap<&str, Different> = HashMap::new();
        let numbered = self.groups.iter().zip(has_elements).filter(|(group, _)| is_numbered(group));
        for (group, has_elements) in numbered {
            numbers.entry(&group.kind).or_default().add(has_elements);
        }
        numbers.retain(|_, different| counts_elements(different.count(), elements));
        numbers.into_keys().map(str::to_owned).collect()
    }
}

/// Returns whether a number alone identifies a group of surfaces.
fn is_numbered(group: &ContentGroup) -> bool {
    let is_number = group.name().is_none_or(|name| name.parse::<f64>().is_ok());
    group.dimension == 2 && is_number
}
