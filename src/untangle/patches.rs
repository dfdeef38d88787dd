//! Loops of untangling over vertices and triangles, in groups of four (one in each lane).

use fearless_simd::Level;
use fearless_simd::prelude::*;
use glam::DVec2;

use crate::layout::Problem;
use crate::metric::{Dual, Own, Real};
use crate::parallel::{for_each_chunk, map_parts};
use crate::patch::lanes::{LANES, Lanes, Mask, Points, numbers, points, with_instructions};
use crate::patch::{Objective, SearchRule, VertexBatch, newton_step};
use crate::untangle::energy::Corner;

/// Number of batches of vertices in one parallel task.
const BATCHES: usize = 256;
/// Number of triangles in one parallel task.
const TRIANGLES: usize = 1 << 12;

/// A mesh with its present positions and target areas, for one pass of untangling.
#[derive(Clone, Copy)]
pub(super) struct Tangle<'a> {
    pub(super) problem: &'a Problem,
    pub(super) positions: &'a [DVec2],
    /// Target area at each vertex, in normalized units. The target area of a triangle is the mean over its vertices.
    pub(super) targets: &'a [f64],
}

impl Tangle<'_> {
    /// Returns the position of each vertex after a Newton step with a line search. No two of the vertices may be
    /// neighbors.
    pub(super) fn steps(&self, batches: &[VertexBatch], epsilon: f64) -> Vec<[DVec2; LANES]> {
        self.visits::<true>(batches, epsilon)
    }

    /// Returns the gradient of the energy by the position of each vertex.
    pub(super) fn gradients(&self, batches: &[VertexBatch], epsilon: f64) -> Vec<[DVec2; LANES]> {
        self.visits::<false>(batches, epsilon)
    }

    /// Returns positions after steps if `STEPS`, and gradients otherwise.
    fn visits<const STEPS: bool>(
        &self,
        batches: &[VertexBatch],
        epsilon: f64,
    ) -> Vec<[DVec2; LANES]> {
        let mut found = vec![[DVec2::ZERO; LANES]; batches.len()];
        for_each_chunk(&mut found, BATCHES, |first, found| {
            with_instructions!(Level::new(), simd => {
                let mut scratch = Vec::new();
                for (found, &batch) in found.iter_mut().zip(&batches[first..]) {
                    let at = points(simd, self.positions, batch);
                    let patches = EnergyRings::gather(simd, self, batch, epsilon, &mut scratch);
                    let [x, y] = match STEPS {
                        true => {
                            let going = Mask::splat(simd, true);
                            newton_step(&patches, at, going, &SearchRule::UNTANGLE).0
                        }
                        false => patches.expansion(at).gradient,
                    };
                    for lane in 0..LANES {
                        found[lane] = DVec2::new(x[lane], y[lane]);
                    }
                }
            });
        });
        found
    }

    /// Returns the energy of all triangles. Threads do not change the order of the sum.
    pub(super) fn energy(&self, epsilon: f64) -> f64 {
        let sums = map_parts(
            self.problem.triangles().chunks(TRIANGLES),
            |_, triangles| with_instructions!(Level::new(), simd => self.energy_of(simd, triangles, epsilon)),
        );
        sums.into_iter().sum()
    }

    #[inline(always)]
    fn energy_of<S: Simd>(&self, simd: S, triangles: &[[u32; 3]], epsilon: f64) -> f64 {
        let (fours, rest) = triangles.as_chunks::<LANES>();
        let mut sum = Lanes::splat(simd, 0.0);
        for [t, u, v, w] in fours {
            let first = [t[0], u[0], v[0], w[0]];
            let second = [t[1], u[1], v[1], w[1]];
            let third = [t[2], u[2], v[2], w[2]];
            let p = points(simd, self.positions, first);
            let q = points(simd, self.positions, second);
            let r = points(simd, self.positions, third);
            let targets = numbers(simd, self.targets, first)
                + numbers(simd, self.targets, second)
                + numbers(simd, self.targets, third);
            sum += corner(p, [q, r], targets).energy(epsilon);
        }
        let last: f64 = rest.iter().map(|t| self.triangle(t).energy(epsilon)).sum();
        (sum[0] + sum[1]) + (sum[2] + sum[3]) + last
    }

    /// Returns a triangle, seen from its first vertex.
    #[inline]
    pub(super) fn triangle(&self, vertices: &[u32; 3]) -> Corner<f64> {
        let [p, q, r] = vertices.map(|v| self.positions[v as usize].to_array());
        let [a, b, c] = vertices.map(|v| self.targets[v as usize]);
        corner(p, [q, r], a + b + c)
    }
}

