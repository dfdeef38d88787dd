//! The regions of the elements of a file, collected while the elements are visited.

use crate::content::numbering::{JointNumbers, further_name, joint_numbers};
use crate::content::regions::Interner;

/// Regions of triangles and of quadrilaterals under construction.
#[derive(Default)]
pub(crate) struct ElementRegions {
    pub(crate) triangles: KindRegions,
    pub(crate) quadrilaterals: KindRegions,
}

/// Regions of elements of one kind, each with a name of two integers of the file.
#[derive(Default)]
pub(crate) struct KindRegions {
    names: Interner<[i64; 2]>,
    elements: usize,
    /// The number of each element's name; empty while all elements have the name 0, so that one region takes no memory.
    numbers: Vec<u32>,
}

/// Regions of all elements of a file, numbered from 0 by first occurrence, those of triangles first.
pub(crate) struct Regions {
    /// The region of each triangle; `None` if all triangles have region 0.
    pub(crate) triangles: Option<Vec<u32>>,
    /// The region of each quadrilateral.
    pub(crate) quadrilaterals: Vec<u32>,
    /// Whether an integer in the place of regions counts elements, and was left out.
    pub(crate) has_counter: bool,
}

impl KindRegions {
    /// Appends `count` elements with the name `region`.
    #[inline]
    pub(crate) fn push(&mut self, region: [i64; 2], count: usize) {
        let number = self.names.intern(region);
        if number != 0 {
            self.list();
        }
        if !self.numbers.is_empty() {
            (0..count).for_each(|_| self.numbers.push(number));
        }
        self.elements += count;
    }

    /// Adds a further integer of the file to the name of the last element.
    pub(crate) fn extend_last(&mut self, number: i64) {
        self.list();
        if let Some(last) = self.numbers.last_mut() {
            *last = self.names.intern(further_name(*last, number));
        }
    }

    /// Makes the list of numbers, if there is none.
    fn list(&mut self) {
        if self.numbers.is_empty() {
            self.numbers = vec![0; self.elements];
        }
    }
}

impl ElementRegions {
    /// Returns the regions of all elements. Elements of equal names have equal regions, whatever their kind.
    pub(crate) fn finish(self) -> Regions {
        let mut kinds = [self.triangles, self.quadrilaterals];
        let names = kinds.each_mut().map(|kind| std::mem::take(&mut kind.names).into_names());
        let elements = kinds.iter().map(|kind| kind.elements).sum();
        let JointNumbers { of_names, has_counter } =
            joint_numbers([&names[0], &names[1]], elements);
        let last = of_names.iter().flatten().copied().max().unwrap_or(0);
        if last == 0 {
            let quadrilaterals = vec![0; kinds[1].elements];
            return Regions { triangles: None, quadrilaterals, has_counter };
        }
        // A name that every element has extended is no region, and the other numbers close the gap.
        let mut regions = vec![None; last as usize + 1];
        let mut next = 0;
        for (kind, of_names) in kinds.iter_mut().zip(&of_names) {
            kind.list();
            for number in &mut kind.numbers {
                let region = &mut regions[of_names[*number as usize] as usize];
                *number = *region.get_or_insert_with(|| {
                    next += 1;
                    next - 1
                });
            }
        }
        let [triangles, quadrilaterals] = kinds.map(|kind| kind.numbers);
        let triangles = Some(triangles).filter(|all| all.iter().any(|&region| region != 0));
        Regions { triangles, quadrilaterals, has_counter }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the regions of elements whose names are the numbers. A tenth is a further number.
    fn regions(triangles: &[f64], quadrilaterals: &[f64]) -> (Option<Vec<u32>>, Vec<u32>) {
        let kind = |numbers: &[f64]| {
            let mut kind = KindRegions::default();
            for number in numbers {
                kind.push([*number as i64, 0], 1);
                if number.fract() != 0.0 {
                    kind.extend_last((10.0 * number.fract()) as i64);
                }
            }
            kind
        };
        let (triangles, quadrilaterals) = (kind(triangles), kind(quadrilaterals));
        let Regions { triangles, quadrilaterals, .. } =
            ElementRegions { triangles, quadrilaterals }.finish();
        (triangles, quadrilaterals)
    }

    #[test]
    fn regions_of_both_kinds_are_numbered_together() {
        assert_eq!(regions(&[7.0, 7.0], &[7.0]), (None, vec![0]));
        assert_eq!(regions(&[7.0, 8.0, 7.0], &[9.0, 8.0]), (Some(vec![0, 1, 0]), vec![2, 1]));
        assert_eq!(regions(&[7.0], &[8.0, 7.0]), (None, vec![1, 0]));
        assert_eq!(regions(&[], &[8.0, 7.0, 8.0]), (None, vec![0, 1, 0]));
    }

    #[test]
    fn further_numbers_make_regions_of_both_kinds() {
        assert_eq!(regions(&[7.0, 7.5, 8.5], &[7.5, 8.0]), (Some(vec![0, 1, 2]), vec![1, 3]));
        // All elements are in the same groups.
        assert_eq!(regions(&[7.5, 7.5], &[7.5]), (None, vec![0]));
    }

    #[test]
    fn one_region_takes_no_memory() {
        let mut kind = KindRegions::default();
        kind.push([7, 0], 1000);
        assert_eq!(kind.numbers.capacity(), 0);
    }
}
