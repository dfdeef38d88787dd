//! Sweeps and corrections of free vertices within bounds: discs around their given positions, and a least altitude.

use fearless_simd::Level;
use fearless_simd::prelude::*;
use glam::{DVec2, Vec2};

use crate::cpu::along::disc;
use crate::cpu::newton::{SweepObjective, search_rule, settled};
use crate::cpu::within::{LaneBounds, Within};
use crate::layout::{DEGREE_BLOCK, Problem};
use crate::options::Derivatives;
use crate::parallel::paced;
use crate::patch::lanes::{Mask, Points, points, with_instructions};
use crate::patch::search_rule::SUFFICIENT_DECREASE;
use crate::patch::{
    AT_DISC, Circle, MetricObjective, Rings, Scratch, SearchRule, batch_at, newton_step,
};
use crate::run::SweepParams;

/// Visits the vertices from `first` on, in parallel, and writes their new positions to `moved`.
pub(super) async fn visit(
    problem: &Problem,
    positions: &[DVec2],
    first: usize,
    step: &SweepParams,
    moved: &mut [DVec2],
) {
    paced::for_each_chunk(moved, DEGREE_BLOCK, |at, moved| {
        with_instructions!(Level::new(), simd => {
            visit_all(simd, problem, positions, first + at, step, moved)
        });
    })
    .await;
}

#[inline(always)]
fn visit_all<S: Simd>(
    simd: S,
    problem: &Problem,
    positions: &[DVec2],
    first: usize,
    step: &SweepParams,
    moved: &mut [DVec2],
) {
    let mut scratch = Scratch::new();
    let mut done = 0;
    while done < moved.len() {
        let (vertices, count) = batch_at(problem, first + done, moved.len() - done);
        let rings = Rings::<S, true>::gather(simd, problem, positions, vertices, &mut scratch);
        let bounds = LaneBounds::gather(simd, problem, vertices);
        let [x, y] = visited(&rings, points(simd, positions, vertices), bounds, step);
        for (lane, moved) in moved[done..done + count].iter_mut().enumerate() {
            *moved = DVec2::new(x[lane], y[lane]);
        }
        done += count;
    }
}

/// Visits four vertices at `at`, and returns their new positions.
#[inline(always)]
fn visited<S: Simd>(
    rings: &Rings<'_, S, true>,
    mut at: Points<S>,
    bounds: LaneBounds<S>,
    step: &SweepParams,
) -> Points<S> {
    let mut going = Mask::splat(at[0].simd, true);
    let (smoothing, shape_guard, derivatives) =
        (step.smoothing(), step.shape_guard, step.derivatives);
    let formulas = step.metric.formulas();
    // A projected step need not end at the least value of a quadratic metric.
    let sufficient_decrease = Some(SUFFICIENT_DECREASE);
    let rule = SearchRule { sufficient_decrease, ..search_rule(step) };
    for _ in 0..step.newton_steps {
        let metric = MetricObjective { patch: rings, formulas, smoothing, shape_guard };
        let objective = SweepObjective { metric, derivatives };
        let from = at;
        let within = Within { objective, rings, at, bounds };
        (at, going) = newton_step(&within, at, going, &rule);
        if step.newton_steps > 1 && derivatives == Derivatives::Analytic {
            going &= !settled(rings, from, at);
        }
        if going.all_false() {
            break;
        }
    }
    at
}

/// The free vertices at the circles of their discs whose descent leads outward, with the unit tangents of the circles at
/// the positions. A correction moves these vertices along their tangents.
#[derive(Default)]
pub(super) struct Tangents(Vec<(u32, DVec2)>);

impl Tangents {
    /// Number of vertices that one task tests.
    const TESTED: usize = 1 << 12;