/// Returns the triangles with one corner at `at` and the others at `p` and `q`. `targets` are three times the target
/// areas.
#[inline(always)]
fn corner<T: Real>(at: [T; 2], [p, q]: [[T; 2]; 2], targets: T) -> Corner<T> {
    Corner { edges: edges(at, [p, q]), inverse_target: at[0].constant(3.0) / targets }
}

#[inline(always)]
fn edges<T: Real>(at: [T; 2], [p, q]: [[T; 2]; 2]) -> [[T; 2]; 2] {
    [[p[0] - at[0], p[1] - at[1]], [q[0] - at[0], q[1] - at[1]]]
}

/// The one-rings of four vertices, with the energy of their triangles as an objective.
struct EnergyRings<'r, S: Simd> {
    /// Regularization width ε of the energy, in units of the target area.
    epsilon: f64,
    /// For each neighbor, its position and the inverse target area of the triangle with the next neighbor. Neighbors
    /// are in counter-clockwise order, and the first neighbor is repeated at the end.
    ring: &'r [(Points<S>, Lanes<S>)],
}

impl<'r, S: Simd> EnergyRings<'r, S> {
    /// Reads the one-rings of four vertices into `scratch`.
    #[inline(always)]
    fn gather(
        simd: S,
        tangle: &Tangle<'_>,
        batch: VertexBatch,
        epsilon: f64,
        scratch: &'r mut Vec<(Points<S>, Lanes<S>)>,
    ) -> Self {
        let [a, b, c, d] = batch;
        let a = tangle.problem.ring_of(a);
        let degree = a.len();
        let b = &tangle.problem.ring_of(b)[..degree];
        let c = &tangle.problem.ring_of(c)[..degree];
        let d = &tangle.problem.ring_of(d)[..degree];
        scratch.clear();
        for i in 0..degree {
            let neighbors = [a[i], b[i], c[i], d[i]];
            let target = numbers(simd, tangle.targets, neighbors);
            scratch.push((points(simd, tangle.positions, neighbors), target));
        }
        scratch.push(scratch[0]);
        let own = numbers(simd, tangle.targets, batch);
        for i in 0..degree {
            scratch[i].1 = own.constant(3.0) / (own + scratch[i].1 + scratch[i + 1].1);
        }
        Self { epsilon, ring: scratch }
    }

    /// Returns the triangle between the neighbors `i` and `i` + 1, with the visited vertices at `at`.
    #[inline(always)]
    fn corner(&self, i: usize, at: Points<S>) -> Corner<Lanes<S>> {
        let ((p, inverse_target), (q, _)) = (self.ring[i], self.ring[i + 1]);
        Corner { edges: edges(at, [p, q]), inverse_target }
    }
}

impl<S: Simd> Objective<Lanes<S>> for EnergyRings<'_, S> {
    #[inline(always)]
    fn expansion(&self, at: Points<S>) -> Dual<Lanes<S>> {
        let zero = at[0].constant(0.0);
        let mut sum = Dual { value: zero, gradient: [zero; 2], hessian: [zero; 3] };
        for i in 0..self.ring.len() - 1 {
            sum = sum + self.corner(i, at).expansion(Own, self.epsilon);
        }
        sum
    }

    #[inline(always)]
    fn trial(&self, to: Points<S>, _: Lanes<S>) -> (Lanes<S>, Mask<S>) {
        let mut sum = to[0].constant(0.0);
        for i in 0..self.ring.len() - 1 {
            sum += self.corner(i, to).energy(self.epsilon);
        }
        (sum, Mask::splat(sum.simd, true))
    }
}
