//! Untangling by Newton steps of the whole mesh, with a regularization that falls from period to period.
//!
//! Sweeps move each vertex by itself, and stop where only a move of many vertices at once lowers the energy. A Newton
//! step moves all vertices. Conjugate gradients solve for the step, preconditioned by the block of each vertex. The
//! Hessian is replaced by its convex part, so every step descends.
//!
//! Garanzha, Kaporin, Kudryavtseva, Protais, Ray, Sokolov, *Foldover-free maps in 50 lines of code*, ACM Transactions on
//! Graphics 40 (2021), section 2.3 for the rule of the regularization. Nocedal and Wright, *Numerical Optimization* (2006),
//! algorithm 7.1 for steps by conjugate gradients.

use glam::{DMat2, DVec2};

use crate::layout::{OPPOSITE, Problem};
use crate::metric::Given;
use crate::parallel::{collect, map_ranges};
use crate::patch::Role;
use crate::untangle::state::{CHUNK, Region, State, update};

/// Share of the predicted decrease that a step must reach (Armijo).
const SUFFICIENT_DECREASE: f64 = 1e-4;
/// Largest number of trials of a step's length.
const TRIALS: u32 = 40;
/// Largest number of iterations of conjugate gradients in a step.
const ITERATIONS: u32 = 200;
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

/// Newton steps at a fixed regularization.
pub(super) struct Newton<'r> {
    region: &'r Region,
    epsilon: f64,
    /// Share of the residual (0 to 1) at which conjugate gradients end, in the norm of the preconditioner.
    residual: f64,
    /// The energy at the present positions.
    energy: f64,
}

impl<'r> Newton<'r> {
    /// Begins at the present positions of `state`. `region` must be the whole mesh.
    pub(super) fn new(region: &'r Region, epsilon: f64, residual: f64, state: &State<'_>) -> Self {
        Self { region, epsilon, residual, energy: state.energy(epsilon) }
    }

    /// Returns the energy at the present positions.
    pub(super) fn energy(&self) -> f64 {
        self.energy
    }

    /// Moves the free vertices by one step. Returns false if no length of the step lowers the energy.
    pub(super) fn step(&mut self, state: &mut State<'_>) -> bool {
        let gradient = state.gradient(self.region, self.epsilon);
        let direction = Hessian::new(state, self.epsilon).direction(&gradient, self.residual);
        let slope = dot(&direction, &gradient);
        if !(slope < 0.0 && slope.is_finite()) {
            return false;
        }
        let from = state.positions.clone();
        let mut energy_at = |length: f64| {
            state.positions = collect(from.len(), |v| {
                direction.get(v).map_or(from[v], |d| from[v] + *d * length)
            });
            state.energy(self.epsilon)
        };
        let is_enough =
            |length, energy| energy <= self.energy + SUFFICIENT_DECREASE * length * slope;
        let (mut length, mut energy) = (1.0, energy_at(1.0));
        let factor = if is_enough(length, energy) { 2.0 } else { 0.5 };
        for _ in 0..TRIALS {
            let next = energy_at(length * factor);
            if is_enough(length, energy) && (next.is_nan() || next >= energy) {
                break;
            }
            (length, energy) = (length * factor, next);
        }
        let is_lower = is_enough(length, energy);
        energy_at(if is_lower { length } else { 0.0 });
        if is_lower {
            self.energy = energy;
        }
        is_lower
    }
}

/// The convex part of the Hessian by the positions of the free vertices, as blocks of two rows and columns.
struct Hessian<'p> {
    problem: &'p Problem,
    /// The block of each free vertex.
    own: Vec<DMat2>,
    /// The blocks of each free vertex with its neighbors, in the order of [`Problem::ring`].
    mixed: Vec<DMat2>,
}

impl<'p> Hessian<'p> {
    fn new(state: &State<'p>, epsilon: f64) -> Self {
        let problem = state.problem;
        let parts = map_ranges(problem.free_count(), CHUNK, |range| {
            let (mut own, mut mixed) = (Vec::new(), Vec::new());
            for v in range {
                let ring = problem.ring_of(v as u32);
                let (first, mut sum) = (mixed.len(), DMat2::ZERO);
                mixed.resize(first + ring.len(), DMat2::ZERO);
                if problem.has_quadrilaterals() {
                    own.push(of_mixed_ring(state, v as u32, epsilon, &mut mixed[first..]));
                    continue;
                }
                for i in 0..ring.len() {
                    let next = (i + 1) % ring.len();
                    let [block, one, other] =
                        state.corner(false, &[v as u32, ring[i], ring[next]]).blocks(epsilon);
                    sum += block;
                    mixed[first + i] += one;
                    mixed[first + next] += other;
                }
                own.push(sum);
            }
            (own, mixed)
        });
        let (own, mixed): (Vec<_>, Vec<_>) = parts.into_iter().unzip();
        Self { problem, own: own.concat(), mixed: mixed.concat() }
    }

