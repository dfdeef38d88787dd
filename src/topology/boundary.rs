//! The boundary of a mesh: its edges, and the loops they make.

use crate::topology::Topology;

impl Topology<'_> {
    /// The edges of one triangle only, each from and to a vertex, with the mesh on its left. In no particular
    /// order.
    pub fn boundary_edges(&self) -> Vec<[u32; 2]> {
        let sides = |&[a, b, c]: &[u32; 3]| [[a, b], [b, c], [c, a]];
        let single = |&[a, b]: &[u32; 2]| {
            let at_edge = |&&t: &&u32| self.triangles()[t as usize].contains(&b);
            self.star(a).iter().filter(at_edge).count() == 1
        };
        self.triangles().iter().flat_map(sides).filter(single).collect()
    }

    /// The boundary as closed loops of vertices, the last joined to the first, with the mesh on the left:
    /// around the outside counter-clockwise, around a hole clockwise, so that the sign of a loop's
    /// area, [`signed_area`], tells them apart. No loop passes a vertex twice; where parts or holes touch in a vertex, each has its
    /// own loop. A loop starts at its least vertex, and loops are in the order of these.
    pub fn boundary_loops(&self) -> Vec<Vec<u32>> {
        let mut edges = self.boundary_edges();
        edges.sort_unstable();
        let mut loops = Vec::new();
        let mut left = vec![true; edges.len()];
        // Where each vertex stands in the path, if it does.
        let mut place = vec![None; self.free().len()];
        for first in 0..edges.len() {
            let mut at = Some(first).filter(|&edge| left[edge]);
            let mut path: Vec<u32> = Vec::new();
            while let Some(edge) = at {
                left[edge] = false;
                let [from, to] = edges[edge];
                place[from as usize] = Some(path.len());
                path.push(from);
                // What has come back to itself is a loop, whatever path led to it.
                if let Some(start) = place[to as usize] {
                    let closed = path.split_off(start);
                    closed.iter().for_each(|&v| place[v as usize] = None);
                    loops.push(closed);
                }
                at = self.next_boundary_vertex(from, to).and_then(|next| {
                    edges.binary_search(&[to, next]).ok().filter(|&edge| left[edge])
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

    /// Where the boundary goes on after its edge between two vertices: around the second, from triangle to
    /// triangle, to the other end of the fan.
    fn next_boundary_vertex(&self, from: u32, to: u32) -> Option<u32> {
        let star = self.star(to);
        let mut before = from;
        for _ in star {
            let after = star.iter().find_map(|&t| {
                let corners = self.triangles()[t as usize];
                let i = corners.iter().position(|&v| v == to)?;
                (corners[(i + 2) % 3] == before).then_some(corners[(i + 1) % 3])
            });
            match after {
                Some(after) => before = after,
                None => break,
            }
        }
        Some(before).filter(|&next| next != from)
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
