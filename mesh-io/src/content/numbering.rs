//! Numbers that count the elements of a file and identify no regions.
//!
//! WAVEWATCH III writes the number of each triangle in the place of gmsh's entity, and preprocessors number the property
//! of each element of Nastran. If such numbers were regions, every vertex would be between regions.

use crate::content::regions::Interner;
use std::collections::HashSet;

/// Least number of elements whose numbers are compared. The numbers of fewer elements always denote regions, as coarse
/// examples may have a material for each element.
const MIN_ELEMENTS: usize = 16;

/// Returns whether `part` is nearly all of `whole`: more than three of four.
pub(crate) fn is_nearly_all(part: usize, whole: usize) -> bool {
    4 * part > 3 * whole
}

/// Different numbers of triangles and of quadrilaterals.
#[derive(Clone, Copy, Default)]
pub(crate) struct Different {
    /// How many numbers triangles have, and how many quadrilaterals have.
    of_kind: [usize; 2],
    /// How many numbers elements of both kinds have.
    of_both: usize,
}

impl Different {
    /// Adds a number that triangles have, or quadrilaterals, or both.
    pub(crate) fn add(&mut self, [triangles, quadrilaterals]: [bool; 2]) {
        self.of_kind[0] += usize::from(triangles);
        self.of_kind[1] += usize::from(quadrilaterals);
        self.of_both += usize::from(triangles && quadrilaterals);
    }

    /// Returns how many numbers there are. Programs may count each kind of elements from 1, so if there are many of each kind, a
    /// number that elements of both kinds have counts twice.
    pub(crate) fn count(&self) -> usize {
        let count = self.of_kind.iter().sum::<usize>();
        match self.of_kind.iter().all(|&count| count >= MIN_ELEMENTS) {
            true => count,
            false => count - self.of_both,
        }
    }
}

/// Returns whether numbers count elements: `numbers` different ones of `elements` triangles and quadrilaterals. Numbers of fewer
/// than 16 elements count none.
pub(crate) fn counts_elements(numbers: usize, elements: usize) -> bool {
    elements >= MIN_ELEMENTS && is_nearly_all(numbers, elements)
}

/// First integers of region names below this bound refer to an earlier region; see [`further_name`].
const EARLIER_END: i64 = i64::MIN + (1 << 32);

/// Returns the name of the region of an element that has a region already, `before`, and a further number. No file has
/// numbers near the least integer.
pub(crate) fn further_name(before: u32, number: i64) -> [i64; 2] {
    [i64::MIN + i64::from(before), number]
}

/// Returns the region to which the name of [`further_name`] adds a number; `None` for two integers of the file.
pub(crate) fn earlier(name: [i64; 2]) -> Option<u32> {
    (name[0] < EARLIER_END).then(|| (name[0] - i64::MIN) as u32)
}

/// Numbers of the regions of triangles and of quadrilaterals.
pub(crate) struct JointNumbers {
    /// For the names of triangles and for those of quadrilaterals, the number of each name. Equal names have equal numbers.
    pub(crate) of_names: [Vec<u32>; 2],
    /// Whether an integer of the names counts elements, and was left out of them.
    pub(crate) has_counter: bool,
}

/// Numbers the names of regions from 0 by first occurrence, those of triangles first. An integer of the names that counts
/// elements is left out. `names` are the names of the regions of triangles and those of quadrilaterals: two integers of
/// the file, or a name of [`further_name`], which refers to an earlier name of the same kind of elements. `elements` is the
/// number of elements.
pub(crate) fn joint_numbers(names: [&[[i64; 2]]; 2], elements: usize) -> JointNumbers {
    let is_counter = counters(names, elements);
    let mut joint = Interner::default();
    let of_names = names.map(|names| {
        let mut numbers: Vec<u32> = Vec::with_capacity(names.len());
        for &name in names {
            let before = earlier(name).map(|before| numbers[before as usize]);
            numbers.push(match before {
                Some(before) if is_counter[0] => before,
                Some(before) => joint.intern(further_name(before, name[1])),
                None => joint
                    .intern([0, 1].map(|place| if is_counter[place] { 0 } else { name[place] })),
            });
        }
        numbers
    });
    JointNumbers { of_names, has_counter: is_counter != [false; 2] }
}

