//! The sliding vertices of a mesh, and sweeps of Newton steps along their curves.

use glam::DVec2;

use crate::layout::Problem;
use crate::patch::Fan;
use crate::precision::Precision;
use crate::slide::chains::chains;
use crate::slide::newton::{self, Reach, Rule, Visited, Window};
use crate::slide::options::Slide;
use crate::slide::params::Params;
use crate::slide::side::BoundaryCurve;
use crate::topology::Topology;

impl Slide {
    /// Returns the fixed vertices whose move sliding does not allow, in ascending order. An allowed move follows the
    /// curve, passes no neighbor, and matches the move of the partner. `before` has the given positions and `after` the
    /// present ones, rounded to `stored`. Vertices missing in a list are not returned. If a list is incomplete, every
    /// fixed vertex that moved is returned.
    pub fn misplaced(
        &self,
        topology: &Topology<'_>,
        before: &[[f64; 2]],
        after: &[[f64; 2]],
        stored: Precision,
    ) -> Vec<u32> {
        let differ = |&(v, is_free): &(usize, &bool)| {
            let [was, is] = [before.get(v), after.get(v)].map(|p| p.map(|p| p.map(f64::to_bits)));
            !is_free && was.is_some() && is.is_some() && was != is
        };
        let moved = topology.free().iter().enumerate().filter(differ);
        let moved: Vec<u32> = moved.map(|(v, _)| v as u32).collect();
        let is_listed = |&v: &u32| (v as usize) < before.len() && (v as usize) < after.len();
        let all = topology.free().len() as u32;
        if moved.is_empty() || !(0..all).all(|v| is_listed(&v)) || self.check(all as usize).is_err()
        {
            return moved;
        }
        let size = |points: &[[f64; 2]]| {
            moved.iter().flat_map(|&v| points[v as usize]).fold(0.0, |m: f64, x| m.max(x.abs()))
        };
        let sliding = Sliding::new(before, topology, self);
        // The present coordinates are rounded to `stored`. The curve is evaluated in double precision, with errors that
        // depend on the largest coordinates of the curve.
        let rounding = stored.error(size(before).max(size(after)));
        let evaluation = Precision::Double.error(sliding.size(before));
        sliding.misplaced(&moved, after, 8.0 * rounding.max(evaluation))
    }
}

/// Largest number of rounds that reset vertices of a curve, as each reset may put a neighbor out of order.
const RESET_PASSES: u32 = 5;
/// Largest difference between the curve parameters of partners, in units of the rounding error of a coordinate.
const PARTNER_TOLERANCE: f64 = 4.0;

/// All curves of a mesh on which vertices slide, alone or in pairs.
#[derive(Clone, Debug)]
pub(crate) struct Sliding {
    tracks: Vec<Track>,
    /// Number of pairs that stay because the motion of the other pairs does not fit them.
    unlike: usize,
}

/// A curve on which vertices slide. If the vertices have partners, the second side is the curve of the partners.
#[derive(Clone, Debug)]
struct Track {
    sides: Vec<BoundaryCurve>,
}

impl Sliding {
    /// Finds the curves of a mesh with its vertices at `points`.
    pub(crate) fn new(points: &[[f64; 2]], topology: &Topology<'_>, slide: &Slide) -> Self {
        let (chains, unlike) = chains(points, topology, slide);
        let track = |chain| Track { sides: BoundaryCurve::of(points, topology, slide, chain) };
        Self { tracks: chains.into_iter().map(track).collect(), unlike }
    }

    /// Replaces vertex indices in the mesh by indices in the problem. The mesh has `vertices` vertices.
    pub(crate) fn numbered(mut self, problem: &Problem, vertices: usize) -> Self {
        let number = problem.numbers(vertices);
        let sides = self.tracks.iter_mut().flat_map(|track| &mut track.sides);
        for fan in sides.flat_map(|side| &mut side.fans).flatten() {
            fan.renumber(&number);
        }
        self
    }

