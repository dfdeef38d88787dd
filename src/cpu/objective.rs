//! The objective over all elements, on the CPU.

use glam::DVec2;

use crate::cpu::along::Along;
use crate::layout::{CornerPart, Problem};
use crate::metric::{Corner, Formulas, Metric, Smoothing, TargetMap, opposite_angles};
use crate::parallel::paced;
use crate::patch::instructions::{with_instructions, with_lanes};
use crate::patch::lanes::{LANES, Width, points, vertex_maps};
use crate::patch::numbers::{Mask, Numbers};
use crate::patch::{Sums, from_lane, is_no_worse, is_positive, is_within};
use crate::run::{Objectives, SweepParams};

/// Number of corners that one task evaluates.
const CHUNK: usize = 1024;

/// Returns the mean of q² - ideal² over the elements that a problem is judged by, summed in an order that does not
/// depend on the number of threads.
pub(crate) async fn mean_excess(metric: Metric, problem: &Problem, positions: &[DVec2]) -> f64 {
    mean(metric, None, problem, problem.judged_parts(), positions).await
}

/// Returns the objective by a metric, over the elements that a problem is judged by.
pub(crate) async fn objective(metric: Metric, problem: &Problem, positions: &[DVec2]) -> f64 {
    metric.ideal_squared() + mean_excess(metric, problem, positions).await
}

/// Returns the objectives by several metrics.
pub(crate) async fn objectives(
    metrics: &[Metric],
    problem: &Problem,
    positions: &[DVec2],
) -> Objectives {
    let mut objectives = Objectives::empty();
    for &metric in metrics {
        objectives.set(metric, objective(metric, problem, positions).await);
    }
    objectives
}

/// Returns the mean of q² - ideal² over the elements that are left out of the objective of a problem; NaN if no
/// element is left out.
pub(crate) async fn mean_excess_left_out(
    metric: Metric,
    problem: &Problem,
    positions: &[DVec2],
) -> f64 {
    mean(metric, None, problem, problem.unjudged_parts(), positions).await
}

/// Returns the mean over the elements that a problem is judged by of the function that a step minimizes: q² - ideal², or its smooth model.
pub(crate) async fn mean_model(
    metric: Metric,
    smoothing: Smoothing,
    problem: &Problem,
    positions: &[DVec2],
) -> f64 {
    let smoothing = Some(smoothing).filter(|_| !metric.is_smooth());
    mean(metric, smoothing, problem, problem.judged_parts(), positions).await
}

/// Returns the mean of q² - ideal² over the elements of corners, or of its smooth model if `smoothing` is given.
async fn mean(
    metric: Metric,
    smoothing: Option<Smoothing>,
    problem: &Problem,
    parts: [CornerPart<'_>; 2],
    positions: &[DVec2],
) -> f64 {
    let [CornerPart { corners: triangles, .. }, right] = parts;
    let sum = |_, chunk: &[[u32; 3]]| {
        with_lanes!(problem.targets(), false, metric, width, formulas, MAPPED => {
            excess::<_, MAPPED, false>(width, formulas, smoothing, problem, positions, chunk)
        })
    };
    let sums = paced::map_parts(triangles.chunks(CHUNK), sum).await;
    let sum = sums.iter().sum::<f64>();
    if right.corners.is_empty() {
        return sum / triangles.len() as f64;
    }
    let formulas = metric.formulas();
    let of_part = |_, part: CornerPart<'_>| {
        with_instructions!(width => {
            excess::<_, true, true>(width, formulas, smoothing, problem, positions, part.corners)
        })
    };
    let sums = paced::map_parts(right.chunks(CHUNK), of_part).await;
    let elements = triangles.len() + right.corners.len() / 4;
    (sum + right.weight() * sums.iter().sum::<f64>()) / elements as f64
}

/// Returns the mean, at moved positions, of the function that `step` minimizes: q² - ideal², or its smooth model.
/// `None` if the move breaks a corner: inverts or flattens it, or makes its inverse mean ratio both worse than before
/// and larger than the shape guard of the step, or its altitude both lower than before and below the least altitude of the problem.
pub(crate) async fn mean_excess_along(
    step: &SweepParams,
    problem: &Problem,
    along: &Along<'_>,
) -> Option<f64> {
    if problem.is_bounded() {
        return mean_excess_within(step, problem, along).await;
    }
    let sum = |_, chunk: &[[u32; 3]]| {
        with_lanes!(problem.targets(), false, step.metric, width, formulas, MAPPED => {
            excess_along::<_, MAPPED, false>(width, formulas, problem, along, step, chunk)
        })
    };
    let [CornerPart { corners: triangles, .. }, right] = problem.judged_parts();
    let sums = paced::map_parts(triangles.chunks(CHUNK), sum).await;
    let mut sum: Option<f64> = sums.into_iter().sum();
    if !right.corners.is_empty() {
        let formulas = step.metric.formulas();
        let of_part = |_, part: CornerPart<'_>| {
            with_instructions!(width => {
                excess_along::<_, true, true>(width, formulas, problem, along, step, part.corners)
            })
        };
        let sums = paced::map_parts(right.chunks(CHUNK), of_part).await;
        let others: Option<f64> = sums.into_iter().sum();
        sum = sum.zip(others).map(|(sum, others)| sum + right.weight() * others);
    }
    sum.map(|sum| sum / problem.judged_count() as f64)
}

