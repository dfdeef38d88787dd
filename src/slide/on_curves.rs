//! The state of sliding vertices in a run: their parameters along the curves, and the bounds of their moves.

use std::sync::Arc;

use glam::DVec2;

use crate::layout::Problem;
use crate::patch::Fan;
use crate::run::{EngineState, SweepParams};
use crate::slide::clusters::Cluster;
use crate::slide::curve::Place;
use crate::slide::newton::{self, CurveStep, OfPatch, Rule, Visited};
use crate::slide::params::Params;
use crate::slide::side::BoundaryCurve;
use crate::slide::sliding::Sliding;
use crate::slide::track::Track;

/// Number of successive sweeps that press a vertex against a bound, after which the vertex stays for the rest of the run.
/// Two neighbors at their common bound could otherwise follow the bound in tiny steps, which keep a run from ending. In a
/// prototype, two and three sweeps made no difference.
pub(crate) const FREEZES_AFTER: i8 = 3;

/// Length of a Newton step below which the step is short.
const SHORT: f64 = 0.2;
/// Number of short steps after which neighbors at a common bound no longer move together.
const MOST_SHORT: u8 = 2;
/// Share of its reach from which on a vertex is at its bound.
const AT_REACH: f64 = 1.0 - 1e-5;

/// Share by which the bound on altitudes is raised, as a reserve for rounding.
const ROUNDING: f64 = 1e-9;

/// Names of the parameters, of the counts of presses, of the parameters of the best state, and of the count of short steps in a
/// saved state.
const NAMES: [&str; 4] = ["curve parameters", "presses", "best curve parameters", "short steps"];

/// The sliding vertices of a run, with their present parameters. A clone shares the curves.
#[derive(Clone, Debug)]
pub(crate) struct OnCurves {
    sliding: Arc<Sliding>,
    /// Largest distance of each vertex from its given position, in the unit of the mesh.
    reach: Arc<Params>,
    /// Lower limit of altitudes, normalized; 0 for no limit.
    least_altitude: f64,
    params: Params,
    /// For each vertex, the number of latest sweeps that pressed the vertex against a bound, at most [`FREEZES_AFTER`];
    /// negative toward smaller parameters.
    presses: Vec<Vec<i8>>,
    /// Number of short Newton steps, at most [`MOST_SHORT`].
    short: u8,
    /// Number of vertices, partners included, that stayed at a bound in the latest Newton step. `None` before the first.
    held: Option<usize>,
}

/// A sliding vertex as an unknown of a Newton step: the length of its way along the curve.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tangent {
    /// Unit tangent at the vertex, in the direction of ascending parameters.
    pub(crate) along: DVec2,
    /// Contribution of the bend of the curve to the second derivative of the sum of q² by the length: the gradient times the
    /// second derivative of the position.
    pub(crate) curvature: f64,
    /// Length by parameter.
    speed: f64,
    /// Index of the unknown of the vertex. Partners share an unknown, and so do neighbors at a common bound.
    pub(crate) unknown: u32,
    /// Share of the vertex in its unknown. The sum of the squares of the shares is 1.
    pub(crate) share: f64,
    /// Whether the vertex stays in the step: at a bound toward which the objective falls, or frozen.
    pub(crate) is_held: bool,
}

/// The sliding vertices as unknowns of a Newton step.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tangents {
    /// The vertices, curve by curve, each followed by its partner.
    pub(crate) vertices: Vec<Tangent>,
    /// For each unknown, the part of the second derivative that comes from bounds along which vertices move together.
    pub(crate) curvatures: Vec<f64>,
}

impl Tangents {
    /// Makes the tangents of vertices that stay zero. If not `is_exact`, negative curvatures count as 0. Returns whether all
    /// curvatures are exact.
    pub(crate) fn restrict(&mut self, is_exact: bool) -> bool {
        let mut all_exact = true;
        let mut count = |curvature: &mut f64| {
            if !is_exact && *curvature < 0.0 {
                (*curvature, all_exact) = (0.0, false);
            }
        };
        for vertex in &mut self.vertices {
            if vertex.is_held {
                (vertex.along, vertex.curvature) = (DVec2::ZERO, 0.0);
            }
            count(&mut vertex.curvature);
        }
        self.curvatures.iter_mut().for_each(count);
        all_exact
    }
}

