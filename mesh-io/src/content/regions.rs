//! Regions of elements, and the vertices at which regions meet.
//!
//! Formats identify the region of an element by tags, groups or attributes. An [`Interner`] numbers the identifiers of
//! any format.

use std::collections::HashMap;
use std::hash::Hash;

/// Numbers distinct values by first occurrence, counted from 0.
#[derive(Default)]
pub(crate) struct Interner<N> {
    numbers: HashMap<N, u32>,
    /// The last value and its number. Most values equal their predecessor and need no lookup in the map.
    last: Option<(N, u32)>,
}

impl<N: Clone + Eq + Hash> Interner<N> {
    #[inline]
    pub(crate) fn intern(&mut self, name: N) -> u32 {
        match &self.last {
            Some((last, number)) if *last == name => *number,
            _ => self.look_up(name),
        }
    }

    /// Returns the values in the order of their numbers.
    pub(crate) fn into_names(self) -> Vec<N> {
        let mut names: Vec<(u32, N)> = self.numbers.into_iter().map(|(n, i)| (i, n)).collect();
        names.sort_unstable_by_key(|&(number, _)| number);
        names.into_iter().map(|(_, name)| name).collect()
    }

    fn look_up(&mut self, name: N) -> u32 {
        // There are at most as many values as elements, fewer than 2^32.
        let next = self.numbers.len() as u32;
        let number = *self.numbers.entry(name.clone()).or_insert(next);
        self.last = Some((name, number));
        number
    }
}

/// Returns the interior vertices at which elements of different regions meet, and the edges between such elements, both
/// ascending. `elements` are lists of vertices in order around an element, each below `vertices`, with the region of the
/// element. Boundary vertices are left out.
///
/// # Panics
/// Panics if an element has a vertex that is not below `vertices`.
pub fn interfaces<'e, R: Copy + Ord>(
    elements: impl Iterator<Item = (&'e [u32], R)> + Clone,
    vertices: usize,
) -> (Vec<u32>, Vec<[u32; 2]>) {
    let mut region = vec![None; vertices];
    let mut is_between = vec![false; vertices];
    // Exclusive or of the neighbors over all elements of a vertex; 0 inside the mesh, as each neighbor occurs twice.
    let mut neighbors = vec![0; vertices];
    for (corners, own) in elements.clone() {
        let count = corners.len();
        for (k, &v) in corners.iter().enumerate() {
            is_between[v as usize] |= *region[v as usize].get_or_insert(own) != own;
            neighbors[v as usize] ^= corners[(k + 1) % count] ^ corners[(k + count - 1) % count];
        }
    }
    let mut sides = Vec::new();
    for (corners, own) in elements {
        let next = corners.iter().cycle().skip(1);
        let ends = corners.iter().zip(next).map(|(&a, &b)| [a.min(b), a.max(b)]);
        let between = ends.filter(|ends| ends.iter().all(|&v| is_between[v as usize]));
        sides.extend(between.map(|ends| (ends, own)));
    }
    sides.sort_unstable();
    sides.dedup();
    let twice = sides.windows(2).filter(|pair| pair[0].0 == pair[1].0);
    let mut edges: Vec<[u32; 2]> = twice.map(|pair| pair[0].0).collect();
    edges.dedup();
    let inside = (0..vertices).filter(|&v| is_between[v] && neighbors[v] == 0);
    (inside.map(|v| v as u32).collect(), edges)
}

/// Returns the interior vertices at which triangles of different regions meet, ascending. Boundary vertices are left
/// out. `regions` has the region of each triangle; a shorter list leaves further triangles out. `triangles` have vertices
/// below `vertices`, zero-based.
///
/// # Panics
/// Panics if a triangle has a vertex that is not below `vertices`.
pub fn interface_vertices<R: Copy + PartialEq>(
    regions: &[R],
    triangles: &[[u32; 3]],
    vertices: usize,
) -> Vec<u32> {
    #[derive(Clone, Copy)]
    struct Vertex<R> {
        /// The region of the vertex's first triangle.
        region: Option<R>,
        is_between: bool,
        /// Exclusive or of the neighbor indices over all triangles of the vertex. Each neighbor of an interior vertex
        /// occurs in two triangles, and the result is 0. On the boundary, the two end vertices of the fan occur once
        /// and differ.
        neighbors: u32,
    }
    let mut all = vec![Vertex { region: None, is_between: false, neighbors: 0 }; vertices];
    for (&[a, b, c], &region) in triangles.iter().zip(regions) {
        for [v, next, last] in [[a, b, c], [b, c, a], [c, a, b]] {
            let vertex = &mut all[v as usize];
            vertex.is_between |= *vertex.region.get_or_insert(region) != region;
            vertex.neighbors ^= next ^ last;
        }
    }
    let held = |(_, vertex): &(u32, Vertex<R>)| vertex.is_between && vertex.neighbors == 0;
    (0..).zip(all).filter(held).map(|(v, _)| v).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_numbered_as_they_come() {
        let mut numbering = Interner::default();
        let numbers = [7, 7, -1, 7, 3, -1, 3].map(|name| numbering.intern(name));
        assert_eq!(numbers, [0, 0, 1, 0, 2, 1, 2]);
    }

    /// Two squares side by side, each with a vertex in its middle, and a vertex in the middle of their common edge.
    #[test]
    fn only_vertices_inside_the_mesh_are_between_regions() {
        let triangles = [
            [0, 1, 6],
            [1, 8, 6],
            [8, 4, 6],
            [4, 5, 6],
            [5, 0, 6],
            [1, 2, 7],
            [2, 3, 7],
            [3, 4, 7],
            [4, 8, 7],
            [8, 1, 7],
        ];
        let regions = [0, 0, 0, 0, 0, 1, 1, 1, 1, 1];
        let between = |regions: &[u32]| interface_vertices(regions, &triangles, 9);
        // Vertices 1 and 4 are on the boundary.
        assert_eq!(between(&regions), [8]);
        assert_eq!(between(&[3; 10]), [0; 0]);
        let all_different: Vec<u32> = (0..10).collect();
        assert_eq!(between(&all_different), [6, 7, 8]);
    }
}