/// Returns for each of the two integers of names whether it counts elements.
fn counters(names: [&[[i64; 2]]; 2], elements: usize) -> [bool; 2] {
    if !counts_elements(names.iter().map(|names| names.len()).sum(), elements) {
        return [false; 2];
    }
    [0, 1].map(|place| {
        // A further number is a second number of the first kind.
        let own = |name: &[i64; 2]| match earlier(*name) {
            Some(_) => (place == 0).then_some(name[1]),
            None => Some(name[place]),
        };
        let [triangles, others] =
            names.map(|names| names.iter().filter_map(own).collect::<HashSet<i64>>());
        let mut different = Different::default();
        for number in triangles.union(&others) {
            different.add([triangles.contains(number), others.contains(number)]);
        }
        counts_elements(different.count(), elements)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_nearly_every_element_count_elements() {
        assert!(counts_elements(16, 16) && counts_elements(76, 100));
        assert!(!counts_elements(15, 15) && !counts_elements(75, 100));
    }

    fn names(count: i64, name: impl Fn(i64) -> [i64; 2]) -> Vec<[i64; 2]> {
        (0..count).map(name).collect()
    }

    /// Returns the numbers of the names of elements, the last `quadrilaterals` of which are quadrilaterals; `None` if no integer
    /// counts elements.
    fn joined(names: &[[i64; 2]], quadrilaterals: usize) -> Option<Vec<u32>> {
        let (triangles, others) = names.split_at(names.len() - quadrilaterals);
        let JointNumbers { of_names, has_counter } =
            joint_numbers([triangles, others], names.len());
        has_counter.then(|| of_names.concat())
    }

    #[test]
    fn regions_that_differ_by_a_counter_alone_are_joined() {
        let halves: Vec<u32> = (0..20).map(|t| t / 10).collect();
        for quadrilaterals in [0, 5, 14, 20] {
            let of = |name: fn(i64) -> [i64; 2]| joined(&names(20, name), quadrilaterals);
            assert_eq!(of(|t| [t / 10, t]), Some(halves.clone()));
            assert_eq!(of(|t| [t, t / 10]), Some(halves.clone()));
            assert_eq!(of(|t| [t, t]), Some(vec![0; 20]));
            assert_eq!(of(|t| [t / 5, t % 5]), None, "four numbers and five numbers");
        }
        let of_each_kind = joined(&names(40, |t| [t / 20, t % 20]), 20);
        let halves = (0..40).map(|t| t / 20).collect();
        assert_eq!(of_each_kind, Some(halves), "each kind is counted from 0");
        let materials = joined(&names(20, |t| [t / 10, t % 10]), 10);
        assert_eq!(materials, None, "10 numbers that both kinds have");
        // Triangle 0 has a further number of the first kind, which is the region 1.
        let names = [&[[1, 0], further_name(0, 2)][..], &names(20, |t| [1, t])[1..]].concat();
        assert_eq!(joined(&names, 0), Some([&[0, 1][..], &[0; 19]].concat()));
    }

    #[test]
    fn equal_names_of_triangles_and_quadrilaterals_have_equal_numbers() {
        let triangles = [[7, 1], [8, 1], further_name(1, 7)];
        let quadrilaterals = [[9, 1], [8, 1], further_name(1, 7), further_name(0, 7)];
        let JointNumbers { of_names, .. } = joint_numbers([&triangles, &quadrilaterals], 9);
        assert_eq!(of_names, [vec![0, 1, 2], vec![3, 1, 2, 4]]);
    }
}