    /// Returns the tangents for the gradient of f at the free vertices.
    pub(super) async fn at(problem: &Problem, positions: &[DVec2], gradient: &[Vec2]) -> Self {
        if problem.radii().is_none() {
            return Self::default();
        }
        let coordinates = problem.coordinates();
        let tangent = |v: usize| {
            let Circle { center, radius } = disc(problem, v)?;
            let away = coordinates.at(positions[v]) - center;
            let [slope, _] = coordinates.slopes(positions[v]);
            // The conormal of the circle in the coordinates of positions.
            let normal = DVec2::new(away.x, away.y * slope).normalize_or_zero();
            let is_held = away.length() >= AT_DISC * radius;
            let leads_out = gradient[v].as_dvec2().dot(normal) < 0.0 || normal == DVec2::ZERO;
            (is_held && leads_out).then(|| normal.perp())
        };
        let found = paced::map_ranges(gradient.len(), Self::TESTED, |range| -> Vec<(u32, DVec2)> {
            range.filter_map(|v| Some((v as u32, tangent(v)?))).collect()
        });
        Self(found.await.concat())
    }

    /// Projects vectors at the free vertices onto the tangents.
    pub(super) fn project(&self, vectors: &mut [Vec2]) {
        for &(v, tangent) in &self.0 {
            let vector = &mut vectors[v as usize];
            *vector = (tangent * tangent.dot(vector.as_dvec2())).as_vec2();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cpu::{mean_excess, sweep};
    use crate::layout::{Bounds, prepare};
    use crate::mesh::Mesh;
    use crate::metric::Metric;
    use crate::options::Options;
    use crate::parallel::pace::now;
    use crate::run::Plan;

    /// Returns a hexagon with a free vertex at `at`, bounded by a disc of this radius (normalized).
    fn hexagon(at: [f64; 2], radius: f64) -> Problem {
        let corner = |k: u32| (f64::from(k) * std::f64::consts::FRAC_PI_3).sin_cos();
        let mut points: Vec<[f64; 2]> = (0..6).map(corner).map(|(y, x)| [x, y]).collect();
        points.push(at);
        let triangles = (0..6).map(|k| [k, (k + 1) % 6, 6]).collect();
        let (_, mut problem) = prepare(&Mesh { points, triangles, fixed: Vec::new() }).unwrap();
        problem.set_bounds(Bounds { radii: Some(vec![radius]), floor: 0.0 });
        problem
    }

    fn f(problem: &Problem, metric: Metric, at: DVec2) -> f64 {
        let mut positions = problem.positions().to_vec();
        positions[0] = at;
        now(mean_excess(metric, problem, &positions))
    }

    /// Returns the position of the free vertex after ten sweeps.
    fn swept(problem: &Problem, metric: Metric) -> DVec2 {
        let plan = Plan::new(&Options { scheme: metric.into(), ..Options::default() });
        let (step, mut moved) = (plan.base_step(1.0), Vec::new());
        let mut positions = problem.positions().to_vec();
        for _ in 0..10 {
            now(sweep::sweep(problem, &mut positions, &mut moved, &step));
        }
        positions[0]
    }

    #[test]
    fn visits_find_the_least_f_within_a_disc() {
        for (at, radius) in [([0.6, 0.1], 0.2), ([0.6, 0.1], 0.55), ([-0.3, 0.5], 0.01)] {
            let problem = hexagon(at, radius);
            let center = problem.positions()[0];
            for metric in [Metric::Imr, Metric::Rms, Metric::Area, Metric::ShapeSize] {
                let found = swept(&problem, metric);
                assert!(found.distance(center) <= radius * (1.0 + 1e-12), "{metric}: {found}");
                let on_circle = (0..3600).map(|k| {
                    let (sin, cos) = (f64::from(k) * std::f64::consts::PI / 1800.0).sin_cos();
                    f(&problem, metric, center + DVec2::new(cos, sin) * radius)
                });
                let least = on_circle.filter(|f| f.is_finite()).fold(f64::INFINITY, f64::min);
                let end = f(&problem, metric, found);
                assert!(end <= least + 1e-9, "{metric}, radius {radius}: {end} above {least}");
            }
        }
    }

    #[test]
    fn a_disc_of_radius_zero_holds_its_vertex() {
        let problem = hexagon([0.6, 0.1], 0.0);
        assert_eq!(swept(&problem, Metric::Imr), problem.positions()[0]);
    }
}
