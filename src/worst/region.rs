//! A region of a mesh whose worst triangle is improved independently of other regions.

use std::collections::{HashMap, HashSet};

use glam::DVec2;

use crate::layout::{MeshCoordinates, Problem};
use crate::metric::{Dual, Ideal, Smoothing, TargetMap};
use crate::parallel::pace::pause;
use crate::patch::{
    AroundVertex, Circle, FanCorner, FanPatch, MetricObjective, Objective, Role, SearchRule,
    is_acceptable, step_alone,
};
use crate::run::SweepParams;
use crate::worst::badness::Badness;
use crate::worst::penalties::{Penalties, PenaltyObjective};

/// Binary logarithms of the exponents k of the p-norms, in the order in which a region lowers the norms.
const DOUBLINGS: [u32; 3] = [3, 5, 7];
/// Largest number of visits of a vertex with one exponent.
const VISITS: u32 = 10;
/// Longest move of a pass, as a share of an edge, below which the visits with an exponent end.
const SETTLED: f64 = 1e-3;
/// Number of visits of each vertex by the metric of the run, which regain f as far as the worst triangle allows.
const RELAXING: u32 = 10;

/// Bounds that every trial position of a vertex must keep, and the measure of the worst triangles.
pub(crate) struct MoveConstraints<'a> {
    pub(crate) badness: Badness,
    /// The step of the run: metric and exponent that vertices lower to regain f.
    pub(crate) step: SweepParams,
    /// Largest inverse mean ratio of a triangle, after its target map is applied.
    pub(crate) shape: f64,
    /// Lower limit of the altitudes of triangles, in normalized units; 0 for no limit.
    pub(crate) least_altitude: f64,
    /// Upper limits of the distances between free vertices and their start positions, normalized. `None` for no limit.
    pub(crate) bounds: Option<&'a [f64]>,
    /// The triangles of the problem on which penalties are larger; `None` for none.
    pub(crate) heavy: Option<&'a TriangleSet>,
}

/// Triangles of a problem, each by its vertices in ascending order.
pub(crate) type TriangleSet = HashSet<[u32; 3]>;

/// Returns the vertices of a triangle in ascending order.
pub(crate) fn sorted(mut triangle: [u32; 3]) -> [u32; 3] {
    triangle.sort_unstable();
    triangle
}

/// A corner with a vertex: its other two vertices, counter-clockwise, and its target map.
struct PatchCorner {
    ends: [u32; 2],
    map: Option<TargetMap<f64>>,
    role: Role,
    /// Whether penalties on the triangle are larger.
    is_heavy: bool,
}

/// Free vertices that move together, with the corners around each. Indices within the region begin with the moving
/// vertices, and their fixed neighbors follow.
pub(crate) struct Region<'a> {
    rules: &'a MoveConstraints<'a>,
    /// Indices of the moving vertices in the problem.
    vertices: Vec<u32>,
    positions: Vec<DVec2>,
    stars: Vec<Vec<PatchCorner>>,
    /// For each moving vertex, its quadrilaterals, each with the target map of the corner opposite the vertex.
    quadrilaterals: Vec<Vec<(AroundVertex, Option<TargetMap<f64>>)>>,
    /// For each moving vertex, the circle that limits its coordinates of the mesh.
    bounds: Vec<Circle>,
    ideal: Ideal,
    coordinates: MeshCoordinates,
}

