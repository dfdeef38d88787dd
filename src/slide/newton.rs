//! Visits of vertices on curves: safeguarded Newton steps along the curve.

use glam::DVec2;

use crate::layout::Problem;
use crate::metric::{Corner, Dual, TargetMap};
use crate::run::{Step, line_search};
use crate::slide::curve::{Curve, Place};
use crate::topology::Topology;
use crate::topology::predicates::is_positive;

/// The largest share of the way to a neighbor on the curve that a step may go.
const NEAREST: f64 = 0.8;

/// The triangles at a vertex, each with the vertex itself as its first corner.
#[derive(Clone, Debug)]
pub(crate) struct Fan(Vec<[u32; 3]>);

/// The parameters of a vertex and its neighbors on a curve.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Window {
    pub(crate) low: f64,
    pub(crate) at: f64,
    pub(crate) high: f64,
}

impl Fan {
    pub(crate) fn new(topology: &Topology<'_>, vertex: u32) -> Self {
        let own_first = |&t: &u32| {
            let mut corners = topology.triangles()[t as usize];
            let own = corners.iter().position(|&v| v == vertex).unwrap_or(0);
            corners.rotate_left(own);
            corners
        };
        Self(topology.star(vertex).iter().map(own_first).collect())
    }

    /// Gives every vertex a new number.
    pub(crate) fn renumber(&mut self, number: &[u32]) {
        self.0.as_flattened_mut().iter_mut().for_each(|v| *v = number[*v as usize]);
    }

    /// The vertex itself.
    pub(crate) fn own(&self) -> u32 {
        self.0.first().map_or(0, |corners| corners[0])
    }
}

/// The triangles at a vertex as metrics see them with the vertex at some position.
struct Patch<'a> {
    problem: &'a Problem,
    positions: &'a [DVec2],
    fan: &'a Fan,
    step: &'a Step,
}

impl Patch<'_> {
    fn corner(&self, corners: &[u32; 3], at: DVec2) -> Corner<f64> {
        let own = corners[0];
        self.problem.corner(corners, |v| if v == own { at } else { self.positions[v as usize] })
    }

    /// The objective with its derivatives by the position of the vertex.
    fn derivatives(&self, at: DVec2) -> Dual {
        let Step { metric, sharpness, .. } = *self.step;
        self.fan.0.iter().fold(Dual::default(), |sum, corners| {
            let shown = metric.expansion(&self.corner(corners, at), sharpness);
            let pulled = match self.problem.targets() {
                None => shown,
                Some(maps) => {
                    let maps = corners.map(|v| maps[v as usize].map(f64::from));
                    TargetMap::mean(maps).pull_back(shown)
                }
            };
            sum + pulled
        })
    }

    /// The objective. `None` if a triangle is inverted or flat, or has an inverse mean ratio above the limit.
    fn objective(&self, at: DVec2, limit: f64) -> Option<f64> {
        let Step { metric, sharpness, .. } = *self.step;
        let mut sum = 0.0;
        for corners in &self.fan.0 {
            let points = corners.map(|v| self.positions[v as usize].to_array());
            let is_sound = is_positive(&[at.to_array(), points[1], points[2]], &[0, 1, 2]);
            let corner = self.corner(corners, at);
            if !is_sound || corner.doubled_area() <= 0.0 || corner.inverse_mean_ratio() > limit {
                return None;
            }
            sum += metric.model(&corner, sharpness);
        }
        Some(sum)
    }

    fn worst_shape(&self, at: DVec2) -> f64 {
        let ratio = |corners| self.corner(corners, at).inverse_mean_ratio();
        self.fan.0.iter().map(ratio).fold(0.0, f64::max)
    }
}

/// One Newton step along the curve, with a line search as in the sweeps over free vertices. Returns the new parameter and position of
/// the vertex, if it moves.
pub(crate) fn visit(
    problem: &Problem,
    positions: &[DVec2],
    fan: &Fan,
    curve: &Curve,
    window: Window,
    step: &Step,
) -> Option<(f64, DVec2)> {
    let Window { low, at, high } = window;
    let (center, scale) = problem.normalization();
    let Place { first, second, .. } = curve.at(at);
    let (first, second) = (first * scale, second * scale);
    let patch = Patch { problem, positions, fan, step };
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
    let squares = sum.value + fan.0.len() as f64 * step.metric.ideal_squared();
    let most = sum.value + squares * SLACK;
    let limit = match step.shape_guard.is_finite() {
        true => step.shape_guard.max(patch.worst_shape(here)),
        false => f64::INFINITY,
    };
    let mut length = 1.0;
    for _ in 0..line_search::TRIALS {
        let to = at + way * length;
        let position = (curve.at(to).point - center) * scale;
        let value = match curve.is_near([low, to, high]) {
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
