//! Steps of vertices at the limit of their moves, four vertices at a time.

use fearless_simd::Level;
use fearless_simd::prelude::*;
use glam::DVec2;

use crate::layout::{MeshCoordinates, Problem};
use crate::metric::{AnyFormulas, Dual, Real};
use crate::parallel::for_each_chunk;
use crate::patch::lanes::{LANES, Lanes, Mask, Points, numbers, points, with_instructions};
use crate::patch::numbers::Numbers;
use crate::patch::{
    Circle, Direction, MetricObjective, Objective, Rings, Scratch, SearchRule, VertexBatch,
    newton_step,
};
use crate::run::SweepParams;

/// Number of batches that one task visits.
const CHUNK: usize = 64;

/// Returns the positions of vertices after a step by [`SearchRule::BOUND`]. No two of the vertices may be neighbors. The
/// circles around the positions of the problem with the given radii (normalized, one for each free vertex) limit the
/// moves, in the coordinates of the mesh.
pub(crate) fn steps_at_bound(
    problem: &Problem,
    positions: &[DVec2],
    batches: &[VertexBatch],
    radii: &[f64],
    step: &SweepParams,
) -> Vec<[DVec2; LANES]> {
    let mut found = vec![[DVec2::ZERO; LANES]; batches.len()];
    for_each_chunk(&mut found, CHUNK, |first, found| {
        with_instructions!(Level::new(), simd => {
            let mut scratch = Scratch::new();
            let coordinates = problem.coordinates();
            let slope = |v: u32| coordinates.slopes(positions[v as usize])[0];
            let (formulas, smoothing) = (step.metric.formulas(), step.smoothing());
            for (found, &batch) in found.iter_mut().zip(&batches[first..]) {
                let patch = &Rings::<_, true>::gather(simd, problem, positions, batch, &mut scratch);
                let shape_guard = step.shape_guard;
                let objective = BoundObjective {
                    metric: MetricObjective { patch, formulas, smoothing, shape_guard },
                    coordinates,
                    slope: Lanes::simd_from(simd, batch.map(slope)),
                    center: points(simd, problem.positions(), batch),
                    radius: numbers(simd, radii, batch),
                };
                let (at, going) = (points(simd, positions, batch), Mask::splat(simd, true));
                let ([x, y], _) = newton_step(&objective, at, going, &SearchRule::BOUND);
                for lane in 0..LANES {
                    found[lane] = DVec2::new(x[lane], y[lane]);
                }
            }
        });
    });
    found
}

/// The objective of vertices at the circles of their bounds. Trials beyond the bound are projected to the circle.
struct BoundObjective<'a, S: Simd> {
    /// The triangles have identity maps on meshes without targets.
    metric: MetricObjective<'a, Rings<'a, S, true>, AnyFormulas>,
    coordinates: MeshCoordinates,
    /// Derivative of the mesh's second coordinate by the second coordinate of the positions.
    slope: Lanes<S>,
    /// Positions of the centers of the circles.
    center: Points<S>,
    radius: Lanes<S>,
}

impl<S: Simd> BoundObjective<'_, S> {
    /// Does the work of [`point`](Objective::point) for vertices that move in a projection, lane by lane.
    fn projected_point(&self, on_line: Points<S>) -> Points<S> {
        let (mut found, coordinates) = (on_line, self.coordinates);
        for lane in 0..LANES {
            let [to, center] = [on_line, self.center].map(|[x, y]| DVec2::new(x[lane], y[lane]));
            let circle = Circle { center: coordinates.at(center), radius: self.radius[lane] };
            let nearest = circle.nearest_position(coordinates, to);
            (found[0][lane], found[1][lane]) = (nearest.x, nearest.y);
        }
        found
    }
}

impl<S: Simd> Objective<Lanes<S>> for BoundObjective<'_, S> {
    #[inline(always)]
    fn expansion(&self, at: Points<S>) -> Dual<Lanes<S>> {
        self.metric.expansion(at)
    }

    /// Returns the negative gradient, divided by the largest curvature, both by the coordinates of the mesh, in which the
    /// bound is a circle. Steps move a vertex along its bound as well as inward.
    #[inline(always)]
    fn direction(&self, here: &Dual<Lanes<S>>, _: f64) -> Direction<Lanes<S>> {
        let slope = self.slope;
        let ([x, y], [xx, xy, yy]) = (here.gradient, here.hessian);
        let (y, xy, yy) = (y / slope, xy / slope, yy / (slope * slope));
        let (mean, half) = ((xx + yy) * 0.5, (xx - yy) * 0.5);
        let most = Numbers::abs(mean) + Real::sqrt(half * half + xy * xy);
        let vector = [-x / most, -y / most];
        let infinity = most.constant(f64::INFINITY);
        let is_finite = |x: Lanes<S>| Numbers::abs(x).lt(infinity);
        let descends = is_finite(vector[0]) & is_finite(vector[1]);
        let along = vector[0] * x + vector[1] * y;
        Direction { vector: [vector[0], vector[1] / slope], slope: along, descends }
    }

    /// Returns the given point, or the nearest point of the circle if the given point is outside.
    #[inline(always)]
    fn point(&self, on_line: Points<S>) -> Points<S> {
        if self.coordinates.is_projected() {
            return self.projected_point(on_line);
        }
        let [cx, cy] = self.center;
        let (x, y) = (on_line[0] - cx, on_line[1] - cy);
        let distance = Real::sqrt(x * x + y * y);
        let (is_inside, share) = (distance.le(self.radius), self.radius / distance);
        [
            Lanes::select(is_inside, on_line[0], cx + x * share),
            Lanes::select(is_inside, on_line[1], cy + y * share),
        ]
    }

    #[inline(always)]
    fn trial(&self, to: Points<S>, max_imr: Lanes<S>) -> (Lanes<S>, Mask<S>) {
        self.metric.trial(to, max_imr)
    }

    #[inline(always)]
    fn shape_guard(&self) -> f64 {
        self.metric.shape_guard
    }

    #[inline(always)]
    fn worst_shape(&self, at: Points<S>) -> Lanes<S> {
        self.metric.worst_shape(at)
    }
}
