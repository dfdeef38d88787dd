//! The boundary of a mesh, as edges and as loops.

use crate::mesh::Element;
use crate::topology::Topology;
use crate::topology::sides::BoundaryEdge;

impl Topology<'_> {
    /// Returns the boundary edges, those of exactly one element, in no particular order. Each edge is a pair of
    /// vertices, start and end, with the mesh on the left.
    pub fn boundary_edges(&self) -> Vec<[u32; 2]> {
        self.boundary.iter().map(|&side| self.ends(side)).collect()
    }

    /// Returns the sides of an element that belong to a corner: all three of a triangle, one of a quadrilateral.
    fn sides(&self, corner: u32) -> impl Iterator<Item = BoundaryEdge> + use<> {
        let count = if self.corner_list().is_triangle(corner) { 3 } else { 1 };
        (0..count).map(move |place| BoundaryEdge { corner, place })
    }

    fn ends(&self, side: BoundaryEdge) -> [u32; 2] {
        side.ends(self.corner_list())
    }

    fn across(&self, side: BoundaryEdge) -> Option<u32> {
        side.across(self.corner_list(), self.stars())
    }

    /// Returns the boundary as closed loops of vertices, with the mesh on the left. A loop lists each vertex once; a
    /// closing edge leads from the last vertex to the first.
    ///
    /// Loops are counter-clockwise around the outside and clockwise around a hole, so the sign of [`signed_area`] tells
    /// them apart. No loop passes a vertex twice: parts or holes that touch in a vertex have separate loops. Each loop
    /// starts at its least vertex, and loops are sorted by that vertex.
    pub fn boundary_loops(&self) -> Vec<Vec<u32>> {
        let mut edges: Vec<([u32; 2], BoundaryEdge)> =
            self.boundary.iter().map(|&side| (self.ends(side), side)).collect();
        edges.sort_unstable_by_key(|&(ends, _)| ends);
        let mut loops = Vec::new();
        let mut left = vec![true; edges.len()];
        // Position of each vertex in `path`, or `None` for a vertex that is not on the path.
        let mut place = vec![None; self.free().len()];
        for first in 0..edges.len() {
            let mut at = Some(first).filter(|&edge| left[edge]);
            let mut path: Vec<u32> = Vec::new();
            while let Some(edge) = at {
                left[edge] = false;
                let ([from, to], side) = edges[edge];
                place[from as usize] = Some(path.len());
                path.push(from);
                // The path has returned to one of its vertices. The section from this vertex to the end of the path is
                // a closed loop.
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
            // A path that ends without closing a loop leaves its vertices to later paths.
            path.into_iter().for_each(|v| place[v as usize] = None);
        }
        for vertices in &mut loops {
            let least = (0..vertices.len()).min_by_key(|&i| vertices[i]).unwrap_or(0);
            vertices.rotate_left(least);
        }
        loops.sort_unstable();
        loops
    }

    /// Returns the first element of an edge-connected part that has no boundary edge. `None` if every part has a
    /// boundary. A part without boundary edges is a closed surface, such as a sphere. However the vertices of a closed
    /// surface are placed in the plane, some of its elements are inverted or flat.
    pub fn closed_part(&self) -> Option<Element> {
        let parts = self.edge_parts();
        let mut is_closed = vec![true; parts.len()];
        for side in &self.boundary {
            is_closed[parts[side.corner as usize] as usize] = false;
        }
        let found = (0..parts.len()).find(|&t| parts[t] as usize == t && is_closed[t]);
        found.map(|first| self.element(first as u32))
    }

    /// Labels the edge-connected parts: returns, per corner, the first corner of the first element of its part.
    pub(super) fn edge_parts(&self) -> Vec<u32> {
        let corners = self.corner_list();
        let mut parts = vec![u32::MAX; self.corners().len()];
        let mut front = Vec::new();
        for first in 0..parts.len() as u32 {
            if parts[first as usize] != u32::MAX {
                continue;
            }
            let of = |element: u32| {
                let count = if corners.is_triangle(element) { 1 } else { 4 };
                element..element + count
            };
            of(first).for_each(|corner| parts[corner as usize] = first);
            front.push(first);
            while let Some(element) = front.pop() {
                for side in of(element).flat_map(|corner| self.sides(corner)) {
                    let other = self.across(side);
                    if let Some(other) = other.filter(|&other| parts[other as usize] == u32::MAX) {
                        of(other).for_each(|corner| parts[corner as usize] = first);
                        front.push(other);
                    }
                }
            }
        }
        parts
    }

    /// Returns the boundary edge that follows `side`. The search turns around the end vertex of `side`, from element
    /// to element, until it reaches the last edge of the fan. The fans of a vertex share no element, so each element
    /// is visited once per corner.
    fn next_on_boundary(&self, side: BoundaryEdge) -> Option<BoundaryEdge> {
        let [mut before, pivot] = self.ends(side);
        let mut element = side.corner;
        loop {
            let (corner, place) = self.corner_list().at(element, pivot)?;
            let vertices = self.corners()[corner as usize];
            // If windings cannot be made consistent, as on a Möbius strip, neighboring elements of a fan may have
            // opposite windings. The path then ends without closing a loop.
            if vertices[(place + 2) % 3] != before {
                return None;
            }
            let side = BoundaryEdge { corner, place: place as u32 };
            match self.across(side) {
                Some(next) => (element, before) = (next, vertices[(place + 1) % 3]),
                None => return Some(side),
            }
        }
    }
}