/// Does the work of [`mean_excess_along`] on a problem with bounds, without loops of its own for each metric.
async fn mean_excess_within(
    step: &SweepParams,
    problem: &Problem,
    along: &Along<'_>,
) -> Option<f64> {
    let keeps = |_, part: CornerPart<'_>| {
        let keeps = |t| along.keeps(problem, part.is_right, t, step.shape_guard);
        part.corners.iter().all(keeps)
    };
    let parts = problem.judged_parts().into_iter().flat_map(|part| part.chunks(CHUNK));
    let kept = paced::map_parts(parts.collect::<Vec<_>>(), keeps).await;
    if kept.contains(&false) {
        return None;
    }
    let there = along.all_moved().await;
    Some(mean_model(step.metric, step.smoothing(), problem, &there).await)
}

/// Returns the sum of q² - ideal², or of its smooth model, over corners at moved positions. `None` if the move
/// breaks a corner, as defined at [`mean_excess_along`]. `RIGHT` tells whether the corners are of quadrilaterals.
#[inline(always)]
fn excess_along<W: Width, const MAPPED: bool, const RIGHT: bool>(
    width: W,
    formulas: impl Formulas,
    problem: &Problem,
    along: &Along<'_>,
    step: &SweepParams,
    corners: &[[u32; 3]],
) -> Option<f64> {
    let guard = step.shape_guard;
    let (fours, rest) = corners.as_chunks::<LANES>();
    let mut sums = Sums::new(width);
    let mut joined = JoinedAngles::new();
    let mut borne = width.splat(0.0).mask(true);
    for four in fours {
        let mut lane = 0;
        while lane < LANES {
            let these = from_lane::<W>(four, lane);
            let [t, u, v, w] = these;
            let map = if MAPPED { map_of::<_, RIGHT>(width, problem, &these) } else { None };
            let (p, moved_p) = along.points(width, [t[0], u[0], v[0], w[0]]);
            let (q, moved_q) = along.points(width, [t[1], u[1], v[1], w[1]]);
            let (r, moved_r) = along.points(width, [t[2], u[2], v[2], w[2]]);
            let now = corner::<_, RIGHT>([moved_p, moved_q, moved_r], problem, &map);
            borne = borne & is_positive(&now);
            if guard.is_finite() {
                let mut kept = is_within(formulas, &now, width.splat(guard));
                // Few moves exceed the guard, so triangles before the move are evaluated only after an excess.
                if !kept.all() {
                    let before = corner::<_, RIGHT>([p, q, r], problem, &map);
                    kept = kept | is_no_worse(formulas, &before, &now);
                }
                borne = borne & kept;
            }
            sums.add(lane, formulas.model(&now, step.smoothing()));
            if RIGHT {
                joined.add(formulas, lane, &now);
            }
            lane += W::Numbers::LANES;
        }
    }
    let mut last = joined.sum;
    for t in rest {
        let now = problem.corner_of(RIGHT, t, |v| along.to(v));
        borne = borne & width.splat(0.0).mask(along.keeps(problem, RIGHT, t, guard));
        last += formulas.model(&now, step.smoothing());
    }
    borne.all().then_some(sums.total() + last)
}

/// Returns the target maps of corners, one in each lane. Triangles have identity maps without targets, and corners of
/// quadrilaterals have none.
#[inline(always)]
fn map_of<W: Width, const RIGHT: bool>(
    width: W,
    problem: &Problem,
    [t, u, v, w]: &[[u32; 3]; LANES],
) -> Option<TargetMap<W::Numbers>> {
    if RIGHT && problem.targets().is_none() {
        return None;
    }
    Some(TargetMap::mean([
        vertex_maps(width, problem.targets(), [t[0], u[0], v[0], w[0]]),
        vertex_maps(width, problem.targets(), [t[1], u[1], v[1], w[1]]),
        vertex_maps(width, problem.targets(), [t[2], u[2], v[2], w[2]]),
    ]))
}

/// Returns corners, one in each lane, transformed by their target maps.
#[inline(always)]
fn corner<T: Numbers, const RIGHT: bool>(
    [p, q, r]: [[T; 2]; 3],
    problem: &Problem,
    map: &Option<TargetMap<T>>,
) -> Corner<T> {
    let (a, b) = ([q[0] - p[0], q[1] - p[1]], [r[0] - p[0], r[1] - p[1]]);
    let mut corner = Corner { a, b, ideal: problem.ideal() };
    if RIGHT {
        corner = corner.of_right_angle();
    }
    match map {
        None => corner,
        Some(map) => map.transform(&corner),
    }
}