impl<'a> Region<'a> {
    pub(crate) fn new(
        problem: &Problem,
        rules: &'a MoveConstraints<'a>,
        positions: &[DVec2],
        vertices: Vec<u32>,
    ) -> Self {
        let mut places: Vec<DVec2> = vertices.iter().map(|&v| positions[v as usize]).collect();
        let mut number: HashMap<u32, u32> = vertices.iter().copied().zip(0..).collect();
        let mut stars = Vec::new();
        let mut quadrilaterals = Vec::new();
        for &v in &vertices {
            let corner = |(corner, is_right): ([u32; 3], bool)| {
                let (role, ends) = Role::of(corner, is_right, v);
                let ends = ends.map(|end| {
                    *number.entry(end).or_insert_with(|| {
                        places.push(positions[end as usize]);
                        places.len() as u32 - 1
                    })
                });
                let is_heavy = rules.heavy.is_some_and(|heavy| heavy.contains(&sorted(corner)));
                PatchCorner { ends, map: problem.target_map(&corner), role, is_heavy }
            };
            let star: Vec<PatchCorner> = problem.corners_around(v).map(corner).collect();
            let of_problem = problem.corners_around(v).map(|(corner, is)| Role::of(corner, is, v));
            let maps = AroundVertex::all(of_problem).map(|of| problem.target_map(&of.opposite));
            let of_region = star.iter().map(|corner| (corner.role, corner.ends));
            quadrilaterals.push(AroundVertex::all(of_region).zip(maps).collect());
            stars.push(star);
        }
        let coordinates = problem.coordinates();
        let bound = |&v: &u32| {
            let radius = rules.bounds.map_or(f64::INFINITY, |bounds| bounds[v as usize]);
            Circle { center: coordinates.at(problem.positions()[v as usize]), radius }
        };
        let bounds = vertices.iter().map(bound).collect();
        let ideal = problem.ideal();
        Self {
            rules,
            vertices,
            positions: places,
            stars,
            quadrilaterals,
            bounds,
            ideal,
            coordinates,
        }
    }

    /// Moves the vertices so that the worst triangle around them becomes less bad, and then regains as much of f as
    /// possible. Returns the new positions with the indices of the vertices in the problem. `None` if the worst
    /// triangle cannot be improved.
    pub(crate) async fn improve(mut self) -> Option<Vec<(u32, DVec2)>> {
        let count = self.vertices.len();
        let before = self.worst();
        let mut best = (before, self.positions[..count].to_vec());
        for doublings in DOUBLINGS {
            for _ in 0..VISITS {
                let mut most = 0.0_f64;
                for v in 0..count {
                    most = most.max(self.visit(v, doublings));
                    pause().await;
                }
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
        // A gain within rounding is no improvement.
        let is_better = worst < before * (1.0 - 1e-9);
        if !is_better {
            return None;
        }
        self.positions[..count].copy_from_slice(&positions);
        for _ in 0..RELAXING {
            for v in 0..count {
                self.relax(v, worst);
                pause().await;
            }
        }
        Some(self.vertices.into_iter().zip(self.positions).collect())
    }

    /// Moves the vertices by Newton steps that lower the penalties on triangles beyond their limits. Each vertex is visited
    /// `visits` times at most. Returns the new positions of moved vertices with their indices in the problem.
    pub(crate) async fn descend(mut self, penalties: Penalties, visits: u32) -> Vec<(u32, DVec2)> {
        let count = self.vertices.len();
        let before = self.positions[..count].to_vec();
        for _ in 0..visits {
            let mut most = 0.0_f64;
            for v in 0..count {
                let patch = &self.patch(v);
                let heavy = self.stars[v].iter().map(|triangle| triangle.is_heavy).collect();
                let objective = PenaltyObjective { patch, penalties, heavy };
                most = most.max(self.step(v, patch, &objective, f64::INFINITY));
                pause().await;
            }
            if most < SETTLED {
                break;
            }
        }
        let moves = self.vertices.into_iter().zip(self.positions).zip(before);
        moves.filter(|((_, to), from)| to != from).map(|(moved, _)| moved).collect()
    }

    /// Returns the triangles around a vertex, with the positions of their corners.
    fn patch(&self, v: usize) -> FanPatch {
        let corner = |corner: &PatchCorner| FanCorner {
            ends: corner.ends.map(|end| self.positions[end as usize]),
            map: corner.map,
            role: corner.role,
        };
        let corners = self.stars[v].iter().map(corner).collect();
        let Self { ideal, coordinates, rules, .. } = *self;
        let opposite = |&(AroundVertex { first, opposite }, map): &(AroundVertex, _)| {
            let [at, ends @ ..] = opposite.map(|v| self.positions[v as usize]);
            (first, FanCorner { ends, map, role: Role::Own }.seen(at, ideal))
        };
        let opposites = self.quadrilaterals[v].iter().map(opposite).collect();
        FanPatch { corners, opposites, ideal, coordinates, min_altitude: rules.least_altitude }
    }

    /// Returns the badness of the worst triangle of the region.
    fn worst(&self) -> f64 {
        let of = |v| self.rules.badness.worst_of(&self.patch(v), self.positions[v]);
        (0..self.vertices.len()).map(of).fold(0.0, f64::max)
    }

    /// Takes a Newton step that lowers the p-norm of the triangles around a vertex. Returns the length of the step,
    /// relative to the length of an edge at the vertex.
    fn visit(&mut self, v: usize, doublings: u32) -> f64 {
        let (patch, badness) = (&self.patch(v), self.rules.badness);
        let unit = badness.worst_of(patch, self.positions[v]);
        let power = PowerObjective { patch, badness, unit, doublings };
        self.step(v, patch, &power, f64::INFINITY)
    }

    /// Takes a Newton step by the metric of the run. No triangle around the vertex becomes worse than `limit`.
    fn relax(&mut self, v: usize, limit: f64) {
        let SweepParams { metric, sharpness, .. } = self.rules.step;
        let (patch, smoothing) = (&self.patch(v), Smoothing::of(sharpness));
        let formulas = metric.formulas();
        let shape_guard = f64::INFINITY;
        let metric = MetricObjective { patch, formulas, smoothing, shape_guard };
        self.step(v, patch, &metric, limit);
    }

    /// Moves a vertex by a Newton step of `objective`, by [`SearchRule::WORST`], within all rules. Returns the length
    /// of the step, relative to the length of an edge at the vertex.
    fn step(
        &mut self,
        v: usize,
        patch: &FanPatch,
        objective: &dyn Objective<f64>,
        limit: f64,
    ) -> f64 {
        let (rules, bound) = (self.rules, self.bounds[v]);
        let constrained = Constrained { objective, patch, rules, bound, limit };
        let here = self.positions[v];
        let (to, has_stepped) = step_alone(&constrained, here.to_array(), &SearchRule::WORST);
        if !has_stepped {
            return 0.0;
        }
        let to = DVec2::from(to);
        self.positions[v] = to;
        let neighbor = patch.corners.first().map_or(here, |corner| corner.ends[0]);
        to.distance(here) / neighbor.distance(here)
    }
}

/// The p-norm of a patch without the root: the sum of [`Badness::power`] over its triangles.
struct PowerObjective<'a> {
    patch: &'a FanPatch,
    badness: Badness,
    unit: f64,
    doublings: u32,
}

impl Objective<f64> for PowerObjective<'_> {
    fn expansion(&self, at: [f64; 2]) -> Dual {
        let Self { patch, badness, unit, doublings } = *self;
        patch.corners.iter().fold(Dual::default(), |sum, triangle| {
            let coordinates = patch.coordinates;
            let seen = badness.seen(triangle, at.into(), patch.ideal, coordinates);
            let slopes = badness.slopes(triangle);
            let transformed = badness.power_derivatives(&seen, slopes, unit, doublings);
            sum + match triangle.map {
                Some(map) if badness.is_of_targets() => map.pull_back(transformed),
                None if badness.is_of_targets() => transformed,
                _ => coordinates.pull_back(transformed, at.into()),
            }
        })
    }

