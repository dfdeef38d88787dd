//! Numbers that count the triangles of a file and identify no regions.
//!
//! WAVEWATCH III writes the number of each triangle in the place of gmsh's entity, and preprocessors number the property
//! of each element of Nastran. If such numbers were regions, every vertex would be between regions.

use crate::content::regions::Interner;
use std::collections::HashSet;

/// Least number of triangles whose numbers are compared. The numbers of fewer triangles always denote regions, as coarse
/// examples may have a material for each triangle.
const MIN_TRIANGLES: usize = 16;

/// Returns whether `part` is nearly all of `whole`: more than three of four.
pub(crate) fn is_nearly_all(part: usize, whole: usize) -> bool {
    4 * part > 3 * whole
}

/// Returns whether numbers count triangles. `numbers` is the number of different ones, `triangles` the number of all
/// triangles. Numbers of fewer than 16 triangles count none.
pub(crate) fn counts_triangles(numbers: usize, triangles: usize) -> bool {
    triangles >= MIN_TRIANGLES && is_nearly_all(numbers, triangles)
}

/// First integers of region names below this bound refer to an earlier region; see [`further_name`].
const EARLIER_END: i64 = i64::MIN + (1 << 32);

/// Returns the name of the region of a triangle that has a region already, `before`, and a further number. No file has
/// numbers near the least integer.
pub(crate) fn further_name(before: u32, number: i64) -> [i64; 2] {
    [i64::MIN + i64::from(before), number]
}

/// Returns the region to which the name of [`further_name`] adds a number; `None` for two integers of the file.
pub(crate) fn earlier(name: [i64; 2]) -> Option<u32> {
    (name[0] < EARLIER_END).then(|| (name[0] - i64::MIN) as u32)
}

/// Joins regions of triangles that differ by numbers alone that count triangles. `names` are the names of the regions in
/// the order of their numbers: two integers of the file, or a name of [`further_name`]. Returns the regions of the
/// triangles, numbered from 0 in the order of `names`; `None` if neither integer counts triangles.
pub(crate) fn joined_regions(regions: &[u32], names: &[[i64; 2]]) -> Option<Vec<u32>> {
    if !counts_triangles(names.len(), regions.len()) {
        return None;
    }
    let is_further = |name: &[i64; 2]| earlier(*name).is_some();
    let is_counter = [0, 1].map(|place| {
        // A further number is a second number of the first kind.
        let own = |name: &[i64; 2]| match is_further(name) {
            true => (place == 0).then_some(name[1]),
            false => Some(name[place]),
        };
        let numbers: HashSet<i64> = names.iter().filter_map(own).collect();
        counts_triangles(numbers.len(), regions.len())
    });
    if is_counter == [false; 2] {
        return None;
    }
    let mut joined = Interner::default();
    let mut numbers: Vec<u32> = Vec::with_capacity(names.len());
    for name in names {
        numbers.push(if is_further(name) {
            let before = numbers[(name[0] - i64::MIN) as usize];
            if is_counter[0] { before } else { joined.intern(further_name(before, name[1])) }
        } else {
            joined.intern([0, 1].map(|place| if is_counter[place] { 0 } else { name[place] }))
        });
    }
    Some(regions.iter().map(|&region| numbers[region as usize]).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_nearly_every_triangle_count_triangles() {
        assert!(counts_triangles(16, 16) && counts_triangles(76, 100));
        assert!(!counts_triangles(15, 15) && !counts_triangles(75, 100));
    }

    #[test]
    fn regions_that_differ_by_a_counter_alone_are_joined() {
        let regions: Vec<u32> = (0..20).collect();
        let of = |name: &dyn Fn(i64) -> [i64; 2]| {
            let names: Vec<[i64; 2]> = (0..20).map(name).collect();
            joined_regions(&regions, &names)
        };
        let halves: Vec<u32> = (0..20).map(|t| t / 10).collect();
        assert_eq!(of(&|t| [t / 10, t]), Some(halves.clone()));
        assert_eq!(of(&|t| [t, t / 10]), Some(halves));
        assert_eq!(of(&|t| [t, t]), Some(vec![0; 20]));
        assert_eq!(of(&|t| [t / 5, t % 5]), None, "four numbers and five numbers");
        // Triangle 0 has a further number of the first kind, which is the region 1.
        let names =
            [&[[1, 0], further_name(0, 2)][..], &(1..20).map(|t| [1, t]).collect::<Vec<_>>()];
        let regions: Vec<u32> = (1..21).collect();
        let expected: Vec<u32> = [1].into_iter().chain([0; 19]).collect();
        assert_eq!(joined_regions(&regions, &names.concat()), Some(expected));
    }
}