/// The sum of the terms of opposite angles of quadrilaterals, in the weight of corners. Zero if the metric has no such term.
struct JoinedAngles {
    sum: f64,
    /// Cotangents of the corners of the present quadrilateral.
    cotangents: [f64; LANES],
}

impl JoinedAngles {
    #[inline(always)]
    fn new() -> Self {
        Self { sum: 0.0, cotangents: [0.0; LANES] }
    }

    /// Adds the corners of a quadrilateral from a lane on. Lanes follow in their order.
    #[inline(always)]
    fn add<T: Numbers>(&mut self, formulas: impl Formulas, lane: usize, corners: &Corner<T>) {
        if !formulas.metric().joins_opposite_angles() {
            return;
        }
        let cotangents = opposite_angles::cotangent(corners);
        let own = &mut self.cotangents[lane..lane + T::LANES];
        (0..).zip(own).for_each(|(lane, own)| *own = cotangents.lane(lane));
        if lane + T::LANES == LANES {
            self.sum += 4.0 * opposite_angles::of_cotangents(self.cotangents);
        }
    }
}

/// Returns the sum of q² - ideal² over corners, or of its smooth model if `smoothing` is given. `RIGHT` tells whether the
/// corners are of quadrilaterals.
#[inline(always)]
fn excess<W: Width, const MAPPED: bool, const RIGHT: bool>(
    width: W,
    formulas: impl Formulas,
    smoothing: Option<Smoothing>,
    problem: &Problem,
    positions: &[DVec2],
    corners: &[[u32; 3]],
) -> f64 {
    // A smooth metric is its own model. The test is decided at compile time, as this function is compiled for each
    // metric.
    let smoothing = smoothing.filter(|_| !formulas.metric().is_smooth());
    let (fours, rest) = corners.as_chunks::<LANES>();
    let mut sums = Sums::new(width);
    let mut joined = JoinedAngles::new();
    for four in fours {
        let mut lane = 0;
        while lane < LANES {
            let these = from_lane::<W>(four, lane);
            let [t, u, v, w] = these;
            let map = if MAPPED { map_of::<_, RIGHT>(width, problem, &these) } else { None };
            let p = points(width, positions, [t[0], u[0], v[0], w[0]]);
            let q = points(width, positions, [t[1], u[1], v[1], w[1]]);
            let r = points(width, positions, [t[2], u[2], v[2], w[2]]);
            let corner = corner::<_, RIGHT>([p, q, r], problem, &map);
            let term = match smoothing {
                Some(smoothing) => formulas.model(&corner, smoothing),
                None => formulas.excess(&corner),
            };
            sums.add(lane, term);
            if RIGHT {
                joined.add(formulas, lane, &corner);
            }
            lane += W::Numbers::LANES;
        }
    }
    let mut last = joined.sum;
    for t in rest {
        let corner = problem.corner_of(RIGHT, t, |v| positions[v as usize]);
        last += match smoothing {
            Some(smoothing) => formulas.model(&corner, smoothing),
            None => formulas.excess(&corner),
        };
    }
    sums.total() + last
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout::prepare;
    use crate::mesh::Mesh;
    use crate::options::Options;
    use crate::parallel::pace::now;
    use crate::run::Plan;

    #[test]
    fn the_objective_along_a_direction_is_that_of_the_moved_mesh() {
        // Six triangles around a vertex: four fill the lanes, and two are evaluated one by one.
        let corner = |k: u32| (f64::from(k) * std::f64::consts::FRAC_PI_3).sin_cos();
        let mut points: Vec<[f64; 2]> = (0..6).map(corner).map(|(y, x)| [x, y]).collect();
        points.push([0.1, 0.2]);
        let triangles = (0..6).map(|k| [k, (k + 1) % 6, 6]).collect();
        let (_, problem) = prepare(&Mesh { points, triangles, ..Mesh::default() }).unwrap();
        let positions = problem.positions();
        for metric in [Metric::Imr, Metric::Rms, Metric::Edge] {
            let plan = Plan::new(&Options { scheme: metric.into(), ..Options::default() });
            let step = SweepParams { sharpness: 6, shape_guard: 30.0, ..plan.base_step(1.0) };
            let along = |direction: DVec2, length: f64| {
                let moved = &[positions[0] + direction * length];
                now(mean_excess_along(&step, &problem, &Along { positions, moved }))
            };
            let mut moved = positions.to_vec();
            moved[0] += DVec2::new(0.25, -0.5) * 0.3;
            let there = now(mean_model(metric, step.smoothing(), &problem, &moved));
            assert_eq!(along(DVec2::new(0.25, -0.5), 0.3), Some(there));
            // Moves the vertex out of the hexagon through each side, then along a direction that is NaN.
            for k in 0..6 {
                let (y, x) = ((f64::from(k) + 0.5) * std::f64::consts::FRAC_PI_3).sin_cos();
                assert_eq!(along(DVec2::new(x, y), 10.0), None, "{k}");
            }
            assert_eq!(along(DVec2::NAN, 1.0), None);
        }
    }
}
