//! The boundary of a mesh: its edges, and the loops they make.

use crate::topology::Topology;
use crate::topology::stars::others_at_edge;

/// An edge of a triangle: from the vertex at this corner of it to the next one.
#[derive(Clone, Copy)]
struct Side {
    triangle: u32,
    corner: usize,
}

impl Topology<'_> {
    /// The edges of one triangle only, each from and to a vertex, with the mesh on its left. In no particular
    /// order.
    pub fn boundary_edges(&self) -> Vec<[u32; 2]> {
        self.boundary_sides().map(|side| self.ends(side)).collect()
    }

    fn boundary_sides(&self) -> impl Iterator<Item = Side> + '_ {
        let sides = |triangle| (0..3).map(move |corner| Side { triangle, corner });
        let all = (0..self.triangles().len() as u32).flat_map(sides);
        all.filter(|&side| self.across(side).is_none())
    }

    /// Where an edge starts and where it ends, with its triangle on the left.
    fn ends(&self, Side { triangle, corner }: Side) -> [u32; 2] {
        let corners = self.triangles()[triangle as usize];
        [corners[corner], corners[(corner + 1) % 3]]
    }

    /// The triangle across an edge.
    fn across(&self, side: Side) -> Option<u32> {
        others_at_edge(self.triangles(), self.stars(), side.triangle, self.ends(side)).next()
    }

    /// The boundary as closed loops of vertices, the last joined to the first, with the mesh on the left:
    /// around the outside counter-clockwise, around a hole clockwise, so that the sign of a loop's
    /// area, [`signed_area`], tells them apart. No loop passes a vertex twice; where parts or holes touch in a vertex, each has its
    /// own loop. A loop starts at its least vertex, and loops are in the order of these.
    pub fn boundary_loops(&self) -> Vec<Vec<u32>> {
        let mut edges: Vec<([u32; 2], Side)> =
            self.boundary_sides().map(|side| (self.ends(side), side)).collect();
        edges.sort_unstable_by_key(|&(ends, _)| ends);
        let mut loops = Vec::new();
        let mut left = vec![true; edges.len()];
        // Where each vertex stands in the path, if it does.
        let mut place = vec![None; self.free().len()];
        for first in 0..edges.len() {
            let mut at = Some(first).filter(|&edge| left[edge]);
            let mut path: Vec<u32> = Vec::new();
            while let Some(edge) = at {
                left[edge] = false;
                let ([from, to], side) = edges[edge];
                place[from as usize] = Some(path.len());
                path.push(from);
                // What has come back to itself is a loop, whatever path led to it.
                if let Some(start) = place[to as usize] {
                    let closed = path.split_off(start);
                    closed.iter().for_each(|&v| place[v as usize] = None);
                    loops.push(closed);
                }
                at = self.next_on_boundary(side).and_then(|next| {
                    let next = edges.binary_search_by_key(&self.ends(next), |&(ends, _)| ends);
                    next.ok().filter(|&edge| left[edge])
                });
            }
        }
        for vertices in &mut loops {
            let least = (0..vertices.len()).min_by_key(|&i| vertices[i]).unwrap_or(0);
            vertices.rotate_left(least);
        }
        loops.sort_unstable();
        loops
    }

    /// The boundary edge after another: around the vertex where that one ends, from triangle to triangle, to the other
    /// end of the fan. All fans of a vertex together have each of its triangles once.
    fn next_on_boundary(&self, side: Side) -> Option<Side> {
        let [mut before, pivot] = self.ends(side);
        let mut triangle = side.triangle;
        loop {
            let corners = self.triangles()[triangle as usize];
            let corner = corners.iter().position(|&v| v == pivot)?;
            // Where windings cannot be made consistent, as on a Möbius strip, the fan may run backward.
            if corners[(corner + 2) % 3] != before {
                return None;
            }
            let side = Side { triangle, corner };
            match self.across(side) {
                Some(next) => (triangle, before) = (next, corners[(corner + 1) % 3]),
                None => return Some(side),
            }
        }
    }
}

/// The area within a loop of vertices: positive if it runs counter-clockwise, negative, as around a hole, if
/// clockwise. Rounded; a vertex that `points` has not is passed over.
pub fn signed_area(points: &[[f64; 2]], vertices: &[u32]) -> f64 {
    let mut corners = vertices.iter().filter_map(|&v| points.get(v as usize));
    let Some(&[x, y]) = corners.next() else { return 0.0 };
    // Relative to the first: far from the origin the products would cancel.
    let relative: Vec<[f64; 2]> = corners.map(|p| [p[0] - x, p[1] - y]).collect();
    relative.windows(2).map(|pair| pair[0][0] * pair[1][1] - pair[1][0] * pair[0][1]).sum::<f64>()
        / 2.0
}
