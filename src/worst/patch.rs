//! A part of a mesh in which the worst triangle is improved, independently of the rest.

use std::collections::HashMap;

use glam::DVec2;

use crate::layout::Problem;
use crate::measure::altitude;
use crate::metric::{Corner, Dual, TargetMap, descent};
use crate::patch::{SUFFICIENT_DECREASE, SearchRule};
use crate::run::Step;
use crate::worst::badness::{Badness, corner, is_sound};

/// The log2 of the exponents of the p-norms that are lowered in turn.
const DOUBLINGS: [u32; 3] = [3, 5, 7];
/// The most visits of each vertex for each exponent.
const VISITS: u32 = 10;
/// The visits for an exponent end after a pass in which no vertex moved by more than this share of an edge.
const SETTLED: f64 = 1e-3;
/// Number of visits of each vertex to regain what f lost.
const RELAXING: u32 = 10;
/// The eigenvalues of a Hessian are raised to at least this share of the largest.
const EIGENVALUE_FLOOR: f64 = 1e-6;

/// Bounds that every new position of a vertex must keep.
pub(crate) struct Rules<'a> {
    pub(crate) badness: Badness,
    /// A step of the metric that the run minimizes.
    pub(crate) step: Step,
    /// The largest inverse mean ratio that a triangle may have, after its target map is applied.
    pub(crate) shape: f64,
    /// The least altitude that a triangle may have, normalized.
    pub(crate) floor: f64,
    /// How far each free vertex may be from the start of the run, normalized; `None` for no bound.
    pub(crate) bounds: Option<&'a [f64]>,
}

/// A triangle at a vertex: the other two corners, counter-clockwise, and its target map.
struct Side {
    ends: [u32; 2],
    map: Option<TargetMap<f64>>,
}

/// Some free vertices, and the triangles around each. Vertices are numbered within the patch; those that move come
/// first.
pub(crate) struct Patch<'a> {
    rules: &'a Rules<'a>,
    /// The numbers in the problem of the vertices that move.
    vertices: Vec<u32>,
    positions: Vec<DVec2>,
    stars: Vec<Vec<Side>>,
    /// For each vertex, the center and the radius of the circle in which it may be.
    bounds: Vec<(DVec2, f64)>,
    mean_area: f64,
}

impl<'a> Patch<'a> {
    pub(crate) fn new(
        problem: &Problem,
        rules: &'a Rules<'a>,
        positions: &[DVec2],
        vertices: Vec<u32>,
    ) -> Self {
        let mut places: Vec<DVec2> = vertices.iter().map(|&v| positions[v as usize]).collect();
        let mut number: HashMap<u32, u32> = vertices.iter().copied().zip(0..).collect();
        let mut stars = Vec::new();
        for &v in &vertices {
            let ring = problem.ring_of(v);
            let next = ring.iter().skip(1).chain(ring.first());
            let side = |(&a, &b): (&u32, &u32)| {
                let ends = [a, b].map(|end| {
                    *number.entry(end).or_insert_with(|| {
                        places.push(positions[end as usize]);
                        places.len() as u32 - 1
                    })
                });
                let map_at = |maps: &[[f32; 3]], v: u32| maps[v as usize].map(f64::from);
                let mean = |maps| TargetMap::mean([v, a, b].map(|v| map_at(maps, v)));
                Side { ends, map: problem.targets().map(mean) }
            };
            stars.push(ring.iter().zip(next).map(side).collect());
        }
        let bound = |&v: &u32| {
            let most = rules.bounds.map_or(f64::INFINITY, |bounds| bounds[v as usize]);
            (problem.positions()[v as usize], most)
        };
        let bounds = vertices.iter().map(bound).collect();
        let mean_area = problem.mean_area();
        Self { rules, vertices, positions: places, stars, bounds, mean_area }
    }

    /// Moves the vertices so that the worst triangle around them becomes less bad, and then regains as much of f as
    /// possible. Returns the new positions, with the vertices' numbers in the problem, or `None` if the worst triangle
    /// cannot be improved.
    pub(crate) fn improve(mut self) -> Option<Vec<(u32, DVec2)>> {
        let count = self.vertices.len();
        let before = self.worst();
        let mut best = (before, self.positions[..count].to_vec());
        for doublings in DOUBLINGS {
            for _ in 0..VISITS {
                let moves = (0..count).map(|v| self.visit(v, doublings));
                let most = moves.fold(0.0, f64::max);
                let worst = self.worst();
                if worst < best.0 {
                    best = (worst, self.positions[..count].to_vec());
                }
                if most < SETTLED {
                    break;
                }
            }
        }
        let (worst, positions) = best;
        // Rounding alone is no gain.
        let is_better = worst < before * (1.0 - 1e-9);
        if !is_better {
            return None;
        }
        self.positions[..count].copy_from_slice(&positions);
        for _ in 0..RELAXING {
            for v in 0..count {
                self.relax(v, worst);
            }
        }
        Some(self.vertices.into_iter().zip(self.positions).collect())
    }

