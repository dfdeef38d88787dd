//! Loops over all free vertices: sweeps, gradients and stiffness.

use glam::{DVec2, Vec2};

use crate::cpu::newton;
use crate::cpu::within::LaneBounds;
use crate::layout::{DEGREE_BLOCK, Problem};
use crate::metric::{Dual, Formulas, Metric, Real, Smoothing};
use crate::options::Derivatives;
use crate::parallel::pace::pause;
use crate::parallel::paced;
use crate::patch::instructions::with_lanes;
use crate::patch::lanes::{Width, points};
use crate::patch::numbers::Numbers;
use crate::patch::{
    LanePatch, MetricObjective, MixedRings, MixedScratch, Objective, Rings, Scratch, VertexBatch,
    batch_at,
};
use crate::run::SweepParams;

/// Number of vertices that one task visits.
const CHUNK: usize = DEGREE_BLOCK;

/// Number of positions that one task copies. Fewer positions do not repay a second thread.
const COPY: usize = 1 << 14;

/// The value that a visit writes for a vertex. [`DVec2`] is the new position; [`Vec2`] is the gradient, or the root of
/// the stiffness in both components.
trait VisitOutput: Send {
    /// Whether the visit takes Newton steps. The type decides at compile time, so that loops over derivatives contain
    /// no code of Newton steps.
    const STEPS: bool;
    fn new(found: [f64; 2]) -> Self;
}

impl VisitOutput for DVec2 {
    const STEPS: bool = true;
    #[inline(always)]
    fn new(found: [f64; 2]) -> Self {
        found.into()
    }
}

impl VisitOutput for Vec2 {
    const STEPS: bool = false;
    #[inline(always)]
    fn new(found: [f64; 2]) -> Self {
        DVec2::from(found).as_vec2()
    }
}

/// The quantity that a visit without Newton steps computes, from the derivatives of Σ q² over the patch of a vertex.
#[derive(Clone, Copy, PartialEq, Eq)]
enum VertexQuantity {
    Gradient,
    /// The square root of the stiffness, in both components; see [`stiffness_roots`].
    StiffnessRoot,
}

/// Visits every free vertex once, color by color, within the bounds of the problem. `moved` is scratch memory.
pub(crate) async fn sweep(
    problem: &Problem,
    positions: &mut [DVec2],
    moved: &mut Vec<DVec2>,
    step: &SweepParams,
) {
    for color in problem.colors() {
        let first = color.start as usize;
        moved.resize(color.len(), DVec2::ZERO);
        // Vertices of equal color are not neighbors, so no visit reads a position that another visit of the color
        // changes.
        visit(problem, positions, first, step, VertexQuantity::Gradient, moved).await;
        let moved = &*moved;
        paced::for_each_chunk(&mut positions[first..][..color.len()], COPY, |at, to| {
            to.copy_from_slice(&moved[at..][..to.len()]);
        })
        .await;
    }
}

/// Writes the gradient of Σ q² at each free vertex to `found`. Single precision suffices for a search direction.
pub(crate) async fn gradient(
    metric: Metric,
    problem: &Problem,
    positions: &[DVec2],
    smoothing: Smoothing,
    found: &mut Vec<Vec2>,
) {
    find(VertexQuantity::Gradient, metric, problem, positions, smoothing, found).await;
}

/// Returns the square root of the stiffness at each free vertex. The stiffness is the mean absolute eigenvalue of the
/// Hessian of Σ q² with respect to the vertex, divided by the number of its neighbors. The Hessian is taken in
/// coordinates transformed by the shape of the map at the vertex.
pub(crate) async fn stiffness_roots(
    metric: Metric,
    problem: &Problem,
    positions: &[DVec2],
    smoothing: Smoothing,
) -> Vec<f32> {
    let mut found = Vec::new();
    find(VertexQuantity::StiffnessRoot, metric, problem, positions, smoothing, &mut found).await;
    paced::collect(found.len(), |v| found[v].x).await
}