    fn trial(&self, to: [f64; 2], _: f64) -> (f64, bool) {
        let Self { patch, badness, unit, doublings } = *self;
        let power = |triangle: &FanCorner| {
            let seen = badness.seen(triangle, to.into(), patch.ideal, patch.coordinates);
            badness.power(&seen, unit, doublings)
        };
        (patch.corners.iter().map(power).sum(), true)
    }
}

/// An objective whose trials are accepted only at positions that keep all rules.
struct Constrained<'a> {
    objective: &'a dyn Objective<f64>,
    patch: &'a FanPatch,
    rules: &'a MoveConstraints<'a>,
    bound: Circle,
    /// Largest badness that a triangle around the vertex may have; infinite for no limit.
    limit: f64,
}

impl Objective<f64> for Constrained<'_> {
    fn expansion(&self, at: [f64; 2]) -> Dual {
        self.objective.expansion(at)
    }

    fn trial(&self, to: [f64; 2], max_imr: f64) -> (f64, bool) {
        let Self { objective, patch, rules, bound, limit } = *self;
        let is_allowed = bound.contains(patch.coordinates.at(to.into()))
            && is_acceptable(patch, rules.step.metric.formulas(), to, rules.shape)
            && (limit.is_infinite() || rules.badness.worst_of(patch, to.into()) <= limit);
        if is_allowed { objective.trial(to, max_imr) } else { (f64::INFINITY, false) }
    }
}
