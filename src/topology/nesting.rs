//! The nesting of boundary loops, which decides whether positions of the free vertices can make a mesh valid.

use std::collections::BTreeMap;

use crate::error::MeshError;
use crate::topology::predicates::orientation;
use crate::topology::{EnclosedArea, Topology};

/// Number of vertices of a loop that are tested against the other loops.
const TESTED: usize = 16;

impl Topology<'_> {
    /// Returns a boundary loop that makes every mesh with this boundary invalid: a hole that is turned over, lies outside
    /// of the outer boundary, or lies inside another hole. No positions of free vertices untangle such a mesh, as some
    /// point would be covered less than zero times. Each edge-connected part is judged by itself.
    ///
    /// Returns `None` if edges between fixed vertices [cross](Self::crossings), if loops touch or enclose no area, or if
    /// every loop is in place.
    ///
    /// # Errors
    /// [`MeshError::PointCount`] if `points` does not have one entry per vertex.
    pub fn misplaced_loop(&self, points: &[[f64; 2]]) -> Result<Option<Vec<u32>>, MeshError> {
        if !self.crossings(points, 1)?.is_empty() {
            return Ok(None);
        }
        let parts = self.edge_parts();
        let mut loops: BTreeMap<u32, Vec<Loop>> = BTreeMap::new();
        for vertices in self.boundary_loops() {
            let Some(triangle) = self.beside(&vertices) else { continue };
            let area = EnclosedArea::of_edges(points, edges(&vertices));
            let heights = vertices.iter().map(|&v| points[v as usize][1]);
            let [low, high] = [
                heights.clone().fold(f64::INFINITY, f64::min),
                heights.fold(f64::NEG_INFINITY, f64::max),
            ];
            let one = Loop { vertices, area, low, high };
            loops.entry(parts[triangle as usize]).or_default().push(one);
        }
        Ok(loops.into_values().find_map(|mut loops| {
            // A slit has no area, and its side is not known.
            if loops.iter().any(|one| one.area.is_nan() || one.area == 0.0) {
                return None;
            }
            loops.sort_by(|a, b| b.area.total_cmp(&a.area));
            let wrong = (1..loops.len()).find(|&k| {
                loops[k].area > 0.0 || winding_of_others(points, &loops, k).is_some_and(|n| n != 1)
            });
            wrong.map(|k| loops.swap_remove(k).vertices)
        }))
    }

    /// Returns the corner at the first edge of a boundary loop.
    fn beside(&self, vertices: &[u32]) -> Option<u32> {
        let &[from, to, ..] = vertices else { return None };
        let has_edge = |t: &u32| {
            let corners = self.corners()[*t as usize];
            (0..3).any(|k| [corners[k], corners[(k + 1) % 3]] == [from, to])
        };
        self.star(from).iter().copied().find(has_edge)
    }
}

/// A boundary loop with the mesh on its left.
struct Loop {
    vertices: Vec<u32>,
    /// Twice the enclosed area, negative for holes.
    area: f64,
    /// Least and greatest y of the vertices.
    low: f64,
    high: f64,
}

/// Returns the edges of a loop of vertices.
fn edges(vertices: &[u32]) -> impl Iterator<Item = [u32; 2]> + '_ {
    vertices.iter().zip(vertices.iter().cycle().skip(1)).map(|(&a, &b)| [a, b])
}

/// Returns how often the other loops of a part wind around loop `k`, by exact predicates. `None` if the number differs
/// between vertices of the loop, or if all tested vertices are on other loops.
fn winding_of_others(points: &[[f64; 2]], loops: &[Loop], k: usize) -> Option<i32> {
    let stride = loops[k].vertices.len().div_ceil(TESTED);
    let around = |&v: &u32| {
        let others = loops.iter().enumerate().filter(|&(other, _)| other != k);
        others.map(|(_, other)| winding(points, other, v)).sum::<Option<i32>>()
    };
    let mut found = loops[k].vertices.iter().step_by(stride).filter_map(around);
    let first = found.next()?;
    found.all(|number| number == first).then_some(first)
}

