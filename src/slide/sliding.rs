//! The vertices of a mesh that slide, and sweeps over them.

use glam::DVec2;

use crate::layout::Problem;
use crate::mesh::Precision;
use crate::run::Step;
use crate::slide::chains::chains;
use crate::slide::curve::Curve;
use crate::slide::newton::{self, Reach, Window};
use crate::slide::options::Slide;
use crate::slide::patch::Fan;
use crate::topology::Topology;

impl Slide {
    /// The vertices that are not free and have moved, but not along a curve that they were on, or past a neighbor there: ascending.
    /// `before` are the vertices as they were given, `after` as they are, stored with so many digits. Vertices that one of the lists
    /// does not have are left out.
    pub fn astray(
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
        let size =
            moved.iter().flat_map(|&v| before[v as usize]).fold(0.0, |m: f64, x| m.max(x.abs()));
        let digits = match stored {
            Precision::Single => f64::from(f32::EPSILON),
            Precision::Double => f64::EPSILON,
        };
        Sliding::new(before, topology, self).astray(&moved, after, 8.0 * digits * size)
    }
}

/// How often vertices may give way to others that did.
const GIVE_WAY: u32 = 5;

/// Where the vertices of each curve are on it.
pub(crate) type Params = Vec<Vec<f64>>;

/// The curves of a mesh, with the vertices that slide on them.
#[derive(Clone, Debug)]
pub(crate) struct Sliding {
    tracks: Vec<Track>,
}

/// A curve and its vertices, in their order. Only those with a fan slide: all but the ends of a curve that is not closed.
#[derive(Clone, Debug)]
struct Track {
    curve: Curve,
    /// The numbers of the vertices in the mesh.
    vertices: Vec<u32>,
    fans: Vec<Option<Fan>>,
}

impl Sliding {
    /// Finds the curves of a mesh with its vertices at `points`.
    pub(crate) fn new(points: &[[f64; 2]], topology: &Topology<'_>, slide: &Slide) -> Self {
        let track = |chain| {
            let curve = Curve::new(points, &chain, slide);
            let last = chain.vertices.len() - 1;
            let slides = |k: usize| chain.is_closed || k != 0 && k != last;
            let fan = |(k, &v): (usize, &u32)| slides(k).then(|| Fan::new(topology, v));
            let fans = chain.vertices.iter().enumerate().map(fan).collect();
            Track { curve, vertices: chain.vertices, fans }
        };
        Self { tracks: chains(points, topology, slide).into_iter().map(track).collect() }
    }

    /// The same curves, with vertices numbered as a problem does.
    pub(crate) fn numbered(mut self, problem: &Problem, vertices: usize) -> Self {
        let mut number = vec![u32::MAX; vertices];
        for (new, &v) in (0..).zip(problem.vertices()) {
            number[v as usize] = new;
        }
        for fan in self.tracks.iter_mut().flat_map(|track| &mut track.fans).flatten() {
            fan.renumber(&number);
        }
        self
    }

    /// Number of vertices that slide.
    pub(crate) fn count(&self) -> usize {
        self.tracks.iter().flat_map(|track| &track.fans).flatten().count()
    }

    /// Where the vertices were given.
    pub(crate) fn start(&self) -> Params {
        self.tracks.iter().map(|track| track.curve.params().to_vec()).collect()
    }

    /// The vertices that have left the place where they were given, with their numbers in the mesh, and where they are.
    pub(crate) fn moved(&self, params: &Params) -> Vec<(u32, [f64; 2])> {
        let of_track = |(track, params): (&Track, &Vec<f64>)| {
            let all = track.vertices.iter().zip(params).zip(track.curve.params());
            let moved = all.filter(|((_, now), was)| now != was);
            moved.map(|((&v, &now), _)| (v, track.curve.at(now).point.into())).collect::<Vec<_>>()
        };
        self.tracks.iter().zip(params).flat_map(of_track).collect()
    }

    /// A number for each vertex of each curve, by its number in the mesh.
    pub(crate) fn for_each_vertex(&self, of: impl Fn(u32) -> f64) -> Params {
        let of_track = |track: &Track| track.vertices.iter().map(|&v| of(v)).collect();
        self.tracks.iter().map(of_track).collect()
    }

    /// By how much parameters changed, in lengths of an edge that was given.
    pub(crate) fn change(&self, before: &Params, after: &Params) -> Vec<f64> {
        let of_track = |((track, before), after): ((&Track, &Vec<f64>), &Vec<f64>)| {
            let start = track.curve.params();
            let edge = |k: usize| {
                let window = track.window(start, k);
                0.5 * (window.high - window.low)
            };
            (0..start.len()).map(|k| (after[k] - before[k]) / edge(k)).collect::<Vec<_>>()
        };
        self.tracks.iter().zip(before).zip(after).flat_map(of_track).collect()
    }