/// Returns the area within a loop of vertices, in the square of the unit of `points`, rounded. The area is positive if
/// the loop is counter-clockwise, negative if clockwise, as around a hole. Vertices without a point are skipped.
pub fn signed_area(points: &[[f64; 2]], vertices: &[u32]) -> f64 {
    let mut corners = vertices.iter().filter_map(|&v| points.get(v as usize));
    let Some(&[x, y]) = corners.next() else { return 0.0 };
    // Corners are taken relative to the first point, as products of coordinates far from the origin would cancel.
    let relative: Vec<[f64; 2]> = corners.map(|p| [p[0] - x, p[1] - y]).collect();
    relative.windows(2).map(|pair| pair[0][0] * pair[1][1] - pair[1][0] * pair[0][1]).sum::<f64>()
        / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Mesh;

    /// The eight triangles of an octahedron around the origin, seen from above. Both poles, vertices 4 and 5, have the
    /// coordinates of the origin.
    const OCTAHEDRON: [[u32; 3]; 8] =
        [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4], [1, 0, 5], [2, 1, 5], [3, 2, 5], [0, 3, 5]];

    fn closed(triangles: &[[u32; 3]]) -> Option<Element> {
        let points = vec![
            [1.0, 0.0],
            [0.0, 1.0],
            [-1.0, 0.0],
            [0.0, -1.0],
            [0.0, 0.0],
            [0.0, 0.0],
            [3.0, 0.0],
            [3.0, 1.0],
            [2.0, 0.0],
        ];
        let mesh = Mesh { points, triangles: triangles.to_vec(), ..Mesh::default() };
        Topology::new(&mesh).unwrap().closed_part()
    }

    /// Triangles between few vertices, in which each edge has at most two triangles. Many have no consistent windings.
    #[test]
    fn loops_follow_edges_of_the_boundary_whatever_the_windings() {
        let mut state = 1_u64;
        let mut below = |n: u64| {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 33) % n
        };
        let mut has_odd = false;
        for _ in 0..3000 {
            let mut uses = std::collections::BTreeMap::new();
            let mut triangles = Vec::new();
            for _ in 0..30 {
                let t = [0; 3].map(|_| below(9) as u32);
                let edges = [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]].map(|mut edge| {
                    edge.sort_unstable();
                    edge
                });
                let is_new = |edge| uses.get(edge).is_none_or(|&count| count < 2);
                if edges.iter().all(|[a, b]| a != b) && edges.iter().all(is_new) {
                    edges.into_iter().for_each(|edge| *uses.entry(edge).or_insert(0) += 1);
                    triangles.push(t);
                }
            }
            let points = (0..9).map(|v| [f64::from(v), f64::from(v * v % 7)]).collect();
            let mesh = Mesh { points, triangles, ..Mesh::default() };
            let Ok(topology) = Topology::new(&mesh) else { continue };
            let loops = topology.boundary_loops();
            for vertices in &loops {
                assert!(vertices.len() > 2, "{:?}: {loops:?}", mesh.triangles);
                for (i, &v) in vertices.iter().enumerate() {
                    let mut edge = [v, vertices[(i + 1) % vertices.len()]];
                    edge.sort_unstable();
                    assert_eq!(uses.get(&edge), Some(&1), "{:?}: {loops:?}", mesh.triangles);
                }
            }
            let in_loops = loops.iter().map(Vec::len).sum::<usize>();
            has_odd |= in_loops < uses.values().filter(|&&count| count == 1).count();
        }
        assert!(has_odd, "no mesh without consistent windings was tried");
    }

    #[test]
    fn a_part_without_boundary_is_found_among_others() {
        assert_eq!(closed(&OCTAHEDRON), Some(Element::Triangle(0)));
        assert_eq!(closed(&OCTAHEDRON[..7]), None);
        assert_eq!(closed(&OCTAHEDRON[..4]), None);
        // A part with a boundary comes first and touches the octahedron in vertex 0.
        let both = [&[[6, 7, 8], [0, 6, 8]], &OCTAHEDRON[..]].concat();
        assert_eq!(closed(&both), Some(Element::Triangle(2)));
    }
}