    /// Returns the number of sliding vertices, partners included.
    pub(crate) fn count(&self) -> usize {
        let sides = self.tracks.iter().flat_map(|track| &track.sides);
        sides.flat_map(|side| &side.fans).flatten().count()
    }

    /// Returns the largest absolute coordinate of the given vertices of all curves.
    fn size(&self, points: &[[f64; 2]]) -> f64 {
        let sides = self.tracks.iter().flat_map(|track| &track.sides);
        let coordinates = sides.flat_map(|side| &side.vertices).flat_map(|&v| points[v as usize]);
        coordinates.fold(0.0, |size: f64, x| size.max(x.abs()))
    }

    /// Returns the sliding vertices as indices in the problem, in ascending order.
    pub(crate) fn vertices(&self) -> Vec<u32> {
        let sides = self.tracks.iter().flat_map(|track| &track.sides);
        let fans = sides.flat_map(|side| &side.fans).flatten();
        let mut vertices: Vec<u32> = fans.map(Fan::own).collect();
        vertices.sort_unstable();
        vertices
    }

    /// Returns the number of sliding pairs, and the number of pairs that stay because the common motion does not fit
    /// them.
    pub(crate) fn pairs(&self) -> [usize; 2] {
        let second = self.tracks.iter().flat_map(|track| track.sides.get(1));
        [second.flat_map(|side| &side.fans).flatten().count(), self.unlike]
    }

    /// Returns the curve parameters of the given positions.
    pub(crate) fn start(&self) -> Params {
        self.tracks.iter().map(|track| track.start().to_vec()).collect()
    }

    /// Returns the vertices whose parameter differs from the given one: index in the mesh, and position in the unit of
    /// the mesh.
    pub(crate) fn moved(&self, params: &Params) -> Vec<(u32, [f64; 2])> {
        let of_side = |(side, params): (&BoundaryCurve, &[f64])| {
            let all = side.vertices.iter().zip(params).zip(side.curve.params()).enumerate();
            let moved = all.filter(|(_, ((_, now), was))| now != was);
            let there = |(k, ((&v, &now), _))| (v, side.curve.at(now, k).point.into());
            moved.map(there).collect::<Vec<_>>()
        };
        self.sides(params).flat_map(of_side).collect()
    }

