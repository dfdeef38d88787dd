//! Loops of untangling over vertices and corners, one in each lane.

use glam::DVec2;

use crate::layout::Problem;
use crate::metric::{Dual, Own, Real, of_right_angle};
use crate::parallel::{for_each_chunk, map_parts};
use crate::patch::instructions::with_instructions;
use crate::patch::lanes::{LANES, Width, numbers, points};
use crate::patch::numbers::Numbers;
use crate::patch::{Objective, Role, SearchRule, Sums, VertexBatch, from_lane, newton_step};
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
            let batches = &batches[first..][..found.len()];
            with_instructions!(width => self.visit_all::<_, STEPS>(width, batches, epsilon, found));
        });
        found
    }

    #[inline(always)]
    fn visit_all<W: Width, const STEPS: bool>(
        &self,
        width: W,
        batches: &[VertexBatch],
        epsilon: f64,
        found: &mut [[DVec2; LANES]],
    ) {
        let (mut scratch, mut corners) = (Vec::new(), Vec::new());
        for (found, batch) in found.iter_mut().zip(batches) {
            let mut lane = 0;
            while lane < LANES {
                let these = if W::Numbers::LANES == LANES { *batch } else { [batch[lane]; LANES] };
                let at = points(width, self.positions, these);
                let [x, y] = if self.problem.has_quadrilaterals() {
                    let patches = MixedEnergy::gather(width, self, these, epsilon, &mut corners);
                    visit::<_, STEPS>(&patches, at)
                } else {
                    let patches = EnergyRings::gather(width, self, these, epsilon, &mut scratch);
                    visit::<_, STEPS>(&patches, at)
                };
                for k in 0..W::Numbers::LANES {
                    found[lane + k] = DVec2::new(x.lane(k), y.lane(k));
                }
                lane += W::Numbers::LANES;
            }
        }
    }

    /// Returns the energy of all elements. Threads do not change the order of the sum.
    pub(super) fn energy(&self, epsilon: f64) -> f64 {
        let sums = map_parts(
            self.problem.triangles().chunks(TRIANGLES),
            |_, triangles| with_instructions!(width => self.energy_of(width, triangles, epsilon)),
        );
        let sum: f64 = sums.into_iter().sum();
        if !self.problem.has_quadrilaterals() {
            return sum;
        }
        let [_, right] = self.problem.corner_parts();
        let of = |t: &[u32; 3]| self.corner(true, t).energy(epsilon);
        let sums =
            map_parts(right.corners.chunks(TRIANGLES), |_, part| part.iter().map(of).sum::<f64>());
        sum + right.weight() * sums.into_iter().sum::<f64>()
    }

    #[inline(always)]
    fn energy_of<W: Width>(&self, width: W, triangles: &[[u32; 3]], epsilon: f64) -> f64 {
        let (fours, rest) = triangles.as_chunks::<LANES>();
        let mut sums = Sums::new(width);
        for four in fours {
            let mut lane = 0;
            while lane < LANES {
                let [t, u, v, w] = from_lane::<W>(four, lane);
                let first = [t[0], u[0], v[0], w[0]];
                let second = [t[1], u[1], v[1], w[1]];
                let third = [t[2], u[2], v[2], w[2]];
                let p = points(width, self.positions, first);
                let q = points(width, self.positions, second);
                let r = points(width, self.positions, third);
                let targets = numbers(width, self.targets, first)
                    + numbers(width, self.targets, second)
                    + numbers(width, self.targets, third);
                sums.add(lane, corner(p, [q, r], targets).energy(epsilon));
                lane += W::Numbers::LANES;
            }
        }
        let last: f64 = rest.iter().map(|t| self.corner(false, t).energy(epsilon)).sum();
        sums.total() + last
    }

    /// Returns a corner, seen from its first vertex: a triangle, or the sheared corner of a quadrilateral if it `is_right`.
    #[inline]
    pub(super) fn corner(&self, is_right: bool, vertices: &[u32; 3]) -> Corner<f64> {
        let [p, q, r] = vertices.map(|v| self.positions[v as usize].to_array());
        let [a, b, c] = vertices.map(|v| self.targets[v as usize]);
        let triangle = corner(p, [q, r], a + b + c);
        match is_right {
            true => Corner { edges: of_right_angle(triangle.edges), ..triangle },
            false => triangle,
        }
    }
}

