//! Visits of sliding vertices: safeguarded Newton steps along a curve.

use std::cell::Cell;

use glam::DVec2;

use crate::layout::Problem;
use crate::metric::Dual;
use crate::patch::{Direction, Fan, FanPatch, MetricObjective, Objective, SearchRule, step_alone};
use crate::run::SweepParams;
use crate::slide::curve::{Curve, Place};
use crate::slide::side::BoundaryCurve;

/// Limit of a step, as a share of the parameter distance to the neighboring vertex on the curve.
pub(crate) const MAX_STEP_SHARE: f64 = 0.8;

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

/// A function of the triangles around a vertex that visits lower.
pub(crate) trait OfPatch: Sync {
    /// Returns the function of a patch.
    fn of<'p>(&'p self, patch: &'p FanPatch) -> Box<dyn Objective<f64> + 'p>;
}

impl OfPatch for SweepParams {
    fn of<'p>(&'p self, patch: &'p FanPatch) -> Box<dyn Objective<f64> + 'p> {
        let Self { metric, shape_guard, .. } = *self;
        let (formulas, smoothing) = (metric.formulas(), self.smoothing());
        Box::new(MetricObjective { patch, formulas, smoothing, shape_guard })
    }
}

/// The function and the bounds by which vertices slide.
#[derive(Clone, Copy)]
pub(crate) struct Rule<'a> {
    pub(crate) by: &'a dyn OfPatch,
    /// Lower limit of the altitudes of triangles, in normalized units; 0 for no limit.
    pub(crate) least_altitude: f64,
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
    /// Returns the distance of the curve point at a parameter from the given position, as a share of the largest distance.
    pub(crate) fn used(self, curve: &Curve, at: f64) -> f64 {
        let point = |param| curve.at(param, self.vertex).point;
        match self.most.is_infinite() {
            true => 0.0,
            false => point(at).distance(point(self.start)) / self.most,
        }
    }

    /// Returns whether the curve point at a parameter is in reach of the given position.
    pub(crate) fn allows(self, curve: &Curve, at: f64) -> bool {
        self.used(curve, at) <= 1.0 - ROUNDING
    }
}

/// Share by which [`Reach::most`] is reduced, so that rounding cannot exceed the bound.
const ROUNDING: f64 = 1e-9;

/// Number of halvings by which a step finds its end at a bound. The end is then within 1e-6 of the step.
pub(crate) const HALVINGS: u32 = 20;

/// The result of a visit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CurveStep {
    /// The new parameter, `None` if the vertex stays.
    pub(crate) to: Option<f64>,
    /// 1 or -1 if the Newton step led beyond a bound, toward larger or smaller parameters, and was cut off there; 0
    /// otherwise. Bounds are the distance of lines from given vertices, and the reach of the vertex.
    pub(crate) pressed: i8,
}

/// Takes one Newton step along the curve by [`SearchRule::CURVE`]. No altitude falls below the least altitude of `rule`. A step moves
/// vertex `k` of a curve, or both vertices `k` of two curves with common parameters. For two curves, the objective is the
/// sum over both patches, and both patches must allow the step.
pub(crate) fn visit(
    problem: &Problem,
    positions: &[DVec2],
    vertex: Visited<'_>,
    rule: Rule<'_>,
) -> CurveStep {
    let Visited { sides, k, window, reach } = vertex;
    let fans = || sides.iter().filter_map(|side| Some((side, side.fans[k].as_ref()?)));
    let patches: Vec<FanPatch> =
        fans().map(|(_, fan)| fan.patch(problem, positions, rule.least_altitude)).collect();
    let on_curve = |((side, fan), patch)| {
        let here = positions[Fan::own(fan) as usize];
        OnCurve { side, here, objective: rule.by.of(patch) }
    };
    let on_curves = fans().zip(&patches).map(on_curve).collect();
    let pressed = Cell::new(0);
    let objective = CurveObjective { problem, on_curves, k, window, reach, pressed };
    let Window { low, at, high } = window;
    let ([to, _], has_stepped) = step_alone(&objective, [at, 0.0], &SearchRule::CURVE);
    let to = (has_stepped && to != at && low < to && to < high).then_some(to);
    CurveStep { to, pressed: objective.pressed.get() }
}

/// The visited vertex or its partner, with its curve and patch.
struct OnCurve<'a> {
    side: &'a BoundaryCurve,
    /// Present position of the vertex, normalized.
    here: DVec2,
    objective: Box<dyn Objective<f64> + 'a>,
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
    /// See [`CurveStep::pressed`].
    pressed: Cell<i8>,
}

impl CurveObjective<'_> {
    /// Returns whether the lines to both neighbors stay near the given vertices, and the vertices in reach, with the vertices
    /// at the parameter `to`.
    fn is_within_bounds(&self, to: f64) -> bool {
        let Window { low, high, .. } = self.window;
        self.on_curves.iter().all(|OnCurve { side, .. }| {
            side.curve.is_near([low, to, high], self.k) && self.reach.allows(&side.curve, to)
        })
    }

    /// Returns a step from the present parameter, cut off at the bounds. A search that shortens steps by a factor instead
    /// would let vertices creep toward their bounds for hundreds of sweeps.
    fn within_bounds(&self, way: f64) -> f64 {
        let at = self.window.at;
        if !way.is_finite() || self.is_within_bounds(at + way) {
            return way;
        }
        self.pressed.set(if way > 0.0 { 1 } else { -1 });
        let (mut inside, mut outside) = (0.0, 1.0);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (inside + outside);
            match self.is_within_bounds(at + way * middle) {
                true => inside = middle,
                false => outside = middle,
            }
        }
        way * inside
    }
}

impl Objective<f64> for CurveObjective<'_> {
    fn expansion(&self, [at, _]: [f64; 2]) -> Dual {
        let (mut value, mut slope, mut curvature) = (0.0, 0.0, 0.0);
        for OnCurve { side, here, objective } in &self.on_curves {
            let Place { first, second, .. } = side.at(self.problem, at, self.k);
            let transformed = objective.expansion(here.to_array());
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
        let way = self.within_bounds(way);
        Direction { vector: [way, 0.0], slope: slope * way, descends: newton.is_finite() }
    }

    fn trial(&self, [to, _]: [f64; 2], max_imr: f64) -> (f64, bool) {
        let mut sum = 0.0;
        if !self.is_within_bounds(to) {
            return (sum, false);
        }
        for OnCurve { side, objective, .. } in &self.on_curves {
            let point = side.at(self.problem, to, self.k).point.to_array();
            let (value, is_feasible) = objective.trial(point, max_imr);
            if !is_feasible {
                return (sum, false);
            }
            sum += value;
        }
        (sum, true)
    }

    fn squares(&self, value: f64) -> f64 {
        value + self.on_curves.iter().map(|on| on.objective.squares(0.0)).sum::<f64>()
    }

    fn shape_guard(&self) -> f64 {
        self.on_curves.iter().map(|on| on.objective.shape_guard()).fold(f64::INFINITY, f64::min)
    }

    fn worst_shape(&self, _: [f64; 2]) -> f64 {
        let shapes = self.on_curves.iter();
        shapes.map(|on| on.objective.worst_shape(on.here.to_array())).fold(0.0, f64::max)
    }
}
