//! Tests of the Newton step for `f64`, for lanes, and for corners with slopes of their own.

use std::cell::RefCell;
use std::ops::Mul;

use fearless_simd::prelude::*;
use glam::DVec2;

use super::instructions::with_instructions;
use super::lanes::{LANES, Lanes, Mask};
use super::{
    Corners, Direction, FanCorner, FanPatch, MetricObjective, Objective, Rings, Role, Scratch,
    SearchRule, is_acceptable, is_kept, newton_step,
};
use crate::layout::{Problem, prepare};
use crate::mesh::Mesh;
use crate::metric::{Corner, Dual, Given, Ideal, Metric, Smoothing};

/// Returns a hexagon of six triangles around one free vertex.
fn hexagon() -> Problem {
    let corner = |k: u32| (f64::from(k) * std::f64::consts::FRAC_PI_3).sin_cos();
    let mut points: Vec<[f64; 2]> = (0..6).map(corner).map(|(y, x)| [1.2 * x, y]).collect();
    points.push([0.1, 0.2]);
    let triangles = (0..6).map(|k| [k, (k + 1) % 6, 6]).collect();
    prepare(&Mesh { points, triangles, ..Mesh::default() }).unwrap().1
}

/// Returns the triangles around the first vertex, in the order of its one-ring.
fn fan(problem: &Problem) -> FanPatch {
    let ring = problem.ring_of(0);
    let next = ring.iter().cycle().skip(1);
    let corner = |(&p, &q): (&u32, &u32)| FanCorner {
        ends: [p, q].map(|v| problem.positions()[v as usize]),
        map: problem.target_map(&[0, p, q]),
        role: Role::Triangle,
    };
    let corners = ring.iter().zip(next).map(corner).collect();
    let (ideal, coordinates) = (problem.ideal(), problem.coordinates());
    FanPatch { corners, opposites: Vec::new(), ideal, coordinates, min_altitude: 0.0 }
}

/// Returns positions of the vertex: well inside the hexagon, and so near an edge that first trials are lengthened.
fn places(problem: &Problem) -> [[f64; 2]; LANES] {
    let [first, second] = [0, 1].map(|i| problem.positions()[problem.ring_of(0)[i] as usize]);
    let middle = (first + second) * 0.5;
    [0.1, 0.6, 0.99, 1.0 - 1e-9].map(|share| (middle * share).to_array())
}

fn rule(metric: Metric, omega: f64) -> SearchRule {
    let properties = metric.properties();
    SearchRule {
        first_length: omega,
        eigenvalue_floor: properties.eigenvalue_floor,
        max_lengthening: properties.barrier.then_some(8.0),
        ..SearchRule::SWEEP
    }
}

#[test]
fn a_newton_step_in_lanes_has_the_bits_of_the_step_of_each_vertex_alone() {
    let problem = hexagon();
    let (patch, places) = (&fan(&problem), places(&problem));
    let mut moved = 0;
    for &metric in Metric::ALL {
        for shape_guard in [f64::INFINITY, 1.5] {
            let (formulas, smoothing) = (metric.formulas(), Smoothing::of(3));
            let rule = rule(metric, 1.5);
            let together = with_instructions!(simd => {
                let mut scratch = Scratch::new();
                let rings = Rings::<_, false>::gather(
                    simd, &problem, problem.positions(), [0; LANES], &mut scratch,
                );
                let objective =
                    MetricObjective { patch: &rings, formulas, smoothing, shape_guard };
                let at = [0, 1].map(|axis| {
                    Lanes::simd_from(simd, places.map(|place| place[axis]))
                });
                let going = Mask::splat(simd, true);
                let ([x, y], _) = newton_step(&objective, at, going, &rule);
                let lanes: [[f64; 2]; LANES] = std::array::from_fn(|lane| [x[lane], y[lane]]);
                lanes
            }, alone => return);
            for (place, found) in places.into_iter().zip(together) {
                let objective = MetricObjective { patch, formulas, smoothing, shape_guard };
                let (alone, has_stepped) = newton_step(&objective, place, true, &rule);
                assert_eq!(found, alone, "{metric}, guard {shape_guard}, from {place:?}");
                assert_eq!(has_stepped, alone != place);
                moved += u32::from(has_stepped);
            }
        }
    }
    assert!(moved > 50, "{moved}");
}

