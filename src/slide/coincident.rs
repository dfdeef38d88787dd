//! Vertices at the same place: those of both sides of a crack, or of two parts that touch.

/// Vertices of curves that have the same position as another vertex.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Coincident {
    /// Two vertices without a third one at their place.
    pub(crate) pairs: Vec<[u32; 2]>,
    /// Vertices at the places of three or more vertices.
    pub(crate) crowded: Vec<u32>,
}

impl Coincident {
    /// Finds the vertices of curves at the place of another vertex of a curve, or of a vertex in `held`. Both lists are
    /// ascending, and may have repeats. Coordinates must be equal; 0 and -0 are equal.
    pub(crate) fn of(points: &[[f64; 2]], on_curves: &[u32], held: &[u32]) -> Self {
        // A sum with zero turns -0 into 0.
        let place = |v: u32| points[v as usize].map(|x| (x + 0.0).to_bits());
        let mut all: Vec<([u64; 2], u32)> = on_curves.iter().map(|&v| (place(v), v)).collect();
        all.sort_unstable();
        let is_on_curves = |&(place, _): &([u64; 2], u32)| {
            let at = all.partition_point(|&(other, _)| other < place);
            all.get(at).is_some_and(|&(other, _)| other == place)
        };
        let near: Vec<_> = held.iter().map(|&v| (place(v), v)).filter(is_on_curves).collect();
        all.extend(near);
        all.sort_unstable();
        all.dedup();
        let mut found = Self::default();
        for group in all.chunk_by(|a, b| a.0 == b.0) {
            match group {
                [_] => {}
                &[(_, a), (_, b)] => found.pairs.push([a, b]),
                _ => found.crowded.extend(group.iter().map(|&(_, v)| v)),
            }
        }
        found
    }

    /// Returns the number of vertices whose coordinates equal those of another vertex.
    pub(crate) fn count(&self) -> usize {
        2 * self.pairs.len() + self.crowded.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_and_larger_groups_are_found_by_equal_coordinates() {
        let (zero, place) = ([-0.0, 1.0], [2.0, 3.0]);
        let points =
            [[0.0, 1.0], place, place, zero, [2.0, 3.0 + 1e-15], place, [5.0; 2], [5.0; 2]];
        let found = Coincident::of(&points, &[0, 0, 1, 2, 3, 4, 6], &[3, 5, 7]);
        assert_eq!(found.crowded, [1, 2, 5]);
        assert_eq!(found.pairs, [[0, 3], [6, 7]]);
        assert_eq!(found.count(), 7);
        // Two vertices away from curves are of no interest.
        assert_eq!(Coincident::of(&points, &[4], &[6, 7]), Coincident::default());
    }
}