async fn find(
    sought: VertexQuantity,
    metric: Metric,
    problem: &Problem,
    positions: &[DVec2],
    smoothing: Smoothing,
    found: &mut Vec<Vec2>,
) {
    found.resize(problem.free_count(), Vec2::ZERO);
    let step = SweepParams {
        metric,
        omega: 1.0,
        newton_steps: 1,
        sharpness: smoothing.sharpness,
        penalty_guard: smoothing.penalty_guard,
        derivatives: Derivatives::Analytic,
        shape_guard: f64::INFINITY,
        max_lengthening: 1.0,
    };
    // The loop goes color by color, as within a color, vertices of equal degree are consecutive.
    for color in problem.colors() {
        let found = &mut found[color.start as usize..color.end as usize];
        visit(problem, positions, color.start as usize, &step, sought, found).await;
    }
}

/// A vertex counts as held back if the shape guard changes its new position by more than this share of the length of an
/// edge.
const HELD_BACK: f64 = 1e-3;

/// Returns the number of free vertices that the shape guard of `step` holds back, within the bounds of the problem.
pub(crate) async fn held_back(problem: &Problem, positions: &[DVec2], step: &SweepParams) -> usize {
    let free = SweepParams { shape_guard: f64::INFINITY, ..*step };
    let (mut guarded, mut unguarded) = (Vec::new(), Vec::new());
    let mut count = 0;
    for color in problem.colors() {
        let first = color.start as usize;
        for (moved, step) in [(&mut guarded, step), (&mut unguarded, &free)] {
            moved.resize(color.len(), DVec2::ZERO);
            visit(problem, positions, first, step, VertexQuantity::Gradient, moved).await;
        }
        let is_held = |&(v, (kept, wanted)): &(u32, (&DVec2, &DVec2))| {
            let edge = positions[problem.ring_of(v)[0] as usize] - positions[v as usize];
            kept.distance(*wanted) > HELD_BACK * edge.length()
        };
        count += color.clone().zip(guarded.iter().zip(&unguarded)).filter(is_held).count();
        pause().await;
    }
    count
}

/// Visits the vertices from `first` on, in parallel, and writes a result for each to `found`.
async fn visit<T: VisitOutput>(
    problem: &Problem,
    positions: &[DVec2],
    first: usize,
    step: &SweepParams,
    sought: VertexQuantity,
    found: &mut [T],
) {
    let bounded = T::STEPS && problem.is_bounded();
    if problem.has_quadrilaterals() {
        paced::for_each_chunk(found, CHUNK, |at, found| {
            let first = first + at;
            with_lanes!(problem.maps(), bounded, step.metric, width, formulas, GENERAL => {
                visit_mixed::<_, _, GENERAL>(width, formulas, problem, positions, first, step, sought, found);
            });
        })
        .await;
        return;
    }
    paced::for_each_chunk(found, CHUNK, |at, found| {
        let first = first + at;
        with_lanes!(problem.maps(), bounded, step.metric, width, formulas, GENERAL => {
            visit_all::<_, _, GENERAL>(width, formulas, problem, positions, first, step, sought, found);
        });
    })
    .await;
}

/// Visits the vertices from `first` on, and writes their new positions, or the quantity `sought`, to `found`.
#[inline(always)]
#[allow(clippy::too_many_arguments)]
fn visit_all<W: Width, T: VisitOutput, const GENERAL: bool>(
    width: W,
    formulas: impl Formulas,
    problem: &Problem,
    positions: &[DVec2],
    first: usize,
    step: &SweepParams,
    sought: VertexQuantity,
    found: &mut [T],
) {
    let mut scratch = Scratch::new();
    let mut done = 0;
    while done < found.len() {
        let (vertices, count) = batch_at::<W, false>(problem, first + done, found.len() - done);
        let degree = problem.ring_of(vertices[0]).len();
        let rings =
            Rings::<W::Numbers, GENERAL>::gather(width, problem, positions, vertices, &mut scratch);
        let at = points(width, positions, vertices);
        let patch = Visited { width, rings: &rings, vertices, degree, at };
        let [x, y] = patch.visit::<T, GENERAL>(formulas, problem, step, sought);
        for (lane, found) in found[done..done + count].iter_mut().enumerate() {
            *found = T::new([x.lane(lane), y.lane(lane)]);
        }
        done += count;
    }
}