    /// Returns a triangle at a vertex, in coordinates.
    fn corner(&self, side: &Side, at: DVec2) -> Corner<f64> {
        corner(at, side.ends.map(|end| self.positions[end as usize]), self.mean_area)
    }

    /// Returns the badness of the worst triangle.
    fn worst(&self) -> f64 {
        (0..self.vertices.len()).map(|v| self.worst_at(v, self.positions[v])).fold(0.0, f64::max)
    }

    /// Returns the badness of the worst triangle around a vertex at the given position.
    fn worst_at(&self, v: usize, at: DVec2) -> f64 {
        let badness = self.rules.badness;
        let of = |side: &Side| badness.of(&badness.seen(self.corner(side, at), side.map.as_ref()));
        self.stars[v].iter().map(of).fold(0.0, f64::max)
    }

    /// Whether a vertex may be at a position.
    fn is_allowed(&self, v: usize, at: DVec2) -> bool {
        let Rules { shape, floor, .. } = *self.rules;
        let (start, most) = self.bounds[v];
        let is_within = !most.is_finite() || at.distance(start) <= most;
        is_within
            && self.stars[v].iter().all(|side| {
                let corner = self.corner(side, at);
                let shown = side.map.map_or(corner, |map| map.show(&corner));
                let others = side.ends.map(|end| self.positions[end as usize]);
                is_sound(&corner)
                    && shown.inverse_mean_ratio() <= shape
                    && (floor <= 0.0 || altitude([at, others[0], others[1]]) >= floor)
            })
    }

    /// Takes a Newton step by the p-norm of the triangles around a vertex. Returns the length of the step, divided by
    /// that of an edge.
    fn visit(&mut self, v: usize, doublings: u32) -> f64 {
        let badness = self.rules.badness;
        let here = self.positions[v];
        let unit = self.worst_at(v, here);
        let sum = self.stars[v].iter().fold(Dual::default(), |sum, side| {
            let corner = badness.seen(self.corner(side, here), side.map.as_ref());
            let shown = badness.power_derivatives(&corner, unit, doublings);
            sum + match (side.map, self.rules.badness.is_of_targets()) {
                (Some(map), true) => map.pull_back(shown),
                _ => shown,
            }
        });
        let value = |patch: &Self, at: DVec2| {
            let of = |side: &Side| {
                let corner = badness.seen(patch.corner(side, at), side.map.as_ref());
                badness.power(&corner, unit, doublings)
            };
            patch.stars[v].iter().map(of).sum()
        };
        self.step(v, &sum, value, f64::INFINITY)
    }

    /// Takes a Newton step by the metric of the run, after which no triangle around the vertex is worse than `limit`.
    fn relax(&mut self, v: usize, limit: f64) {
        let Step { metric, sharpness, .. } = self.rules.step;
        let here = self.positions[v];
        let sum = self.stars[v].iter().fold(Dual::default(), |sum, side| {
            let corner = self.corner(side, here);
            sum + match &side.map {
                Some(map) => map.pull_back(metric.expansion(&map.show(&corner), sharpness)),
                None => metric.expansion(&corner, sharpness),
            }
        });
        let value = |patch: &Self, at: DVec2| {
            let of = |side: &Side| {
                let corner = patch.corner(side, at);
                let shown = side.map.map_or(corner, |map| map.show(&corner));
                metric.model(&shown, sharpness)
            };
            patch.stars[v].iter().map(of).sum()
        };
        self.step(v, &sum, value, limit);
    }

    /// Moves a vertex along the Newton direction as far as a value falls and all rules are kept. Returns the distance,
    /// divided by the length of an edge.
    fn step(
        &mut self,
        v: usize,
        sum: &Dual<f64>,
        value: impl Fn(&Self, DVec2) -> f64,
        limit: f64,
    ) -> f64 {
        let (here, way) =
            (self.positions[v], descent(sum.gradient.into(), sum.hessian, EIGENVALUE_FLOOR));
        let slope = way.dot(sum.gradient.into());
        if !(slope < 0.0 && way.is_finite()) {
            return 0.0;
        }
        let mut length = 1.0;
        for _ in 0..SearchRule::SWEEP.trials {
            let to = here + way * length;
            let is_allowed =
                self.is_allowed(v, to) && (limit.is_infinite() || self.worst_at(v, to) <= limit);
            let most = sum.value + SUFFICIENT_DECREASE * slope * length;
            if is_allowed && value(self, to) <= most {
                self.positions[v] = to;
                let neighbor = self.stars[v]
                    .first()
                    .map_or(here, |side| self.positions[side.ends[0] as usize]);
                return to.distance(here) / neighbor.distance(here);
            }
            length *= SearchRule::SWEEP.shorten;
        }
        0.0
    }
}