#[test]
fn a_step_inverts_no_triangle_and_leaves_none_above_the_guard_and_the_worst_before() {
    let problem = hexagon();
    let patch = &fan(&problem);
    for &metric in Metric::ALL {
        for place in places(&problem) {
            let (formulas, smoothing, shape_guard) = (metric.formulas(), Smoothing::of(3), 1.3);
            let objective = MetricObjective { patch, formulas, smoothing, shape_guard };
            let before = objective.worst_shape(place);
            let (to, _) = newton_step(&objective, place, true, &rule(metric, 2.0));
            let most = before.max(shape_guard);
            assert!(is_acceptable(patch, formulas, to, most * (1.0 + 1e-12)), "{metric}");
            assert!(objective.worst_shape(to) <= most * (1.0 + 1e-12), "{metric}");
        }
    }
}

#[test]
fn a_triangle_is_kept_if_it_is_positive_and_within_the_guard_or_no_worse_than_before() {
    let corner =
        |height: f64| Corner { a: [1.0, 0.0], b: [0.5, height], ideal: Ideal::of_area(0.5) };
    let kept = |before: f64, now: f64, guard: f64| is_kept(&corner(before), &corner(now), guard);
    assert!(kept(0.1, 0.8, 2.0) && kept(0.1, 0.2, 2.0) && kept(0.8, 0.1, f64::INFINITY));
    assert!(!kept(0.8, 0.1, 2.0) && !kept(0.8, -0.8, f64::INFINITY));
    assert!(!kept(0.8, f64::NAN, 2.0) && !kept(0.8, 0.0, f64::INFINITY));
}

/// Maps the two edges of a square's corner to two edges of an equilateral triangle.
fn from_right_angle([a, b]: [f64; 2]) -> [f64; 2] {
    [a, 0.5 * a + 0.75f64.sqrt() * b]
}

/// Four quadrilaterals around a vertex. Each has three corners that depend on the vertex.
struct Quadrilaterals {
    /// The eight vertices around the visited vertex, counter-clockwise. Vertices with even indices are its neighbors.
    ring: [DVec2; 8],
}

impl Corners<f64> for Quadrilaterals {
    type Slopes = Given;

    fn count(&self) -> usize {
        12
    }

    fn corner(&self, i: usize, at: [f64; 2]) -> Corner<f64> {
        let vertex = |k: usize| self.ring[(2 * (i / 3) + k) % 8];
        let (first, across, last) = (vertex(0), vertex(1), vertex(2));
        let at = DVec2::from(at);
        right_corner([[at, first, last], [first, across, at], [last, at, across]][i % 3])
    }

    fn quadrilaterals(&self) -> usize {
        4
    }

    fn quadrilateral(&self, i: usize) -> (usize, Corner<f64>) {
        let [first, across, last] = [0, 1, 2].map(|k| self.ring[(2 * i + k) % 8]);
        (3 * i, right_corner([across, last, first]))
    }

    fn slopes(&self, i: usize) -> Given {
        let [alpha, beta] = from_right_angle([[-1.0, -1.0], [0.0, 1.0], [1.0, 0.0]][i % 3]);
        Given(alpha, beta)
    }

    fn weighted<V: Mul<f64, Output = V>>(&self, _: usize, term: V) -> V {
        term * 0.25
    }

    fn total_weight(&self) -> f64 {
        3.0
    }
}

/// Returns the corner of a quadrilateral at p, with edges to q and r, as metrics see it.
fn right_corner([p, q, r]: [DVec2; 3]) -> Corner<f64> {
    let [x, y] = [0, 1].map(|axis| from_right_angle([q[axis] - p[axis], r[axis] - p[axis]]));
    let ideal = Ideal { is_right: true, ..Ideal::of_area(0.5 * 0.75f64.sqrt()) };
    Corner { a: [x[0], y[0]], b: [x[1], y[1]], ideal }
}

fn quadrilaterals(shift: f64) -> Quadrilaterals {
    let corner = |k: usize| {
        let [x, y] = [[1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0], [-1, -1], [0, -1], [1, -1]][k];
        DVec2::new(f64::from(x), f64::from(y)) + shift * DVec2::new((k as f64).sin(), 0.3)
    };
    Quadrilaterals { ring: std::array::from_fn(corner) }
}