/// Does the work of [`visit_all`] in a mesh with quadrilaterals.
#[inline(always)]
#[allow(clippy::too_many_arguments)]
fn visit_mixed<W: Width, T: VisitOutput, const GENERAL: bool>(
    width: W,
    formulas: impl Formulas,
    problem: &Problem,
    positions: &[DVec2],
    first: usize,
    step: &SweepParams,
    sought: VertexQuantity,
    found: &mut [T],
) {
    let mut scratch = MixedScratch::new();
    let mut done = 0;
    while done < found.len() {
        let (vertices, count) = batch_at::<W, true>(problem, first + done, found.len() - done);
        let degree = problem.neighbors(vertices[0]).count();
        let rings = &MixedRings::gather(width, problem, positions, vertices, &mut scratch);
        let at = points(width, positions, vertices);
        let patch = Visited { width, rings, vertices, degree, at };
        let [x, y] = patch.visit::<T, GENERAL>(formulas, problem, step, sought);
        for (lane, found) in found[done..done + count].iter_mut().enumerate() {
            *found = T::new([x.lane(lane), y.lane(lane)]);
        }
        done += count;
    }
}

/// Vertices that are visited at once, with their patches.
struct Visited<'a, W: Width, P> {
    width: W,
    rings: &'a P,
    vertices: VertexBatch,
    /// Number of neighbors along edges.
    degree: usize,
    at: [W::Numbers; 2],
}

impl<W: Width, P: LanePatch<W::Numbers>> Visited<'_, W, P> {
    /// Returns the new positions of the vertices, or the quantity `sought`.
    #[inline(always)]
    fn visit<T: VisitOutput, const GENERAL: bool>(
        &self,
        formulas: impl Formulas,
        problem: &Problem,
        step: &SweepParams,
        sought: VertexQuantity,
    ) -> [W::Numbers; 2] {
        let Self { width, rings, vertices, degree, at } = *self;
        if T::STEPS {
            let bounds = GENERAL.then(|| LaneBounds::gather(width, problem, vertices)).flatten();
            return newton::visit::<W::Numbers, P, GENERAL>(formulas, rings, at, bounds, step);
        }
        let (smoothing, shape_guard) = (step.smoothing(), f64::INFINITY);
        let objective = MetricObjective { patch: rings, formulas, smoothing, shape_guard };
        let sum = objective.expansion(at);
        match sought {
            VertexQuantity::Gradient => sum.gradient,
            VertexQuantity::StiffnessRoot => {
                let sum = match rings.inverse_map() {
                    Some(inverse) if GENERAL && !problem.are_levels_in_plane() => {
                        inverse.shape().pull_back(sum)
                    }
                    _ => sum,
                };
                [stiffness_root(&sum, degree); 2]
            }
        }
    }
}

/// Returns the square root of the stiffness, from the derivatives of Σ q²; see [`stiffness_roots`].
#[inline(always)]
fn stiffness_root<T: Numbers>(sum: &Dual<T>, degree: usize) -> T {
    let [xx, xy, yy] = sum.hessian;
    let (mean, half) = ((xx + yy) * 0.5, (xx - yy) * 0.5);
    let radius = Real::sqrt(half * half + xy * xy);
    // The eigenvalues are mean ± radius, so the mean of their absolute values is max(|mean|, radius).
    Real::sqrt(Real::max(Numbers::abs(mean), radius) * (1.0 / degree as f64))
}
