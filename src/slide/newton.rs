//! Visits of vertices on curves: safeguarded Newton steps along the curve.

use glam::DVec2;

use crate::layout::Problem;
use crate::run::{Step, line_search};
use crate::slide::curve::{Curve, Place};
use crate::slide::patch::{Fan, Patch};

/// The largest share of the way to a neighbor on the curve that a step may go.
const NEAREST: f64 = 0.8;

/// The parameters of a vertex and its neighbors on a curve.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Window {
    pub(crate) low: f64,
    pub(crate) at: f64,
    pub(crate) high: f64,
}

/// How far a vertex may be from where it was given.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reach {
    /// The parameter of where it was given.
    pub(crate) start: f64,
    /// The largest distance from there, in the unit of the mesh; infinite for none.
    pub(crate) most: f64,
}

impl Reach {
    /// Whether a vertex may be at a parameter.
    pub(crate) fn allows(self, curve: &Curve, at: f64) -> bool {
        self.most.is_infinite()
            || curve.at(at).point.distance(curve.at(self.start).point) <= self.most
    }

    /// A way from a parameter, cut off where a straight curve goes out of reach.
    fn shortened(self, way: f64, at: f64) -> f64 {
        if self.most.is_infinite() {
            return way;
        }
        let most = self.most * (1.0 - ROUNDING);
        (at + way).clamp(self.start - most, self.start + most) - at
    }
}

/// How much rounding may add to the distance from where a vertex was given, as a share of it.
const ROUNDING: f64 = 1e-9;

/// One Newton step along the curve, with a line search as in the sweeps over free vertices. No altitude falls below `floor`. Returns the new parameter and position of
/// the vertex, if it moves.
pub(crate) fn visit(
    problem: &Problem,
    positions: &[DVec2],
    fan: &Fan,
    (curve, window, reach): (&Curve, Window, Reach),
    (step, floor): (&Step, f64),
) -> Option<(f64, DVec2)> {
    let Window { low, at, high } = window;
    let (center, scale) = problem.normalization();
    let Place { first, second, .. } = curve.at(at);
    let (first, second) = (first * scale, second * scale);
    let patch = Patch { problem, positions, fan, step, floor };
    let here = positions[fan.own() as usize];
    let sum = patch.derivatives(here);
    let gradient = DVec2::from(sum.gradient);
    let [xx, xy, yy] = sum.hessian;
    let hessian = DVec2::new(xx * first.x + xy * first.y, xy * first.x + yy * first.y);
    let slope = gradient.dot(first);
    let curvature = (hessian.dot(first) + gradient.dot(second)).abs();
    let newton = -slope / curvature;
    if !newton.is_finite() {
        return None;
    }
    let way = newton.clamp(NEAREST * (low - at), NEAREST * (high - at));
    let way = reach.shortened(way, at);
    let squares = sum.value + fan.degree() as f64 * step.metric.ideal_squared();
    let most = sum.value + squares * SLACK;
    let limit = match step.shape_guard.is_finite() {
        true => step.shape_guard.max(patch.worst_shape(here)),
        false => f64::INFINITY,
    };
    let mut length = 1.0;
    for _ in 0..line_search::TRIALS {
        let to = at + way * length;
        let position = (curve.at(to).point - center) * scale;
        let value = match curve.is_near([low, to, high]) && reach.allows(curve, to) {
            true => patch.objective(position, limit),
            false => None,
        };
        let wanted = line_search::SUFFICIENT_DECREASE * slope * way * length;
        match value {
            Some(value) if value <= most + wanted => {
                return (to != at && low < to && to < high).then_some((to, position));
            }
            Some(_) => length *= line_search::SHORTEN,
            None => length *= line_search::SHORTEN_INFEASIBLE,
        }
    }
    None
}

/// How much rounding may add to the objective of a patch, relative to the sum of q².
const SLACK: f64 = 1e-12;