#[test]
fn derivatives_over_quadrilaterals_are_those_of_differences() {
    let (patch, at, h) = (&quadrilaterals(0.2), [0.1, -0.15], 1e-5);
    for &metric in Metric::ALL {
        let (formulas, smoothing, shape_guard) =
            (metric.formulas(), Smoothing::of(2), f64::INFINITY);
        let objective = MetricObjective { patch, formulas, smoothing, shape_guard };
        let value =
            |x: f64, y: f64| objective.trial([at[0] + x * h, at[1] + y * h], f64::INFINITY).0;
        let Dual { value: here, gradient, hessian } = objective.expansion(at);
        assert!((here - value(0.0, 0.0)).abs() < 1e-13 * here.abs().max(1.0), "{metric}");
        let (right, left) = (value(1.0, 0.0), value(-1.0, 0.0));
        let (up, down) = (value(0.0, 1.0), value(0.0, -1.0));
        let cross = value(1.0, 1.0) - value(1.0, -1.0) - value(-1.0, 1.0) + value(-1.0, -1.0);
        // Differences round by the size of the value, which the penalties on angles raise.
        let scale = match metric {
            Metric::Acute | Metric::AcuteSize => {
                hessian.iter().fold(here.abs().max(1.0), |most: f64, x| most.max(x.abs()))
            }
            _ => 1.0,
        };
        let expected = [right - left, up - down].map(|difference| difference / (2.0 * h));
        for (found, expected) in gradient.into_iter().zip(expected) {
            assert!((found - expected).abs() < 1e-7 * scale, "{metric}: {found} for {expected}");
        }
        let expected = [right - 2.0 * here + left, 0.25 * cross, up - 2.0 * here + down];
        for (found, expected) in hessian.into_iter().zip(expected) {
            let expected = expected / (h * h);
            assert!((found - expected).abs() < 1e-4 * scale, "{metric}: {found} for {expected}");
        }
    }
}

#[test]
fn newton_steps_take_a_vertex_to_the_middle_of_four_squares() {
    let patch = &quadrilaterals(0.0);
    for &metric in Metric::ALL {
        let (formulas, smoothing, shape_guard) =
            (metric.formulas(), Smoothing::of(3), f64::INFINITY);
        let objective = MetricObjective { patch, formulas, smoothing, shape_guard };
        let mut at = [0.3, -0.2];
        for _ in 0..30 {
            at = newton_step(&objective, at, true, &rule(metric, 1.0)).0;
        }
        assert!(DVec2::from(at).length() < 1e-3, "{metric}: {at:?}");
    }
}

/// An objective without acceptable trials. It records the length of every trial.
struct Failing {
    is_feasible: bool,
    lengths: RefCell<Vec<f64>>,
}

impl Objective<f64> for Failing {
    fn expansion(&self, _: [f64; 2]) -> Dual {
        Dual { value: 1.0, gradient: [-1.0, 0.0], hessian: [1.0, 0.0, 1.0] }
    }

    fn direction(&self, here: &Dual, _: f64) -> Direction<f64> {
        let [slope, _] = here.gradient;
        Direction { vector: [1.0, 0.0], slope, descends: true }
    }

    fn trial(&self, [x, _]: [f64; 2], _: f64) -> (f64, bool) {
        self.lengths.borrow_mut().push(x);
        (2.0, self.is_feasible)
    }
}

#[test]
fn each_rule_tries_the_lengths_that_it_states_and_then_leaves_the_vertex() {
    for (rule, trials, infeasible) in [
        (SearchRule::SWEEP, 8, 0.25),
        (SearchRule::CURVE, 8, 0.25),
        (SearchRule::WORST, 8, 0.5),
        (SearchRule::UNTANGLE, 10, 0.25),
    ] {
        for (is_feasible, factor) in [(true, 0.5), (false, infeasible)] {
            let objective = Failing { is_feasible, lengths: RefCell::default() };
            let end = newton_step(&objective, [0.0, 0.0], true, &rule);
            assert_eq!(end, ([0.0, 0.0], false));
            let expected: Vec<f64> = (0..trials).map(|trial| f64::powi(factor, trial)).collect();
            assert_eq!(objective.lengths.into_inner(), expected, "{rule:?}");
        }
    }
}

#[test]
fn a_rule_without_a_sufficient_decrease_accepts_any_feasible_trial() {
    let rule = SearchRule { sufficient_decrease: None, ..SearchRule::SWEEP };
    let objective = Failing { is_feasible: true, lengths: RefCell::default() };
    assert_eq!(newton_step(&objective, [0.0, 0.0], true, &rule), ([1.0, 0.0], true));
    assert_eq!(newton_step(&objective, [0.0, 0.0], false, &rule), ([0.0, 0.0], false));
}