    /// Iterates over all curves, partner curves included, with the parameters of their vertices.
    fn sides<'a>(
        &'a self,
        params: &'a Params,
    ) -> impl Iterator<Item = (&'a BoundaryCurve, &'a [f64])> {
        let all = self.tracks.iter().zip(params);
        all.flat_map(|(track, params)| track.sides.iter().map(move |side| (side, &params[..])))
    }

    /// Evaluates `of` for the vertices of all curves, given their indices in the mesh. For partners, the smaller of the
    /// two values is returned.
    pub(crate) fn for_each_vertex(&self, of: impl Fn(u32) -> f64) -> Params {
        let least = |track: &Track, k: usize| {
            let all = track.sides.iter().map(|side| of(side.vertices[k]));
            all.fold(f64::INFINITY, f64::min)
        };
        let of_track = |track: &Track| (0..track.count()).map(|k| least(track, k)).collect();
        self.tracks.iter().map(of_track).collect()
    }

    /// Returns the change of each parameter, relative to the mean length of the two given edges at the vertex.
    pub(crate) fn change(&self, before: &Params, after: &Params) -> Vec<f64> {
        let of_track = |((track, before), after): ((&Track, &Vec<f64>), &Vec<f64>)| {
            let start = track.start();
            let edge = |k: usize| {
                let window = track.window(start, k);
                0.5 * (window.high - window.low)
            };
            (0..start.len()).map(|k| (after[k] - before[k]) / edge(k)).collect::<Vec<_>>()
        };
        self.tracks.iter().zip(before).zip(after).flat_map(of_track).collect()
    }

    /// Writes the curve points of the parameters `params` to `positions`. Before, at most [`RESET_PASSES`] rounds reset
    /// vertices to their parameter in `safe`: each vertex that would pass a neighbor, leave the tolerance of the given
    /// lines, or exceed its reach. Returns false if some vertex still does.
    pub(crate) fn place(
        &self,
        problem: &Problem,
        params: &mut Params,
        safe: &Params,
        reach: &Params,
        positions: &mut [DVec2],
    ) -> bool {
        let mut all = self.tracks.iter().zip(params).zip(safe.iter().zip(reach));
        all.all(|((track, params), (safe, reach))| {
            let sliding = || (0..track.count()).filter(|&k| track.slides(k));
            let is_sound = |params: &[f64], k: usize| {
                let Window { low, at, high } = track.window(params, k);
                let is_sound = |side: &BoundaryCurve| {
                    side.curve.is_near([low, at, high], k)
                        && track.reach(reach, k).allows(&side.curve, at)
                };
                low < at && at < high && track.sides.iter().all(is_sound)
            };
            for _ in 0..RESET_PASSES {
                let bad: Vec<usize> = sliding().filter(|&k| !is_sound(params, k)).collect();
                if bad.is_empty() {
                    break;
                }
                bad.into_iter().for_each(|k| params[k] = safe[k]);
            }
            (0..track.count()).for_each(|k| track.follow(problem, k, params[k], positions));
            sliding().all(|k| is_sound(params, k))
        })
    }

    /// Returns whether every sliding vertex is strictly between its neighbors on the curve, and every other vertex at
    /// its given parameter.
    pub(crate) fn is_in_order(&self, params: &Params) -> bool {
        self.tracks.iter().zip(params).all(|(track, params)| {
            let is_in_order = |k: usize| match track.slides(k) {
                true => {
                    let Window { low, at, high } = track.window(params, k);
                    low < at && at < high
                }
                false => params[k] == track.start()[k],
            };
            (0..track.count()).all(is_in_order)
        })
    }

    /// Returns the largest distance between the lines through the vertices at `params` and the lines through the given
    /// positions, in the unit of the mesh.
    pub(crate) fn off(&self, params: &Params) -> f64 {
        let of_track = |(track, params): (&Track, &Vec<f64>)| {
            let edges = (0..params.len()).filter(|&k| track.slides(k) || k == 0);
            let next = |k| track.neighbor(k, 1, |i| params.get(i).copied());
            let off = |low: f64, high: f64, k: usize| {
                track.sides.iter().map(|side| side.curve.off(low, high, k)).fold(0.0, f64::max)
            };
            edges.filter_map(|k| next(k).map(|next| off(params[k], next, k))).fold(0.0, f64::max)
        };
        self.tracks.iter().zip(params).map(of_track).fold(0.0, f64::max)
    }

    /// Visits every sliding vertex, curve by curve, forward and then back, with one safeguarded Newton step along the
    /// curve. Every vertex stays within `reach` of its given position, in the unit of the mesh. No altitude falls below
    /// the floor of `rule`. Partners move together.
    pub(crate) fn sweep(
        &self,
        problem: &Problem,
        params: &mut Params,
        reach: &Params,
        positions: &mut [DVec2],
        rule: Rule<'_>,
    ) {
        for ((track, params), reach) in self.tracks.iter().zip(params).zip(reach) {
            let count = params.len();
            for k in (0..count).chain((0..count).rev()).filter(|&k| track.slides(k)) {
                let (window, reach) = (track.window(params, k), track.reach(reach, k));
                let vertex = Visited { sides: &track.sides, k, window, reach };
                if let Some(param) = newton::visit(problem, positions, vertex, rule) {
                    params[k] = param;
                    track.follow(problem, k, param, positions);
                }
            }
        }
    }

    /// Returns the vertices of the list that left their curve, passed a neighbor, or left their partner's parameter.
    /// `vertices` are ascending indices in the mesh, `points` the positions of all vertices of the mesh. `rounding`
    /// bounds the error of a coordinate.
    pub(crate) fn misplaced(
        &self,
        vertices: &[u32],
        points: &[[f64; 2]],
        rounding: f64,
    ) -> Vec<u32> {
        let mut misplaced = vertices.to_vec();
        for track in &self.tracks {
            let found_on = |side: &BoundaryCurve| {
                let own = |(k, &v): (usize, &u32)| {
                    let at = DVec2::from(points[v as usize]);
                    let has_moved = vertices.binary_search(&v).is_ok();
                    match has_moved {
                        true => side.curve.find(at, k, rounding),
                        false => Some(side.curve.params()[k]),
                    }
                };
                side.vertices.iter().enumerate().map(own).collect::<Vec<Option<f64>>>()
            };
            let found: Vec<Vec<Option<f64>>> = track.sides.iter().map(found_on).collect();
            let is_between = |found: &[Option<f64>], k: usize| {
                let neighbor = |to: isize| track.neighbor(k, to, |i| found[i]);
                found[k].is_some_and(|at| {
                    neighbor(-1).is_none_or(|before| before < at)
                        && neighbor(1).is_none_or(|after| at < after)
                })
            };
            let together = |k: usize| {
                let [first, second] = match &found[..] {
                    [first, second] => [first[k], second[k]],
                    _ => return true,
                };
                let apart = |(a, b): (f64, f64)| (a - b).abs();
                first
                    .zip(second)
                    .map(apart)
                    .is_some_and(|apart| apart <= PARTNER_TOLERANCE * rounding)
            };
            let good = |k: &usize| {
                track.slides(*k) && found.iter().all(|found| is_between(found, *k)) && together(*k)
            };
            let good = (0..track.count()).filter(good);
            let own = |k: usize| track.sides.iter().map(move |side| side.vertices[k]);
            let mut good: Vec<u32> = good.flat_map(own).collect();
            good.sort_unstable();
            misplaced.retain(|v| good.binary_search(v).is_err());
        }
        misplaced
    }

    /// Moves vertices back to their given positions if their partner has its given position. `before` and `points` are
    /// in the order of the mesh. Returns the number of vertices moved back.
    pub(crate) fn return_partners(&self, before: &[[f64; 2]], points: &mut [[f64; 2]]) -> usize {
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

impl Track {
    /// Returns the parameters of the given positions, common to both sides.
    fn start(&self) -> &[f64] {
        self.sides[0].curve.params()
    }

    /// Returns the number of vertices on each side.
    fn count(&self) -> usize {
        self.sides[0].vertices.len()
    }

    fn slides(&self, k: usize) -> bool {
        self.sides[0].slides(k)
    }

    /// Moves the vertices of index `k` on all sides to a parameter, if they slide.
    fn follow(&self, problem: &Problem, k: usize, param: f64, positions: &mut [DVec2]) {
        for side in &self.sides {
            if let Some(fan) = &side.fans[k] {
                positions[fan.own() as usize] = side.at(problem, param, k).point;
            }
        }
    }

    /// Returns `known` for the vertex before (`to` = -1) or after (1) vertex `k`. On a closed curve, parameters
    /// continue past the first vertex: by one period for each turn.
    fn neighbor(&self, k: usize, to: isize, known: impl Fn(usize) -> Option<f64>) -> Option<f64> {
        let (at, count) = (k as isize + to, self.count() as isize);
        let turns = at.div_euclid(count);
        let param = known(at.rem_euclid(count) as usize)?;
        Some(param + turns as f64 * self.sides[0].curve.period())
    }

    /// Returns the bound on the distance of vertex `k` from its given position.
    fn reach(&self, reach: &[f64], k: usize) -> Reach {
        Reach { vertex: k, start: self.start()[k], most: reach[k] }
    }

    /// Returns the parameters of vertex `k` and of its two neighbors.
    fn window(&self, params: &[f64], k: usize) -> Window {
        let neighbor = |to| self.neighbor(k, to, |i| Some(params[i])).unwrap_or(params[k]);
        Window { low: neighbor(-1), at: params[k], high: neighbor(1) }
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
}
