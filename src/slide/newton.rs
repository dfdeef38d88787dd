//! Visits of vertices on curves: safeguarded Newton steps along the curve.

use glam::DVec2;

use crate::layout::Problem;
use crate::metric::{AnyFormulas, Dual, Smoothing};
use crate::patch::{
    Corners, Direction, FanPatch, MetricObjective, Objective, SearchRule, step_alone,
};
use crate::run::Step;
use crate::slide::curve::{Curve, Place};
use crate::slide::side::Side;

/// Limit of a step, as a share of the parameter distance to the neighboring vertex on the curve.
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
    /// The curves of the vertex and, if the vertex has a partner, of the partner.
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
    /// Lower limit of triangles' altitudes, normalized; 0 for no limit.
    pub(crate) floor: f64,
}

/// Limits the distance of a vertex from its given position.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reach {
    /// The parameter of the given position.
    pub(crate) start: f64,
    /// The largest distance from the given position, in the unit of the mesh; infinite for no bound.
    pub(crate) most: f64,
}

impl Reach {
    /// Whether the curve point of a parameter is in reach.
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

/// Takes one Newton step along the curve by [`SearchRule::CURVE`]. No altitude falls below the floor of `rule`. Returns
/// the new parameter if the vertices move. The step moves the vertex `k` of a curve, or both vertices `k` of two curves
/// that share their parameters. For two curves the objective is the sum over both patches, and both patches must allow
/// the step.
pub(crate) fn visit(
    problem: &Problem,
    positions: &[DVec2],
    vertex: Visited<'_>,
    rule: Rule<'_>,
) -> Option<f64> {
    let Visited { sides, k, window, reach } = vertex;
    let mut on_curves = Vec::new();
    for side in sides {
        if let Some(fan) = &side.fans[k] {
            let (here, patch) =
                (positions[fan.own() as usize], fan.patch(problem, positions, rule.floor));
            on_curves.push(OnCurve { side, here, patch });
        }
    }
    let objective = CurveObjective { problem, on_curves, window, reach, step: rule.step };
    let Window { low, at, high } = window;
    let ([to, _], has_stepped) = step_alone(&objective, [at, 0.0], &SearchRule::CURVE);
    (has_stepped && to != at && low < to && to < high).then_some(to)
}

/// The visited vertex, or its partner, on its curve.
struct OnCurve<'a> {
    side: &'a Side,
    /// The present position of the vertex.
    here: DVec2,
    patch: FanPatch,
}

/// The summed objective of a vertex and its partner, as a function of their common curve parameter. Positions of the
/// search are (parameter, 0).
struct CurveObjective<'a> {
    problem: &'a Problem,
    on_curves: Vec<OnCurve<'a>>,
    window: Window,
    reach: Reach,
    step: &'a Step,
}

impl CurveObjective<'_> {
    fn metric<'p>(&self, patch: &'p FanPatch) -> MetricObjective<'p, FanPatch, AnyFormulas> {
        let Step { metric, sharpness, shape_guard, .. } = *self.step;
        let smoothing = Smoothing::of(sharpness);
        MetricObjective { patch, formulas: metric.formulas(), smoothing, shape_guard }
    }
}

impl Objective<f64> for CurveObjective<'_> {
    fn expansion(&self, [at, _]: [f64; 2]) -> Dual {
        let (mut value, mut slope, mut curvature) = (0.0, 0.0, 0.0);
        for OnCurve { side, here, patch } in &self.on_curves {
            let Place { first, second, .. } = side.at(self.problem, at);
            let shown = self.metric(patch).expansion(here.to_array());
            let gradient = DVec2::from(shown.gradient);
            let [xx, xy, yy] = shown.hessian;
            let hessian = DVec2::new(xx * first.x + xy * first.y, xy * first.x + yy * first.y);
            value += shown.value;
            slope += gradient.dot(first);
            curvature += hessian.dot(first) + gradient.dot(second);
        }
        Dual { value, gradient: [slope, 0.0], hessian: [curvature, 0.0, 0.0] }
    }

    /// Returns the Newton step by the parameter, shortened to keep the order of the vertices on the curve.
    fn direction(&self, here: &Dual, _: f64) -> Direction<f64> {
        let Window { low, at, high } = self.window;
        let ([slope, _], [curvature, ..]) = (here.gradient, here.hessian);
        let newton = -slope / curvature.abs();
        let way = newton.clamp(NEAREST * (low - at), NEAREST * (high - at));
        let way = self.reach.shortened(way, at);
        Direction { vector: [way, 0.0], slope: slope * way, descends: newton.is_finite() }
    }

    fn trial(&self, [to, _]: [f64; 2], max_imr: f64) -> (f64, bool) {
        let mut sum = 0.0;
        for OnCurve { side, patch, .. } in &self.on_curves {
            let curve = &side.curve;
            if !curve.is_near([self.window.low, to, self.window.high])
                || !self.reach.allows(curve, to)
            {
                return (sum, false);
            }
            let point = side.at(self.problem, to).point.to_array();
            let (value, is_feasible) = self.metric(patch).trial(point, max_imr);
            if !is_feasible {
                return (sum, false);
            }
            sum += value;
        }
        (sum, true)
    }

    fn squares(&self, value: f64) -> f64 {
        let weight: f64 = self.on_curves.iter().map(|on| on.patch.total_weight()).sum();
        value + weight * self.step.metric.ideal_squared()
    }

    fn shape_guard(&self) -> f64 {
        self.step.shape_guard
    }

    fn worst_shape(&self, _: [f64; 2]) -> f64 {
        let shapes = self.on_curves.iter();
        shapes.map(|on| self.metric(&on.patch).worst_shape(on.here.to_array())).fold(0.0, f64::max)
    }
}
