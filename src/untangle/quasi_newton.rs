//! Untangling by quasi-Newton steps of the whole mesh, with a regularization that falls from period to period.
//!
//! Sweeps move each vertex by itself, and stop where only a move of many vertices at once lowers the energy. A step of
//! L-BFGS moves all vertices. The memory of earlier steps approximates the Hessian of the energy, and the coarser levels
//! approximate the Hessian before the first step.
//!
//! Garanzha, Kaporin, Kudryavtseva, Protais, Ray, Sokolov, *Foldover-free maps in 50 lines of code*, ACM Transactions on
//! Graphics 40 (2021), section 2.3 for the rule of the regularization. Nocedal and Wright, *Numerical Optimization* (2006),
//! algorithm 7.4 for L-BFGS.

use std::collections::VecDeque;

use glam::DVec2;

use crate::parallel::{collect, map_ranges};
use crate::run::multilevel::Hierarchy;
use crate::untangle::state::{CHUNK, Region, State, largest, preconditioned};

/// Number of steps whose differences the method stores.
const MEMORY: usize = 10;
/// Share of the predicted decrease that a step must reach (Armijo).
const SUFFICIENT_DECREASE: f64 = 1e-4;
/// Largest share of the initial slope that may remain at the end of a step (Wolfe).
const CURVATURE: f64 = 0.9;
/// Largest number of trials of a step's length.
const TRIALS: u32 = 20;
/// Smallest share by which the regularization falls in a period (Garanzha et al., before equation 6).
const MIN_SHARE: f64 = 0.1;

/// Returns the regularization of the next period. `least` is the smallest area relative to its target area, and
/// `energies` are those before and after the last period, both by the present regularization.
pub(super) fn next_epsilon(epsilon: f64, least: f64, [before, after]: [f64; 2]) -> f64 {
    let share = (1.0 - after / before).max(MIN_SHARE);
    let root = least.hypot(epsilon);
    let fall = if least < 0.0 { share * root / (least.abs() + root) } else { share };
    (1.0 - fall) * epsilon
}

/// The differences of positions and gradients over one step, and the inverse of their product.
struct Pair {
    positions: Vec<DVec2>,
    gradients: Vec<DVec2>,
    inverse_product: f64,
}

/// Steps at a fixed regularization.
pub(super) struct QuasiNewton<'l> {
    levels: &'l Hierarchy,
    region: &'l Region,
    epsilon: f64,
    here: Point,
    /// The latest steps, the oldest first.
    pairs: VecDeque<Pair>,
}

/// A point of the search: the energy and its gradient by the positions of the free vertices.
struct Point {
    energy: f64,
    gradient: Vec<DVec2>,
}

fn dot(a: &[DVec2], b: &[DVec2]) -> f64 {
    let parts = map_ranges(a.len(), CHUNK, |range| {
        a[range.clone()].iter().zip(&b[range]).map(|(a, b)| a.dot(*b)).sum::<f64>()
    });
    parts.into_iter().sum()
}

impl<'l> QuasiNewton<'l> {
    /// Begins at the present positions of `state`. `region` must be the whole mesh.
    pub(super) fn new(
        levels: &'l Hierarchy,
        region: &'l Region,
        epsilon: f64,
        state: &State<'_>,
    ) -> Self {
        let (energy, gradient) = (state.energy(epsilon), state.gradient(region, epsilon));
        let here = Point { energy, gradient };
        Self { levels, region, epsilon, here, pairs: VecDeque::new() }
    }

    /// Returns the energy at the present positions.
    pub(super) fn energy(&self) -> f64 {
        self.here.energy
    }

    /// Moves the free vertices by one step. Returns false if no length of the step lowers the energy.
    pub(super) fn step(&mut self, state: &mut State<'_>) -> bool {
        let here = &self.here;
        let direction = self.direction(state, &here.gradient);
        let slope = dot(&direction, &here.gradient);
        if !(slope < 0.0 && slope.is_finite()) {
            return false;
        }
        let from = state.positions.clone();
        let (mut low, mut high) = (0.0, f64::INFINITY);
        // The levels know the scale of the Hessian only after the first step.
        let mut length = match self.pairs.is_empty() {
            true => (state.mean_target().sqrt() / largest(&direction)).min(1.0),
            false => 1.0,
        };
        let mut best = None;
        for _ in 0..TRIALS {
            state.positions = collect(from.len(), |v| {
                direction.get(v).map_or(from[v], |d| from[v] + *d * length)
            });
            let energy = state.energy(self.epsilon);
            let enough = here.energy + SUFFICIENT_DECREASE * length * slope;
            if energy.is_nan() || energy > enough {
                high = length;
            } else {
                let gradient = state.gradient(self.region, self.epsilon);
                let is_flat = dot(&direction, &gradient) >= CURVATURE * slope;
                low = length;
                best = Some((Point { energy, gradient }, state.positions.clone()));
                if is_flat {
                    break;
                }
            }
            length = if high.is_finite() { 0.5 * (low + high) } else { 2.0 * low };
        }
        let Some((there, positions)) = best else {
            state.positions = from;
            return false;
        };
        state.positions = positions;
        let free = here.gradient.len();
        let positions = collect(free, |v| state.positions[v] - from[v]);
        let gradients = collect(free, |v| there.gradient[v] - here.gradient[v]);
        let product = dot(&positions, &gradients);
        if product > 0.0 && product.is_finite() {
            if self.pairs.len() == MEMORY {
                self.pairs.pop_front();
            }
            self.pairs.push_back(Pair { positions, gradients, inverse_product: 1.0 / product });
        }
        self.here = there;
        true
    }