impl OnCurves {
    /// Returns the sliding vertices at their given positions. `reach` limits the distances of vertices from these positions,
    /// if given. `least_altitude` is the lower limit of altitudes, 0 for no limit.
    pub(crate) fn new(sliding: Arc<Sliding>, reach: Option<Params>, least_altitude: f64) -> Self {
        let reach = reach.unwrap_or_else(|| sliding.for_each_vertex(|_| f64::INFINITY));
        let params = sliding.start();
        let presses = params.iter().map(|of_curve| vec![0; of_curve.len()]).collect();
        let (least_altitude, reach) = (least_altitude * (1.0 + ROUNDING), Arc::new(reach));
        Self { sliding, reach, least_altitude, params, presses, short: 0, held: None }
    }

    pub(crate) fn sliding(&self) -> &Sliding {
        &self.sliding
    }

    pub(crate) fn params(&self) -> &Params {
        &self.params
    }

    /// Returns the largest distance of each vertex from its given position, in the unit of the mesh.
    #[cfg(feature = "gpu")]
    pub(super) fn reach(&self) -> &Params {
        &self.reach
    }

    /// Returns for each vertex the number of latest sweeps that pressed it against a bound.
    #[cfg(feature = "gpu")]
    pub(super) fn presses(&self) -> &[Vec<i8>] {
        &self.presses
    }

    /// Sets the numbers that [`presses`](Self::presses) returns.
    #[cfg(feature = "gpu")]
    pub(super) fn set_presses(&mut self, presses: impl Iterator<Item = Vec<i8>>) {
        self.presses = presses.collect();
    }

    /// Writes the positions of all sliding vertices at their parameters.
    #[cfg(feature = "gpu")]
    pub(crate) fn write_positions(&self, problem: &Problem, positions: &mut [DVec2]) {
        for (vertex, at) in self.placed(problem, &self.params) {
            positions[vertex as usize] = at;
        }
    }

    /// Returns the sliding vertices that have moved, as indices in the mesh with their positions in the unit of the mesh.
    pub(crate) fn moved(&self) -> Vec<(u32, [f64; 2])> {
        self.sliding.moved(&self.params)
    }

    /// Sets the parameters of an earlier state of the same run.
    pub(crate) fn set_params(&mut self, params: &Params) {
        self.params.clone_from(params);
    }

    /// Visits every sliding vertex once, curve by curve, with one safeguarded Newton step along the curve by `step`. Partners
    /// move together.
    pub(crate) fn sweep(&mut self, problem: &Problem, positions: &mut [DVec2], step: &SweepParams) {
        let Self { sliding, reach, least_altitude, params, presses, .. } = self;
        let rule = Rule { by: step, least_altitude: *least_altitude };
        let all = sliding.tracks.iter().zip(params).zip(reach.iter().zip(presses));
        for ((track, params), (reach, presses)) in all {
            for k in (0..params.len()).filter(|&k| track.slides(k)) {
                if presses[k].abs() >= FREEZES_AFTER {
                    continue;
                }
                let (window, reach) = (track.window(params, k), track.reach(reach, k));
                let vertex = Visited { sides: &track.sides, k, window, reach };
                let CurveStep { to, pressed } = newton::visit(problem, positions, vertex, rule);
                let same = pressed * presses[k].signum() > 0;
                presses[k] = pressed + if same { presses[k] } else { 0 };
                if let Some(param) = to {
                    params[k] = param;
                    track.follow(problem, k, param, positions);
                }
            }
        }
    }

    /// Visits the sliding vertices of which `chosen` returns true for the vertex or its partner, each once, with a Newton step of
    /// another function than that of the run. Returns the vertices that have moved, as indices in the mesh with
    /// their positions in the unit of the mesh.
    pub(crate) fn visit_by(
        &mut self,
        by: &dyn OfPatch,
        problem: &Problem,
        positions: &mut [DVec2],
        chosen: impl Fn(u32) -> bool,
    ) -> Vec<(u32, [f64; 2])> {
        let Self { sliding, reach, least_altitude, params, .. } = self;
        let rule = Rule { by, least_altitude: *least_altitude };
        let mut moved = Vec::new();
        for ((track, params), reach) in sliding.tracks.iter().zip(params).zip(reach.iter()) {
            for k in (0..params.len()).filter(|&k| track.slides(k)) {
                let own =
                    || track.sides.iter().filter_map(|side| side.fans[k].as_ref().map(Fan::own));
                if !own().any(&chosen) {
                    continue;
                }
                let (window, reach) = (track.window(params, k), track.reach(reach, k));
                let vertex = Visited { sides: &track.sides, k, window, reach };
                let Some(param) = newton::visit(problem, positions, vertex, rule).to else {
                    continue;
                };
                params[k] = param;
                track.follow(problem, k, param, positions);
                let there =
                    |side: &BoundaryCurve| (side.vertices[k], side.curve.at(param, k).point.into());
                moved.extend(track.sides.iter().map(there));
            }
        }
        moved
    }

