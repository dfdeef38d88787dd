//! Tests of the numbers of a Newton step: products against differences, symmetry, semidefiniteness, bits by threads.

use glam::DVec2;

use super::Truncated;
use super::blocks::Blocks;
use super::solve::Solver;
use crate::layout::Problem;
use crate::metric::Metric;
use crate::options::Options;
use crate::parallel::pace::{now, polled};
use crate::run::Plan;
use crate::run::truncated::fixtures::{hub, lattice, problem, with_targets};
use crate::run::truncated::{NewtonStep, StepRequest};
use crate::slide::{Movers, Tangents};

/// Returns vectors at the vertices that are no smooth function.
fn noise<const N: usize>(count: usize, seed: f64) -> Vec<[f64; N]> {
    let at = |k: usize| std::array::from_fn(|i| ((k * N + i) as f64 * seed).sin());
    (0..count).map(at).collect()
}

fn dot(a: &[[f64; 2]], b: &[[f64; 2]]) -> f64 {
    a.as_flattened().iter().zip(b.as_flattened()).map(|(a, b)| a * b).sum()
}

fn linearized(metric: Metric, problem: &Problem, positions: &[DVec2]) -> Solver<f64> {
    let mut solver = now(Solver::new(problem, None));
    now(solver.linearize(metric, problem, positions, &Tangents::default()));
    solver
}

fn problems() -> Vec<Problem> {
    let mesh = lattice(61, 1.0);
    vec![problem(&mesh), with_targets(&mesh), problem(&lattice(15, 30.0)), problem(&hub(60))]
}

#[test]
fn the_product_is_the_difference_of_gradients() {
    for problem in problems() {
        let positions = problem.positions();
        for metric in [Metric::Imr, Metric::ShapeSize, Metric::Tmop94, Metric::Rms] {
            let mut solver = linearized(metric, &problem, positions);
            let p = noise::<2>(problem.free_count(), 0.7);
            let product = now(solver.product_with(&p));
            let moved = |by: f64| {
                let mut moved = positions.to_vec();
                for (p, &v) in p.iter().zip(&solver.blocks().order) {
                    moved[v as usize] += DVec2::from(*p) * by;
                }
                linearized(metric, &problem, &moved).residual().to_vec()
            };
            let short = 1e-6;
            let (ahead, behind) = (moved(short), moved(-short));
            let pairs = ahead.as_flattened().iter().zip(behind.as_flattened());
            let differences: Vec<f64> = pairs.map(|(a, b)| (b - a) / (2.0 * short)).collect();
            let scale = product.as_flattened().iter().fold(1.0f64, |most, x| most.max(x.abs()));
            for (product, difference) in product.as_flattened().iter().zip(differences) {
                assert!(
                    (product - difference).abs() < 1e-5 * scale,
                    "{metric}: {product} {difference}"
                );
            }
        }
    }
}

#[test]
fn the_preconditioner_is_symmetric_and_positive() {
    for problem in problems() {
        let mut solver = linearized(Metric::Imr, &problem, problem.positions());
        for seed in [0.37, 1.1, 2.9] {
            let [a, b] = [seed, seed + 0.2].map(|seed| noise::<2>(problem.free_count(), seed));
            let [of_a, of_b] = [&a, &b].map(|v| now(solver.preconditioned_of(v)));
            let (across, back) = (dot(&a, &of_b), dot(&b, &of_a));
            let (own_a, own_b) = (dot(&a, &of_a), dot(&b, &of_b));
            assert!(own_a > 0.0 && own_b > 0.0);
            assert!((across - back).abs() < 1e-9 * (own_a * own_b).sqrt(), "{across} {back}");
        }
    }
}

/// The blocks have every vertex and every triangle with a free corner once, and every vertex of another block is received.
#[test]
fn blocks_divide_vertices_and_triangles() {
    let problem = problem(&lattice(71, 1.0));
    let blocks = now(Blocks::new(&problem, &Movers::new(&problem, None))).0;
    assert!(blocks.blocks.len() > 1);
    let mut vertices = blocks.order.clone();
    vertices.sort_unstable();
    assert!(vertices.into_iter().eq(0..problem.free_count() as u32));
    let of_block = |block: &super::blocks::Block| block.corners.len();
    let movable = problem.triangles().iter().filter(|t| problem.can_move(t)).count();
    assert_eq!(blocks.blocks.iter().map(of_block).sum::<usize>(), movable);
    let received: usize = blocks.blocks.iter().map(|block| block.received.len()).sum();
    assert_eq!(received, blocks.blocks.iter().map(|block| block.others.len()).sum::<usize>());
}

fn request() -> StepRequest {
    StepRequest {
        objective: 1.0,
        forcing: 1e-3,
        least_gain: 1e-10,
        least_ritz: 1.0,
        is_exact: true,
    }
}

/// Returns the last step of a run of Newton steps alone, and the positions after it.
fn stepped(problem: &Problem, metric: Metric, steps: usize) -> (NewtonStep, Vec<DVec2>) {
    let plan = Plan::new(&Options { scheme: metric.into(), ..Options::default() });
    let mut positions = problem.positions().to_vec();
    let mut truncated = now(Truncated::new(problem, None));
    let sweep = plan.base_step(1.0);
    let mut step =
        || now(truncated.step(&sweep, problem, &mut positions, None, &request(), &mut || true));
    let last = (0..steps).map(|_| step()).last().unwrap();
    (last, positions)
}

#[test]
fn newton_steps_reach_a_minimum() {
    for problem in problems() {
        let (step, _) = stepped(&problem, Metric::Imr, 30);
        assert!(step.length == 1.0 || step.model_gain < 1e-12, "{step:?}");
        assert!(!step.is_curved_down && step.model_gain < 1e-9 * (1.0 + step.swept), "{step:?}");
    }
}

#[test]
fn a_step_has_equal_bits_on_any_number_of_threads_and_with_pauses() {
    let problem = with_targets(&lattice(71, 1.0));
    let step = || stepped(&problem, Metric::Imr, 2).1;
    let bits = |positions: &[DVec2]| -> Vec<u64> {
        positions.iter().flat_map(|p| p.to_array().map(f64::to_bits)).collect()
    };
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap().install(step);
    let many = rayon::ThreadPoolBuilder::new().num_threads(5).build().unwrap().install(step);
    assert_eq!(bits(&alone), bits(&many));
    let awaited = async {
        let plan = Plan::new(&Options::default());
        let mut positions = problem.positions().to_vec();
        let mut truncated = Truncated::new(&problem, None).await;
        for _ in 0..2 {
            let sweep = plan.base_step(1.0);
            truncated.step(&sweep, &problem, &mut positions, None, &request(), &mut || true).await;
        }
        positions
    };
    let (paused, polls) = polled(std::time::Duration::ZERO, awaited);
    assert!(polls > 100, "{polls}");
    assert_eq!(bits(&alone), bits(&paused));
}
