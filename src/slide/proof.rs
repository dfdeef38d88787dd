//! The proof, from positions alone, that vertices slid as sliding allows, and the return of vertices that did not.

use glam::DVec2;

use crate::plane::Storage;
use crate::precision::Precision;
use crate::slide::options::Slide;
use crate::slide::side::BoundaryCurve;
use crate::slide::sliding::Sliding;
use crate::slide::track::Track;
use crate::topology::Topology;

/// Largest difference between the curve parameters of partners, in units of the rounding error of a coordinate.
const PARTNER_TOLERANCE: f64 = 4.0;
/// Largest distance from a curve, in units of the rounding error of a coordinate.
const CURVE_TOLERANCE: f64 = 8.0;

impl Slide {
    /// Returns the fixed vertices whose move sliding does not allow, in ascending order. An allowed move follows the
    /// curve, passes no neighbor, matches the move of the partner, and keeps the bound of [`hausdorff`](Self::hausdorff):
    /// the curve is within the bound of the lines between given vertices, and the lines between present vertices are within
    /// the bound of the given vertices. `before` has the given positions and `after` the present ones, rounded to `stored`.
    /// Vertices missing in a list are not returned. If a list is incomplete, every fixed vertex that moved is returned.
    pub fn misplaced(
        &self,
        topology: &Topology<'_>,
        before: &[[f64; 2]],
        after: &[[f64; 2]],
        stored: Precision,
    ) -> Vec<u32> {
        self.misplaced_within(topology, before, after, &|size| stored.error(size))
    }

    /// Returns the vertices that [`misplaced`](Self::misplaced) returns, for coordinates that are rounded otherwise than
    /// numbers of a precision, as in a tilted plane. `rounding` returns a bound on the error of coordinates up to an absolute
    /// value.
    pub fn misplaced_within(
        &self,
        topology: &Topology<'_>,
        before: &[[f64; 2]],
        after: &[[f64; 2]],
        rounding: &dyn Fn(f64) -> f64,
    ) -> Vec<u32> {
        let moved = moved(topology, before, after);
        let is_listed = |&v: &u32| (v as usize) < before.len() && (v as usize) < after.len();
        let all = topology.free().len() as u32;
        if moved.is_empty() || !(0..all).all(|v| is_listed(&v)) || self.check(all as usize).is_err()
        {
            return moved;
        }
        let sliding = Sliding::new(before, topology, self);
        let tolerance = sliding.tolerance([before, after], &moved, rounding);
        sliding.misplaced(&moved, after, tolerance)
    }
}

/// Returns the fixed vertices whose coordinates differ in any bit, in ascending order.
fn moved(topology: &Topology<'_>, before: &[[f64; 2]], after: &[[f64; 2]]) -> Vec<u32> {
    let differ = |&(v, is_free): &(usize, &bool)| {
        let [was, is] = [before.get(v), after.get(v)].map(|p| p.map(|p| p.map(f64::to_bits)));
        !is_free && was.is_some() && is.is_some() && was != is
    };
    topology.free().iter().enumerate().filter(differ).map(|(v, _)| v as u32).collect()
}

impl Sliding {
    /// Returns the distance within which a moved vertex counts as a point of its curve. `rounding` bounds the error of
    /// coordinates up to an absolute value. The curve is evaluated in double precision, with errors that depend on the
    /// largest coordinates of the curves.
    fn tolerance(
        &self,
        [before, after]: [&[[f64; 2]]; 2],
        moved: &[u32],
        rounding: &dyn Fn(f64) -> f64,
    ) -> f64 {
        let size = |points: &[[f64; 2]], vertices: &mut dyn Iterator<Item = u32>| {
            vertices.flat_map(|v| points[v as usize]).fold(0.0, |size: f64, x| size.max(x.abs()))
        };
        let of_moved = |points| size(points, &mut moved.iter().copied());
        let sides = self.tracks.iter().flat_map(|track| &track.sides);
        let of_curves = size(before, &mut sides.flat_map(|side| side.vertices.iter().copied()));
        let stored = rounding(of_moved(before).max(of_moved(after)));
        CURVE_TOLERANCE * stored.max(Precision::Double.error(of_curves))
    }

    /// Returns the vertices of the list whose move sliding does not allow; see [`Slide::misplaced`]. `vertices` are the
    /// moved vertices as ascending indices in the mesh, `points` the positions of all vertices of the mesh.
    fn misplaced(&self, vertices: &[u32], points: &[[f64; 2]], tolerance: f64) -> Vec<u32> {
        let mut good = Vec::new();
        for track in &self.tracks {
            let sides = track.sides.iter();
            let found: Vec<Found<'_>> =
                sides.map(|side| Found::of(track, side, vertices, points, tolerance)).collect();
            let together = |k: usize| match &found[..] {
                [first, second] if track.is_coincident => first.positions[k] == second.positions[k],
                [first, second] => {
                    let params = first.params[k].zip(second.params[k]);
                    params.is_some_and(|(a, b)| (a - b).abs() <= PARTNER_TOLERANCE * tolerance)
                }
                _ => true,
            };
            let is_good = |k: &usize| {
                let is_placed =
                    |found: &Found<'_>| found.is_in_order(*k) && found.keeps_lines(*k, tolerance);
                track.slides(*k) && found.iter().all(is_placed) && together(*k)
            };
            let own = |k: usize| track.sides.iter().map(move |side| side.vertices[k]);
            good.extend((0..track.count()).filter(is_good).flat_map(own));
        }
        good.sort_unstable();
        vertices.iter().copied().filter(|v| good.binary_search(v).is_err()).collect()
    }