    /// Returns the product with the moves of the free vertices. Fixed vertices do not move.
    fn product(&self, moves: &[DVec2]) -> Vec<DVec2> {
        collect(moves.len(), |v| {
            let ring = self.problem.ring_range(v as u32);
            let neighbors = self.problem.ring()[ring.clone()].iter().zip(&self.mixed[ring]);
            let of = |k: u32| moves.get((k & !OPPOSITE) as usize);
            let mixed = neighbors.filter_map(|(&k, block)| Some(*block * *of(k)?));
            self.own[v] * moves[v] + mixed.sum::<DVec2>()
        })
    }

    /// Returns moves of the free vertices that cancel the gradient, up to the share `enough` of the residual.
    fn direction(&self, gradient: &[DVec2], enough: f64) -> Vec<DVec2> {
        let free = gradient.len();
        let inverses = collect(free, |v| self.own[v].inverse());
        let preconditioned = |residual: &[DVec2]| collect(free, |v| inverses[v] * residual[v]);
        let mut residual = collect(free, |v| -gradient[v]);
        let mut along = preconditioned(&residual);
        let mut norm = dot(&residual, &along);
        let last = enough * enough * norm;
        let mut found = vec![DVec2::ZERO; free];
        for _ in 0..ITERATIONS {
            let product = self.product(&along);
            let length = norm / dot(&along, &product);
            if !(length > 0.0 && length.is_finite()) {
                break;
            }
            update(&mut found, |v, found| *found += along[v] * length);
            update(&mut residual, |v, residual| *residual -= product[v] * length);
            let next = preconditioned(&residual);
            let before = std::mem::replace(&mut norm, dot(&residual, &next));
            if norm <= last {
                break;
            }
            update(&mut along, |v, along| *along = next[v] + *along * (norm / before));
        }
        found
    }
}

/// Adds the blocks of a free vertex with the other vertices of its elements to `mixed`, in the order of its one-ring, in a mesh
/// with quadrilaterals. Returns its own block.
fn of_mixed_ring(state: &State<'_>, vertex: u32, epsilon: f64, mixed: &mut [DMat2]) -> DMat2 {
    let ring = state.problem.ring_of(vertex);
    let place = |k: u32| ring.iter().position(|&other| other & !OPPOSITE == k);
    let mut sum = DMat2::ZERO;
    for (corner, is_right) in state.problem.corners_around(vertex) {
        let (role, others) = Role::of(corner, is_right, vertex);
        let weight = role.weighted(1.0);
        // The slopes of all three vertices, counter-clockwise.
        let slopes = match is_right {
            true => [Role::Own, Role::Last, Role::Next].map(Role::slopes),
            false => [Given(-1.0, -1.0), Given(1.0, 0.0), Given(0.0, 1.0)],
        };
        let by = |k: u32| corner.iter().position(|&v| v == k).map_or(slopes[0], |at| slopes[at]);
        let [own, one, two] = state.corner(is_right, &corner).blocks_by(
            by(vertex),
            [by(vertex), by(others[0]), by(others[1])],
            epsilon,
        );
        sum += own * weight;
        for (k, block) in others.into_iter().zip([one, two]) {
            if let Some(at) = place(k) {
                mixed[at] += block * weight;
            }
        }
    }
    sum
}

fn dot(a: &[DVec2], b: &[DVec2]) -> f64 {
    let parts = map_ranges(a.len(), CHUNK, |range| {
        a[range.clone()].iter().zip(&b[range]).map(|(a, b)| a.dot(*b)).sum::<f64>()
    });
    parts.into_iter().sum()
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
        let region = Region::whole(&problem);
        let mut epsilon = 1.0;
        let (mut steps, mut before) = (0, state.assess(&region).bad);
        assert!(before > 60, "{before} triangles are inverted");
        while before > 0 {
            let mut search = Newton::new(&region, epsilon, 0.5, &state);
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