/// Returns the positions after a step of the visited vertices if `STEPS`, and gradients otherwise.
#[inline(always)]
fn visit<T: Numbers, const STEPS: bool>(patches: &impl Objective<T>, at: [T; 2]) -> [T; 2] {
    match STEPS {
        true => {
            let going = at[0].mask(true);
            newton_step(patches, at, going, &SearchRule::UNTANGLE).0
        }
        false => patches.expansion(at).gradient,
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

/// The one-rings of vertices that are visited at once, with the energy of their triangles as an objective.
struct EnergyRings<'r, T: Numbers> {
    /// Regularization width ε of the energy, in units of the target area.
    epsilon: f64,
    /// For each neighbor, its position and the inverse target area of the triangle with the next neighbor. Neighbors
    /// are in counter-clockwise order, and the first neighbor is repeated at the end.
    ring: &'r [([T; 2], T)],
}

impl<'r, T: Numbers> EnergyRings<'r, T> {
    /// Reads the one-rings of vertices into `scratch`.
    #[inline(always)]
    fn gather<W: Width<Numbers = T>>(
        width: W,
        tangle: &Tangle<'_>,
        batch: VertexBatch,
        epsilon: f64,
        scratch: &'r mut Vec<([T; 2], T)>,
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
            let target = numbers(width, tangle.targets, neighbors);
            scratch.push((points(width, tangle.positions, neighbors), target));
        }
        scratch.push(scratch[0]);
        let own = numbers(width, tangle.targets, batch);
        for i in 0..degree {
            scratch[i].1 = own.constant(3.0) / (own + scratch[i].1 + scratch[i + 1].1);
        }
        Self { epsilon, ring: scratch }
    }

    /// Returns the triangle between the neighbors `i` and `i` + 1, with the visited vertices at `at`.
    #[inline(always)]
    fn corner(&self, i: usize, at: [T; 2]) -> Corner<T> {
        let ((p, inverse_target), (q, _)) = (self.ring[i], self.ring[i + 1]);
        Corner { edges: edges(at, [p, q]), inverse_target }
    }
}

impl<T: Numbers> Objective<T> for EnergyRings<'_, T> {
    #[inline(always)]
    fn expansion(&self, at: [T; 2]) -> Dual<T> {
        let zero = at[0].constant(0.0);
        let mut sum = Dual { value: zero, gradient: [zero; 2], hessian: [zero; 3] };
        for i in 0..self.ring.len() - 1 {
            sum = sum + self.corner(i, at).expansion(Own, self.epsilon);
        }
        sum
    }

    #[inline(always)]
    fn trial(&self, to: [T; 2], _: T) -> (T, T::Mask) {
        let mut sum = to[0].constant(0.0);
        for i in 0..self.ring.len() - 1 {
            sum = sum + self.corner(i, to).energy(self.epsilon);
        }
        (sum, sum.mask(true))
    }
}

/// A corner of each vertex that is visited at once, in equal roles.
#[derive(Clone, Copy)]
struct LaneCorner<T: Numbers> {
    role: Role,
    /// Positions of the other two vertices, counter-clockwise.
    others: [[T; 2]; 2],
    inverse_target: T,
}

/// The corners of vertices in a mesh with quadrilaterals, with their energy as an objective.
struct MixedEnergy<'r, T: Numbers> {
    epsilon: f64,
    corners: &'r [LaneCorner<T>],
}

impl<'r, T: Numbers> MixedEnergy<'r, T> {
    /// Reads the corners of vertices whose elements are of equal kinds in equal order, into `scratch`.
    #[inline(always)]
    fn gather<W: Width<Numbers = T>>(
        width: W,
        tangle: &Tangle<'_>,
        batch: VertexBatch,
        epsilon: f64,
        scratch: &'r mut Vec<LaneCorner<T>>,
    ) -> Self {
        scratch.clear();
        let [mut a, mut b, mut c, mut d] = batch.map(|v| tangle.problem.corners_around(v));
        while let (Some(one), Some(two), Some(three), Some(four)) =
            (a.next(), b.next(), c.next(), d.next())
        {
            let corners = [one.0, two.0, three.0, four.0];
            let of = |lane: usize| Role::of(corners[lane], one.1, batch[lane]);
            let (role, lanes) = (of(0).0, [of(0).1, of(1).1, of(2).1, of(3).1]);
            let first = [lanes[0][0], lanes[1][0], lanes[2][0], lanes[3][0]];
            let second = [lanes[0][1], lanes[1][1], lanes[2][1], lanes[3][1]];
            let targets = numbers(width, tangle.targets, batch)
                + numbers(width, tangle.targets, first)
                + numbers(width, tangle.targets, second);
            let others = [first, second].map(|vertices| points(width, tangle.positions, vertices));
            let inverse_target = targets.constant(3.0) / targets;
            scratch.push(LaneCorner { role, others, inverse_target });
        }
        Self { epsilon, corners: scratch }
    }

    /// Returns corner `i` with the visited vertices at `at`.
    #[inline(always)]
    fn corner(&self, i: usize, at: [T; 2]) -> Corner<T> {
        let LaneCorner { role, others, inverse_target } = self.corners[i];
        let [p, q, r] = role.vertices(at, others);
        let edges = edges(p, [q, r]);
        let edges = if role.is_right() { of_right_angle(edges) } else { edges };
        Corner { edges, inverse_target }
    }
}

impl<T: Numbers> Objective<T> for MixedEnergy<'_, T> {
    #[inline(always)]
    fn expansion(&self, at: [T; 2]) -> Dual<T> {
        let zero = at[0].constant(0.0);
        let mut sum = Dual { value: zero, gradient: [zero; 2], hessian: [zero; 3] };
        for i in 0..self.corners.len() {
            let role = self.corners[i].role;
            let term = self.corner(i, at).expansion(role.slopes(), self.epsilon);
            sum = sum + role.weighted(term);
        }
        sum
    }

    #[inline(always)]
    fn trial(&self, to: [T; 2], _: T) -> (T, T::Mask) {
        let mut sum = to[0].constant(0.0);
        for i in 0..self.corners.len() {
            let role = self.corners[i].role;
            sum = sum + role.weighted(self.corner(i, to).energy(self.epsilon));
        }
        (sum, sum.mask(true))
    }
}