    /// Moves sliding vertices back to their given positions until [`Slide::misplaced`] finds none of them. `before` and
    /// `points` are in the order of the mesh. `stored` is the form in which `points` are stored; `None` for an unknown form, for
    /// which vertices move back only if their partner has its given position. Returns the number of vertices moved back.
    pub(crate) fn return_misplaced(
        &self,
        before: &[[f64; 2]],
        points: &mut [[f64; 2]],
        stored: Option<Storage<'_>>,
    ) -> usize {
        let sides = self.tracks.iter().flat_map(|track| &track.sides);
        let slides = |side: &'_ BoundaryCurve| {
            let all = side.vertices.iter().enumerate();
            all.filter(|&(k, _)| side.slides(k)).map(|(_, &v)| v).collect::<Vec<_>>()
        };
        let mut moved: Vec<u32> = sides.flat_map(slides).collect();
        moved.sort_unstable();
        let mut returned = 0;
        loop {
            returned += self.return_partners(before, points);
            let Some(stored) = stored else { return returned };
            let bits = |point: [f64; 2]| point.map(f64::to_bits);
            moved.retain(|&v| bits(points[v as usize]) != bits(before[v as usize]));
            let tolerance = self.tolerance([before, points], &moved, &|size| stored.error(size));
            let misplaced = self.misplaced(&moved, points, tolerance);
            if misplaced.is_empty() {
                return returned;
            }
            returned += misplaced.len();
            misplaced.into_iter().for_each(|v| points[v as usize] = before[v as usize]);
        }
    }

    /// Moves vertices back to their given positions if their partner has its given position. Returns the number of
    /// vertices moved back.
    fn return_partners(&self, before: &[[f64; 2]], points: &mut [[f64; 2]]) -> usize {
        let mut returned = 0;
        for track in &self.tracks {
            let [first, second] = match &track.sides[..] {
                [first, second] => [&first.vertices, &second.vertices],
                _ => continue,
            };
            for (&a, &b) in first.iter().zip(second) {
                let [a, b] = [a, b].map(|v| v as usize);
                let has_moved = [a, b].map(|v| points[v] != before[v]);
                if has_moved[0] != has_moved[1] {
                    let v = if has_moved[0] { a } else { b };
                    points[v] = before[v];
                    returned += 1;
                }
            }
        }
        returned
    }
}

/// The vertices of one side of a track, found on their curve.
struct Found<'t> {
    track: &'t Track,
    side: &'t BoundaryCurve,
    positions: Vec<DVec2>,
    /// Curve parameter of each vertex; `None` for a vertex off the curve.
    params: Vec<Option<f64>>,
}

impl<'t> Found<'t> {
    /// Finds vertices at `points`. Vertices that are not in the ascending list `moved` have their given parameter.
    fn of(
        track: &'t Track,
        side: &'t BoundaryCurve,
        moved: &[u32],
        points: &[[f64; 2]],
        tolerance: f64,
    ) -> Self {
        let positions: Vec<DVec2> =
            side.vertices.iter().map(|&v| points[v as usize].into()).collect();
        let param = |(k, &v): (usize, &u32)| match moved.binary_search(&v) {
            Ok(_) => side.curve.find(positions[k], k, tolerance),
            Err(_) => Some(side.curve.params()[k]),
        };
        let params = side.vertices.iter().enumerate().map(param).collect();
        Self { track, side, positions, params }
    }

    fn neighbor(&self, k: usize, to: isize) -> Option<f64> {
        self.track.neighbor(k, to, |i| self.params.get(i).copied().flatten())
    }

    /// Returns whether vertex `k` is on the curve, strictly between its neighbors.
    fn is_in_order(&self, k: usize) -> bool {
        self.params[k].is_some_and(|at| {
            self.neighbor(k, -1).is_none_or(|before| before < at)
                && self.neighbor(k, 1).is_none_or(|after| at < after)
        })
    }