    /// Returns the sliding vertices in the order of [`Self::tangents`], as indices in the problem, with their triangles.
    pub(crate) fn fans(&self) -> impl Iterator<Item = &Fan> {
        let tracks = self.sliding.tracks.iter();
        tracks.flat_map(|track| {
            let sliding = (0..track.count()).filter(|&k| track.slides(k));
            sliding.flat_map(|k| track.sides.iter().filter_map(move |side| side.fans[k].as_ref()))
        })
    }

    /// Returns the sliding vertices as unknowns of a Newton step. `gradient` returns the gradient of the sum of q² at the vertex of
    /// a fan.
    pub(crate) fn tangents(
        &mut self,
        problem: &Problem,
        gradient: impl Fn(&Fan) -> DVec2,
    ) -> Tangents {
        let mut tangents = Tangents::default();
        let joins = self.short < MOST_SHORT;
        for (at, track) in self.sliding.tracks.iter().enumerate() {
            let params = &self.params[at];
            let (mut slopes, mut speeds) = (vec![0.0; params.len()], vec![1.0; params.len()]);
            let first = tangents.vertices.len();
            let sides = track.sides.len();
            for k in (0..params.len()).filter(|&k| track.slides(k)) {
                for side in &track.sides {
                    let Some(fan) = &side.fans[k] else { continue };
                    let Place { first, second, .. } = side.at(problem, params[k], k);
                    let (gradient, speed) = (gradient(fan), first.length());
                    let along = first / speed;
                    slopes[k] += gradient.dot(along);
                    speeds[k] = speed;
                    tangents.vertices.push(Tangent {
                        along,
                        curvature: gradient.dot(second) / (speed * speed),
                        speed,
                        unknown: tangents.curvatures.len() as u32,
                        share: (sides as f64).sqrt().recip(),
                        is_held: false,
                    });
                }
                tangents.curvatures.push(0.0);
            }
            let stays: Vec<bool> =
                (0..params.len()).map(|k| self.stays(at, k, slopes[k], joins)).collect();
            let index = |k: usize| first + (k - usize::from(!track.slides(0))) * sides;
            let own = |k: usize| index(k)..index(k) + sides;
            for k in (0..params.len()).filter(|&k| track.slides(k) && stays[k]) {
                tangents.vertices[own(k)].iter_mut().for_each(|vertex| vertex.is_held = true);
            }
            if !joins {
                continue;
            }
            for cluster in track.clusters(params, &slopes, &speeds, &stays) {
                let Cluster { members, is_held, curvature } = cluster;
                let sliding: Vec<_> =
                    members.into_iter().filter(|(k, _)| track.slides(*k)).collect();
                let Some(&(k, _)) = sliding.first() else { continue };
                let unknown = tangents.vertices[index(k)].unknown;
                tangents.curvatures[unknown as usize] = curvature;
                for (k, share) in sliding {
                    for vertex in &mut tangents.vertices[own(k)] {
                        (vertex.unknown, vertex.is_held) = (unknown, vertex.is_held || is_held);
                        vertex.share *= share;
                    }
                }
            }
        }
        self.held = Some(tangents.vertices.iter().filter(|vertex| vertex.is_held).count());
        tangents
    }

    /// Returns whether a vertex of a track stays in a Newton step because of a bound of its own. `slope` is the derivative of
    /// the objective by the length of its way, and `joins` whether neighbors at a common bound move together.
    fn stays(&self, track: usize, k: usize, slope: f64, joins: bool) -> bool {
        let (presses, param) = (self.presses[track][k], self.params[track][k]);
        // The objective falls against its slope.
        if !joins {
            return presses.abs() >= FREEZES_AFTER || slope * f64::from(presses.signum()) < 0.0;
        }
        let of_track = &self.sliding.tracks[track];
        let reach = of_track.reach(&self.reach[track], k);
        let is_outward = slope * (param - reach.start) < 0.0;
        let mut sides = of_track.sides.iter();
        is_outward && sides.any(|side| reach.used(&side.curve, param) >= AT_REACH)
    }

