//! Visits of sliding vertices: safeguarded Newton steps along a curve.

use glam::DVec2;

use crate::layout::Problem;
use crate::metric::{AnyFormulas, Dual, Smoothing};
use crate::patch::{
    Corners, Direction, FanPatch, MetricObjective, Objective, SearchRule, step_alone,
};
use crate::run::SweepParams;
use crate::slide::curve::{Curve, Place};
use crate::slide::side::BoundaryCurve;

/// Limit of a step, as a share of the parameter distance to the neighboring vertex on the curve.
const MAX_STEP_SHARE: f64 = 0.8;

/// Curve parameters of a vertex (`at`) and of its neighbors before (`low`) and after (`high`).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Window {
    pub(crate) low: f64,
    pub(crate) at: f64,
    pub(crate) high: f64,
}

/// The vertex that a visit moves.
#[derive(Clone, Copy)]
pub(crate) struct Visited<'a> {
    /// The curve of the vertex. If the vertex has a partner, the second side is the curve of the partner.
    pub(crate) sides: &'a [BoundaryCurve],
    /// Index of the vertex in its track.
    pub(crate) k: usize,
    pub(crate) window: Window,
    pub(crate) reach: Reach,
}

/// The objective and the bounds by which vertices slide.
#[derive(Clone, Copy)]
pub(crate) struct Rule<'a> {
    pub(crate) step: &'a SweepParams,
    /// Lower limit of the altitudes of triangles, in normalized units; 0 for no limit.
    pub(crate) floor: f64,
}

/// Limit of the distance between a sliding vertex and its given position.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reach {
    /// Index of the vertex on its curve.
    pub(crate) vertex: usize,
    /// Curve parameter of the given position.
    pub(crate) start: f64,
    /// Largest distance from the given position, in the unit of the mesh; infinite for no bound.
    pub(crate) most: f64,
}

impl Reach {
    /// Returns whether the curve point at a parameter is in reach of the given position.
    pub(crate) fn allows(self, curve: &Curve, at: f64) -> bool {
        let point = |param| curve.at(param, self.vertex).point;
        self.most.is_infinite() || point(at).distance(point(self.start)) <= self.most
    }

    /// Returns a step `way` from the parameter `at`, shortened to end in reach if the curve is straight.
    fn shortened(self, way: f64, at: f64) -> f64 {
        if self.most.is_infinite() {
            return way;
        }
        let most = self.most * (1.0 - ROUNDING);
        (at + way).clamp(self.start - most, self.start + most) - at
    }
}

/// Share by which [`Reach::most`] is reduced, so that rounding cannot exceed the bound.
const ROUNDING: f64 = 1e-9;

/// Takes one Newton step along the curve by [`SearchRule::CURVE`]. Returns the new parameter, or `None` if the vertex
/// stays. No altitude falls below the floor of `rule`. A step moves vertex `k` of a curve, or both vertices `k` of two
/// curves with common parameters. For two curves, the objective is the sum over both patches, and both patches must
/// allow the step.
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
    let objective = CurveObjective { problem, on_curves, k, window, reach, step: rule.step };
    let Window { low, at, high } = window;
    let ([to, _], has_stepped) = step_alone(&objective, [at, 0.0], &SearchRule::CURVE);
    (has_stepped && to != at && low < to && to < high).then_some(to)
}

/// The visited vertex or its partner, with its curve and patch.
struct OnCurve<'a> {
    side: &'a BoundaryCurve,
    /// Present position of the vertex, normalized.
    here: DVec2,
    patch: FanPatch,
}

/// The summed objective of a vertex and its partner, as a function of the common curve parameter. The search works in
/// points (parameter, 0).
struct CurveObjective<'a> {
    problem: &'a Problem,
    on_curves: Vec<OnCurve<'a>>,
    /// Index of the vertex in its track.
    k: usize,
    window: Window,
    reach: Reach,
    step: &'a SweepParams,
}

impl CurveObjective<'_> {
    fn metric<'p>(&self, patch: &'p FanPatch) -> MetricObjective<'p, FanPatch, AnyFormulas> {
        let SweepParams { metric, sharpness, shape_guard, .. } = *self.step;
        let smoothing = Smoothing::of(sharpness);
        MetricObjective { patch, formulas: metric.formulas(), smoothing, shape_guard }
    }
}

impl Objective<f64> for CurveObjective<'_> {
    fn expansion(&self, [at, _]: [f64; 2]) -> Dual {
        let (mut value, mut slope, mut curvature) = (0.0, 0.0, 0.0);
        for OnCurve { side, here, patch } in &self.on_curves {
            let Place { first, second, .. } = side.at(self.problem, at, self.k);
            let transformed = self.metric(patch).expansion(here.to_array());
            let gradient = DVec2::from(transformed.gradient);
            let [xx, xy, yy] = transformed.hessian;
            let hessian = DVec2::new(xx * first.x + xy * first.y, xy * first.x + yy * first.y);
            value += transformed.value;
            slope += gradient.dot(first);
            curvature += hessian.dot(first) + gradient.dot(second);
        }
        Dual { value, gradient: [slope, 0.0], hessian: [curvature, 0.0, 0.0] }
    }

    /// Returns the Newton step of the parameter, shortened so that vertices keep their order on the curve.
    fn direction(&self, here: &Dual, _: f64) -> Direction<f64> {
        let Window { low, at, high } = self.window;
        let ([slope, _], [curvature, ..]) = (here.gradient, here.hessian);
        let newton = -slope / curvature.abs();
        let way = newton.clamp(MAX_STEP_SHARE * (low - at), MAX_STEP_SHARE * (high - at));
        let way = self.reach.shortened(way, at);
        Direction { vector: [way, 0.0], slope: slope * way, descends: newton.is_finite() }
    }

    fn trial(&self, [to, _]: [f64; 2], max_imr: f64) -> (f64, bool) {
        let mut sum = 0.0;
        for OnCurve { side, patch, .. } in &self.on_curves {
            let curve = &side.curve;
            if !curve.is_near([self.window.low, to, self.window.high], self.k)
                || !self.reach.allows(curve, to)
            {
                return (sum, false);
            }
            let point = side.at(self.problem, to, self.k).point.to_array();
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