    /// Returns whether both edges of the line at vertex `k` are near the given vertices between their ends. Edges to
    /// vertices off the curve count as near.
    fn keeps_lines(&self, k: usize, tolerance: f64) -> bool {
        let count = self.positions.len() as isize;
        [-1, 1].into_iter().all(|to| {
            let Some((at, other)) = self.params[k].zip(self.neighbor(k, to)) else { return true };
            let there = self.positions[(k as isize + to).rem_euclid(count) as usize];
            let (mut ends, mut params) = ([self.positions[k], there], [at, other]);
            if to < 0 {
                ends.reverse();
                params.reverse();
            }
            self.side.curve.is_line_near(ends, params, k, tolerance)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Mesh;

    #[test]
    fn a_vertex_that_slides_far_along_a_straight_line_is_on_the_line() {
        // The second vertex slides from a tiny coordinate to a large one, at which single precision is coarser.
        let single = |x: f64| f64::from(x as f32);
        let at = |x: f64| [single(x), single(x / 3.0)];
        let mesh = Mesh {
            points: vec![at(0.0), at(1e-4), at(1.0), [0.0, 1.0]],
            triangles: vec![[0, 1, 3], [1, 2, 3]],
            ..Mesh::default()
        };
        let topology = Topology::new(&mesh).unwrap();
        let after = |point: [f64; 2]| {
            let mut points = mesh.points.clone();
            points[1] = point;
            Slide::default().misplaced(&topology, &mesh.points, &points, Precision::Single)
        };
        for x in [0.13, 0.5, 0.77, 0.9] {
            assert!(after(at(x)).is_empty(), "{x}");
            assert_eq!(after([single(x), single(x / 3.0 + 1e-5)]), [1], "{x}");
        }
    }

    /// A half disc of two rings around the origin, whose outer ring has vertices at every 10 degrees.
    fn half_disc() -> Mesh {
        let at = |k: u32, radius: f64| {
            let (sin, cos) = f64::from(10 * k).to_radians().sin_cos();
            [radius * cos, radius * sin]
        };
        let mut points: Vec<[f64; 2]> = (0..19).map(|k| at(k, 1.0)).collect();
        points.extend((0..19).map(|k| at(k, 0.5)));
        let quad = |k: u32| [[k, k + 1, k + 20], [k, k + 20, k + 19]];
        Mesh { points, triangles: (0..18).flat_map(quad).collect(), ..Mesh::default() }
    }

    /// Returns the half disc with vertex `v` of the outer ring moved along its curve to another place between its
    /// neighbors.
    fn slid(mesh: &Mesh, slide: &Slide, moves: &[(u32, f64)]) -> Vec<[f64; 2]> {
        let topology = Topology::new(mesh).unwrap();
        let sliding = Sliding::new(&mesh.points, &topology, slide);
        let mut points = mesh.points.clone();
        for &(v, edges) in moves {
            let sides = sliding.tracks.iter().flat_map(|track| &track.sides);
            let (side, k) = sides
                .filter_map(|side| Some((side, side.vertices.iter().position(|&u| u == v)?)))
                .next()
                .unwrap();
            let params = side.curve.params();
            let param = params[k] + edges * (params[1] - params[0]);
            points[v as usize] = side.curve.at(param, k).point.into();
        }
        points
    }

    /// A former defect: only the distance from the curve was checked.
    #[test]
    fn lines_that_leave_a_given_vertex_by_more_than_the_bound_are_found() {
        let mesh = half_disc();
        let topology = Topology::new(&mesh).unwrap();
        let misplaced = |slide: &Slide, points: &[[f64; 2]]| {
            slide.misplaced(&topology, &mesh.points, points, Precision::Double)
        };
        // The curves are equal for all these bounds, as the curve leaves an edge by 0.004.
        let [wide, narrow] = [0.2, 0.02].map(|h| Slide { hausdorff: Some(h), ..Slide::default() });
        let near = slid(&mesh, &narrow, &[(8, -0.4), (9, 0.4)]);
        assert!(misplaced(&wide, &near).is_empty() && misplaced(&narrow, &near).is_empty());
        // Vertices 8 and 9 slide four edges apart: the line between them passes given vertices at a distance of 0.06.
        let far: Vec<(u32, f64)> =
            [(6, -0.6), (7, -1.2), (8, -1.8), (9, 1.8), (10, 1.2), (11, 0.6)].into();
        let far = slid(&mesh, &wide, &far);
        assert_eq!(misplaced(&wide, &far), []);
        let found = misplaced(&narrow, &far);
        assert!(found.contains(&8) && found.contains(&9), "{found:?}");
        // An edge whose other end has not moved: the vertices between have gone ahead.
        let one = slid(&mesh, &wide, &[(9, 2.7), (10, 2.3), (11, 1.8), (12, 1.2), (13, 0.6)]);
        assert_eq!(misplaced(&wide, &one), []);
        assert_eq!(misplaced(&narrow, &one), [9]);
        // Vertices go back until no edge leaves its bound.
        let sliding = Sliding::new(&mesh.points, &topology, &narrow);
        let mut points = far;
        let exact = Some(Storage::new(Precision::Double, None));
        let returned = sliding.return_misplaced(&mesh.points, &mut points, exact);
        assert!(returned >= 2 && misplaced(&narrow, &points).is_empty(), "{returned}");
        assert_eq!(points[8], mesh.points[8]);
    }
}