    /// Moves the vertices that slide to where `params` are. Those that would not be between their neighbors, or too far from the lines
    /// that were given or, by `reach`, from where they were given, go to where `safe` has them instead. Returns whether all are sound
    /// then.
    pub(crate) fn place(
        &self,
        problem: &Problem,
        params: &mut Params,
        (safe, reach): (&Params, &Params),
        positions: &mut [DVec2],
    ) -> bool {
        let (center, scale) = problem.normalization();
        let mut all = self.tracks.iter().zip(params).zip(safe.iter().zip(reach));
        all.all(|((track, params), (safe, reach))| {
            let sliding = || (0..track.fans.len()).filter(|&k| track.fans[k].is_some());
            let is_sound = |params: &[f64], k: usize| {
                let Window { low, at, high } = track.window(params, k);
                low < at
                    && at < high
                    && track.curve.is_near([low, at, high])
                    && track.reach(reach, k).allows(&track.curve, at)
            };
            for _ in 0..GIVE_WAY {
                let bad: Vec<usize> = sliding().filter(|&k| !is_sound(params, k)).collect();
                if bad.is_empty() {
                    break;
                }
                bad.into_iter().for_each(|k| params[k] = safe[k]);
            }
            for (k, fan) in track.fans.iter().enumerate() {
                if let Some(fan) = fan {
                    let point = track.curve.at(params[k]).point;
                    positions[fan.own() as usize] = (point - center) * scale;
                }
            }
            sliding().all(|k| is_sound(params, k))
        })
    }

    /// How far the lines between vertices are from those between the vertices as they were given, in the unit of the mesh.
    pub(crate) fn off(&self, params: &Params) -> f64 {
        let of_track = |(track, params): (&Track, &Vec<f64>)| {
            let edges = (0..params.len()).filter(|&k| track.fans[k].is_some() || k == 0);
            let next = |k| track.neighbor(k, 1, |i| params.get(i).copied());
            let off = edges.filter_map(|k| next(k).map(|next| track.curve.off(params[k], next)));
            off.fold(0.0, f64::max)
        };
        self.tracks.iter().zip(params).map(of_track).fold(0.0, f64::max)
    }

    /// Visits every vertex that slides, curve by curve, forward and then back. Moves it by a safeguarded Newton step along its curve, no
    /// farther from where it was given than `reach` says, in the unit of the mesh, and such that no altitude falls below `floor`.
    pub(crate) fn sweep(
        &self,
        problem: &Problem,
        params: &mut Params,
        reach: &Params,
        positions: &mut [DVec2],
        (step, floor): (&Step, f64),
    ) {
        for ((track, params), reach) in self.tracks.iter().zip(params).zip(reach) {
            let count = params.len();
            for k in (0..count).chain((0..count).rev()) {
                let Some(fan) = &track.fans[k] else { continue };
                let window = track.window(params, k);
                let place = (&track.curve, window, track.reach(reach, k));
                let moved = newton::visit(problem, positions, fan, place, (step, floor));
                if let Some((param, position)) = moved {
                    params[k] = param;
                    positions[fan.own() as usize] = position;
                }
            }
        }
    }

    /// Of vertices with these numbers in the mesh, ascending, those that are not on their curve, or not between the neighbors they were
    /// given on it, with the vertices at `points`. Coordinates may be wrong by `rounding`.
    pub(crate) fn astray(&self, vertices: &[u32], points: &[[f64; 2]], rounding: f64) -> Vec<u32> {
        let mut astray = vertices.to_vec();
        for track in &self.tracks {
            let own = |(k, &v): (usize, &u32)| {
                let at = DVec2::from(points[v as usize]);
                let was = track.curve.params()[k];
                let has_moved = vertices.binary_search(&v).is_ok();
                if has_moved { track.curve.find(at, k, rounding) } else { Some(was) }
            };
            let found: Vec<Option<f64>> = track.vertices.iter().enumerate().map(own).collect();
            let mut good = Vec::new();
            for (k, fan) in track.fans.iter().enumerate() {
                let neighbor = |to: isize| track.neighbor(k, to, |i| found[i]);
                if let (Some(_), Some(at)) = (fan, found[k])
                    && neighbor(-1).is_none_or(|before| before < at)
                    && neighbor(1).is_none_or(|after| at < after)
                {
                    good.push(track.vertices[k]);
                }
            }
            good.sort_unstable();
            astray.retain(|v| good.binary_search(v).is_err());
        }
        astray
    }
}

impl Track {
    /// What is known of the vertex before (-1) or after (1) another one, as a parameter that goes on around a closed curve.
    fn neighbor(&self, k: usize, to: isize, known: impl Fn(usize) -> Option<f64>) -> Option<f64> {
        let (at, count) = (k as isize + to, self.vertices.len() as isize);
        let turns = at.div_euclid(count);
        let param = known(at.rem_euclid(count) as usize)?;
        Some(param + turns as f64 * self.curve.period())
    }

    /// How far a vertex may go.
    fn reach(&self, reach: &[f64], k: usize) -> Reach {
        Reach { start: self.curve.params()[k], most: reach[k] }
    }

    /// Where a vertex is on its curve, and its neighbors.
    fn window(&self, params: &[f64], k: usize) -> Window {
        let neighbor = |to| self.neighbor(k, to, |i| Some(params[i])).unwrap_or(params[k]);
        Window { low: neighbor(-1), at: params[k], high: neighbor(1) }
    }
}