/// Returns how often a loop winds counter-clockwise around a vertex; `None` if the vertex is on the loop.
fn winding(points: &[[f64; 2]], around: &Loop, vertex: u32) -> Option<i32> {
    let [x, y] = points[vertex as usize];
    // Most holes are not beside the vertex.
    if !(around.low..=around.high).contains(&y) {
        return Some(0);
    }
    let mut winding = 0;
    for [a, b] in edges(&around.vertices) {
        let ([ax, ay], [bx, by]) = (points[a as usize], points[b as usize]);
        let is_beside = (ay.min(by)..=ay.max(by)).contains(&y);
        if !is_beside {
            continue;
        }
        let side = orientation(points, &[a, b, vertex]);
        if side == 0.0 && (ax.min(bx)..=ax.max(bx)).contains(&x) {
            return None;
        }
        match (ay <= y, by <= y) {
            (true, false) if side > 0.0 => winding += 1,
            (false, true) if side < 0.0 => winding -= 1,
            _ => {}
        }
    }
    Some(winding)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Mesh;

    /// Returns a lattice of 9 by 9 squares without the squares of the two holes from (2, 4) to (3, 5) and from (6, 4) to
    /// (7, 5), whose corners are mapped by `to`.
    fn plate(to: impl Fn([f64; 2]) -> [f64; 2]) -> Mesh {
        let is_hole = |k: u32| [(2, 4), (6, 4)].contains(&(k % 9, k / 9));
        let squares = (0..81).filter(|&k| !is_hole(k)).map(|k| 10 * (k / 9) + k % 9);
        let triangles = squares.flat_map(|a| [[a, a + 1, a + 11], [a, a + 11, a + 10]]).collect();
        let point = |v: u32| {
            let p = [f64::from(v % 10), f64::from(v / 10)];
            let is_corner = (4.0..=5.0).contains(&p[1]) && [2.0, 3.0, 6.0, 7.0].contains(&p[0]);
            if is_corner { to(p) } else { p }
        };
        Mesh { points: (0..100).map(point).collect(), triangles, ..Mesh::default() }
    }

    fn misplaced(mesh: &Mesh) -> Option<Vec<u32>> {
        Topology::by_area(mesh).unwrap().misplaced_loop(&mesh.points).unwrap()
    }

    #[test]
    fn holes_outside_inside_each_other_and_turned_over_are_found() {
        let left = [42, 43, 52, 53];
        let found = |to: &dyn Fn([f64; 2]) -> [f64; 2]| {
            let mut vertices = misplaced(&plate(to))?;
            vertices.sort_unstable();
            Some(vertices)
        };
        let of_left =
            |to: fn([f64; 2]) -> [f64; 2]| move |p: [f64; 2]| if p[0] < 4.0 { to(p) } else { p };
        assert_eq!(found(&|p| p), None);
        // Moved and turned within the plate, also to the other side of the other hole.
        assert_eq!(found(&of_left(|[x, y]| [x + 5.5, 0.5 + y])), None);
        assert_eq!(found(&of_left(|[x, y]| [5.0 - x, 9.0 - y])), None);
        assert_eq!(found(&of_left(|[x, y]| [x - 20.0, y])).as_deref(), Some(&left[..]));
        assert_eq!(found(&of_left(|[x, y]| [x, 9.0 - y])).as_deref(), Some(&left[..]));
        let inside = |[x, y]: [f64; 2]| [6.25 + 0.5 * (x - 2.0), 4.25 + 0.5 * (y - 4.0)];
        assert_eq!(found(&of_left(inside)).as_deref(), Some(&left[..]));
        // Loops that cross are judged by their crossings.
        assert_eq!(found(&of_left(|[x, y]| [x + 4.5, y + 0.5])), None);
    }

    #[test]
    fn parts_that_lie_over_each_other_are_judged_apart() {
        let mut mesh = plate(|p| p);
        let first = mesh.points.len() as u32;
        let small = mesh.points.iter().map(|[x, y]| [0.5 + 0.01 * x, 0.5 + 0.01 * y]);
        mesh.points.extend(small.collect::<Vec<_>>());
        let copies: Vec<_> = mesh.triangles.iter().map(|t| t.map(|v| v + first)).collect();
        mesh.triangles.extend(copies);
        assert_eq!(misplaced(&mesh), None);
    }
}