    /// Returns the direction of the next step by the two loops of L-BFGS.
    fn direction(&self, state: &State<'_>, gradient: &[DVec2]) -> Vec<DVec2> {
        let mut found = gradient.to_vec();
        let mut shares = Vec::with_capacity(self.pairs.len());
        for pair in self.pairs.iter().rev() {
            let share = pair.inverse_product * dot(&pair.positions, &found);
            found = collect(found.len(), |v| found[v] - pair.gradients[v] * share);
            shares.push(share);
        }
        found = preconditioned(self.levels, state.problem, &found);
        if let Some(Pair { gradients, inverse_product, .. }) = self.pairs.back() {
            // The scale of the levels follows from the last step.
            let scale = 1.0
                / (inverse_product
                    * dot(gradients, &preconditioned(self.levels, state.problem, gradients)));
            if scale > 0.0 && scale.is_finite() {
                found = collect(found.len(), |v| found[v] * scale);
            }
        }
        for (pair, share) in self.pairs.iter().zip(shares.into_iter().rev()) {
            let back = pair.inverse_product * dot(&pair.gradients, &found);
            found = collect(found.len(), |v| found[v] + pair.positions[v] * (share - back));
        }
        collect(found.len(), |v| -found[v])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout::{Coloring, Problem, target_areas};
    use crate::mesh::Mesh;
    use crate::topology::Topology;

    /// A square of 8 x 8 pairs of triangles, with the inner vertices mirrored, so that all inner triangles are
    /// inverted.
    fn mirrored() -> Mesh {
        let mut mesh = Mesh::default();
        for (y, x) in (0..9).flat_map(|y| (0..9).map(move |x| (y, x))) {
            let is_inner = (1..8).contains(&x) && (1..8).contains(&y);
            mesh.points.push([f64::from(if is_inner { 8 - x } else { x }), f64::from(y)]);
        }
        for (y, x) in (0..8).flat_map(|y| (0..8).map(move |x| (y, x))) {
            let a = 9 * y + x;
            mesh.triangles.extend([[a, a + 1, a + 10], [a, a + 10, a + 9]]);
        }
        mesh
    }

    #[test]
    fn every_step_lowers_the_energy_until_no_triangle_is_inverted() {
        let mesh = mirrored();
        let topology = Topology::by_area(&mesh).expect("the mesh is valid");
        let problem = Problem::new(&mesh, &topology, &Coloring::new(&topology));
        let mut state = State::new(&problem, target_areas(&problem, problem.positions()));
        let levels = state.hierarchy(&vec![false; problem.free_count()]);
        let region = Region::whole(&problem);
        let mut epsilon = 1.0;
        let (mut steps, mut before) = (0, state.assess(&region).bad);
        assert!(before > 60, "{before} triangles are inverted");
        while before > 0 {
            let mut search = QuasiNewton::new(&levels, &region, epsilon, &state);
            let first = search.energy();
            for _ in 0..20 {
                let last = search.energy();
                if !search.step(&mut state) {
                    break;
                }
                assert!(search.energy() < last, "{last} to {}", search.energy());
                assert_eq!(search.energy(), state.energy(epsilon));
                steps += 1;
            }
            let now = state.assess(&region);
            let next = next_epsilon(epsilon, now.least, [first, search.energy()]);
            assert!(next > 0.0 && next < epsilon);
            (epsilon, before) = (next, now.bad);
            assert!(steps < 500, "{before} triangles are inverted after {steps} steps");
        }
    }

    /// With a great fall of the energy, the regularization goes to 0 on a mesh without inverted triangles, and stays
    /// positive on others.
    #[test]
    fn the_regularization_falls_more_with_a_greater_gain_and_without_inverted_triangles() {
        assert_eq!(next_epsilon(0.5, 0.1, [2.0, 0.0]), 0.0);
        assert_eq!(next_epsilon(0.5, 0.1, [2.0, 1.0]), 0.25);
        assert_eq!(next_epsilon(0.5, 0.1, [2.0, 2.0]), 0.45);
        // √(0.4² + 0.3²) = 0.5, and the whole gain is taken: 1 - 0.5 / (0.4 + 0.5) of 0.3 remain.
        let next = next_epsilon(0.3, -0.4, [2.0, 0.0]);
        assert!((next - 0.3 * (1.0 - 5.0 / 9.0)).abs() < 1e-15, "{next}");
    }
}
