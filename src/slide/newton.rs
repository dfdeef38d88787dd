//! Visits of vertices on curves: safeguarded Newton steps along the curve.

use glam::DVec2;

use crate::layout::Problem;
use crate::patch::{SUFFICIENT_DECREASE, SearchRule};
use crate::run::Step;
use crate::slide::curve::{Curve, Place};
use crate::slide::patch::Patch;
use crate::slide::side::Side;

/// A step may go at most this share of the way to a neighbor on the curve.
const NEAREST: f64 = 0.8;

/// The parameters of a vertex and its neighbors on a curve.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Window {
    pub(crate) low: f64,
    pub(crate) at: f64,
    pub(crate) high: f64,
}

/// The vertex that a visit moves.
#[derive(Clone, Copy)]
pub(crate) struct Visited<'a> {
    /// The sides of the vertex's track: the curve itself, and the curve of its partner if it has one.
    pub(crate) sides: &'a [Side],
    /// The index of the vertex in its track.
    pub(crate) k: usize,
    pub(crate) window: Window,
    pub(crate) reach: Reach,
}

/// The rule by which vertices move.
#[derive(Clone, Copy)]
pub(crate) struct Rule<'a> {
    pub(crate) step: &'a Step,
    /// The least altitude that a triangle may have, normalized; 0 for no bound.
    pub(crate) floor: f64,
}

/// A bound on how far a vertex may be from its given position.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reach {
    /// The parameter of the given position.
    pub(crate) start: f64,
    /// The largest distance from the given position, in the unit of the mesh; infinite for no bound.
    pub(crate) most: f64,
}

impl Reach {
    /// Whether a vertex may be at a parameter.
    pub(crate) fn allows(self, curve: &Curve, at: f64) -> bool {
        self.most.is_infinite()
            || curve.at(at).point.distance(curve.at(self.start).point) <= self.most
    }

    /// Returns a step from a parameter, shortened so that it stays in reach if the curve is straight.
    fn shortened(self, way: f64, at: f64) -> f64 {
        if self.most.is_infinite() {
            return way;
        }
        let most = self.most * (1.0 - ROUNDING);
        (at + way).clamp(self.start - most, self.start + most) - at
    }
}

/// The share of the distance from the given position that rounding may add.
const ROUNDING: f64 = 1e-9;

/// Takes one Newton step along the curve, with a line search as in the sweeps over free vertices. No altitude falls
/// below `floor`. Returns the new parameter if the vertices move. The step moves the vertex `k` of a curve, or both
/// vertices `k` of two curves that share their parameters. In the latter case it is the step for the sum over both
/// patches, and both patches must allow it.
pub(crate) fn visit(
    problem: &Problem,
    positions: &[DVec2],
    vertex: Visited<'_>,
    rule: Rule<'_>,
) -> Option<f64> {
    let Visited { sides, k, window: Window { low, at, high }, reach } = vertex;
    let Rule { step, floor } = rule;
    let patches = || {
        sides.iter().filter_map(|side| {
            let fan = side.fans[k].as_ref()?;
            Some((side, Patch { problem, positions, fan, step, floor }))
        })
    };
    let (mut slope, mut curvature, mut sum, mut degree) = (0.0, 0.0, 0.0, 0);
    let mut limit = step.shape_guard;
    for (side, patch) in patches() {
        let Place { first, second, .. } = side.at(problem, at);
        let here = positions[patch.fan.own() as usize];
        let shown = patch.derivatives(here);
        let gradient = DVec2::from(shown.gradient);
        let [xx, xy, yy] = shown.hessian;
        let hessian = DVec2::new(xx * first.x + xy * first.y, xy * first.x + yy * first.y);
        slope += gradient.dot(first);
        curvature += hessian.dot(first) + gradient.dot(second);
        sum += shown.value;
        degree += patch.fan.degree();
        if limit.is_finite() {
            limit = limit.max(patch.worst_shape(here));
        }
    }
    let newton = -slope / curvature.abs();
    if !newton.is_finite() {
        return None;
    }
    let way = newton.clamp(NEAREST * (low - at), NEAREST * (high - at));
    let way = reach.shortened(way, at);
    let squares = sum + degree as f64 * step.metric.ideal_squared();
    let most = sum + squares * SLACK;
    let objective = |to: f64| {
        patches().try_fold(0.0, |sum, (side, patch)| {
            let curve = &side.curve;
            let is_allowed = curve.is_near([low, to, high]) && reach.allows(curve, to);
            let value = || patch.objective(side.at(problem, to).point, limit);
            is_allowed.then(value).flatten().map(|value| sum + value)
        })
    };
    let mut length = 1.0;
    for _ in 0..SearchRule::SWEEP.trials {
        let to = at + way * length;
        let wanted = SUFFICIENT_DECREASE * slope * way * length;
        match objective(to) {
            Some(value) if value <= most + wanted => {
                return (to != at && low < to && to < high).then_some(to);
            }
            Some(_) => length *= SearchRule::SWEEP.shorten,
            None => length *= SearchRule::SWEEP.shorten_infeasible,
        }
    }
    None
}

/// The share of the sum of q² that rounding may add to the objective of a patch.
const SLACK: f64 = 1e-12;