    /// Records the length of a Newton step. After the second short step, neighbors at a common bound no longer move
    /// together.
    pub(crate) fn record_step(&mut self, length: f64) {
        if length < SHORT {
            self.short = (self.short + 1).min(MOST_SHORT);
        }
    }

    /// Returns the parameters after moves by the given lengths along the tangents, shortened where a move would break a bound.
    /// `lengths` are in the order of `tangents`.
    pub(crate) fn along(&self, tangents: &Tangents, lengths: impl Fn(usize) -> f64) -> Params {
        let mut at = 0;
        let mut all = self.params.clone();
        for ((track, to), (from, reach)) in
            self.sliding.tracks.iter().zip(&mut all).zip(self.params.iter().zip(self.reach.iter()))
        {
            for k in (0..to.len()).filter(|&k| track.slides(k)) {
                to[k] += lengths(at) / tangents.vertices[at].speed;
                at += track.sides.len();
            }
            track.shorten(from, to, reach);
        }
        all
    }

    /// Returns the sliding vertices at the given parameters, as indices in the problem with their positions.
    pub(crate) fn placed(
        &self,
        problem: &Problem,
        params: &Params,
    ) -> impl Iterator<Item = (u32, DVec2)> {
        let all = self.sliding.tracks.iter().zip(params);
        all.flat_map(move |(track, params)| {
            let each = params.iter().enumerate();
            each.flat_map(move |(k, &param)| track.placed(problem, k, param))
        })
    }

    /// Returns the number of vertices, partners included, that stay at a bound: those of the latest Newton step, or those that
    /// sweeps have pressed against a bound too often.
    pub(crate) fn frozen(&self) -> usize {
        let all = self.sliding.tracks.iter().zip(&self.presses);
        let of_track = |(track, presses): (&Track, &Vec<i8>)| {
            let frozen = presses.iter().filter(|presses| presses.abs() >= FREEZES_AFTER).count();
            frozen * track.sides.len()
        };
        self.held.unwrap_or_else(|| all.map(of_track).sum())
    }

    /// Adds the parameters and the counts of presses to a saved state, and the parameters of the best state if given.
    pub(crate) fn save(&self, best: Option<&Params>, state: &mut EngineState) {
        let [params, presses, of_best, short] = NAMES;
        state.own.add_list(params, &self.params.concat());
        state.own.add_list(presses, &self.presses.concat());
        state.own.add(short, self.short);
        if let Some(best) = best {
            state.own.add_list(of_best, &best.concat());
        }
    }

    /// Returns to a saved state. Returns the parameters of the best state too, if the state has any. `None` if the state
    /// belongs to other curves.
    pub(crate) fn restore(&mut self, state: &EngineState) -> Option<Option<Params>> {
        let count = self.params.iter().map(Vec::len).sum();
        let [params, presses, of_best, short] = NAMES;
        let params = self.read(state, params, count)?;
        let short: u8 = state.own.one(short)?;
        let presses: Vec<i8> = state.own.list_of(presses, count)?;
        let of_best = self.read(state, of_best, count);
        (self.params, self.short) = (params, short.min(MOST_SHORT));
        let mut presses =
            presses.into_iter().map(|presses| presses.clamp(-FREEZES_AFTER, FREEZES_AFTER));
        for of_curve in &mut self.presses {
            of_curve.iter_mut().zip(&mut presses).for_each(|(to, presses)| *to = presses);
        }
        Some(of_best)
    }

    /// Reads parameters of a saved state. `None` if they do not fit the curves.
    fn read(&self, state: &EngineState, name: &str, count: usize) -> Option<Params> {
        let mut all = state.own.list_of::<f64>(name, count)?.into_iter();
        let of_curve = |of_curve: &Vec<f64>| all.by_ref().take(of_curve.len()).collect();
        let params: Params = self.params.iter().map(of_curve).collect();
        let is_finite = params.iter().flatten().all(|param| param.is_finite());
        (is_finite && self.sliding.is_in_order(&params)).then_some(params)
    }
}
