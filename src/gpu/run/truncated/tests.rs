//! Newton steps on a device against those of the CPU engine.

use glam::DVec2;

use crate::cpu::CpuEngine;
use crate::gpu::Gpu;
use crate::gpu::device::readback::Waiting;
use crate::gpu::run::GpuEngine;
use crate::layout::{Problem, prepare};
use crate::mesh::Mesh;
use crate::metric::Metric;
use crate::options::Options;
use crate::parallel::pace::now;
use crate::run::truncated::{ErrorBound, NewtonStep, StepRequest};
use crate::run::{Corrections, Engine, Plan, SweepParams};
use crate::targets::Targets;

const REQUEST: StepRequest = StepRequest {
    objective: 1.0,
    forcing: 1e-3,
    least_gain: 1e-12,
    least_ritz: 0.1,
    is_exact: true,
};

/// A displaced lattice of right triangles with `side` vertices on a side.
fn lattice(side: u32) -> Mesh {
    let shift = |k: u32, by: f64| 0.2 * (f64::from(k) * by).sin();
    let is_inside = |k: u32| k > 0 && k + 1 < side;
    let point = |k: u32| {
        let (column, row) = (k % side, k / side);
        let by = if is_inside(column) && is_inside(row) { 1.0 } else { 0.0 };
        [f64::from(column) + by * shift(k, 1.7), f64::from(row) + by * shift(k, 2.9)]
    };
    let cells = (0..side * (side - 1)).filter(|k| k % side + 1 < side);
    let triangles = cells.flat_map(|k| [[k, k + 1, k + side + 1], [k, k + side + 1, k + side]]);
    Mesh {
        points: (0..side * side).map(point).collect(),
        triangles: triangles.collect(),
        fixed: Vec::new(),
    }
}

/// A hub of `around` neighbors, with rings around it.
fn hub(around: u32) -> Mesh {
    let mut points = vec![[0.1, 0.05]];
    for ring in 1..5u32 {
        points.extend((0..around).map(|k| {
            let part = f64::from(k) + 0.2 * f64::from(ring);
            let turn = std::f64::consts::TAU * part / f64::from(around);
            [f64::from(ring) * turn.cos(), f64::from(ring) * turn.sin()]
        }));
    }
    let at = |ring: u32, k: u32| 1 + ring * around + k % around;
    let mut triangles: Vec<[u32; 3]> = (0..around).map(|k| [0, at(0, k), at(0, k + 1)]).collect();
    for (ring, k) in (0..3).flat_map(|ring| (0..around).map(move |k| (ring, k))) {
        triangles.push([at(ring, k), at(ring + 1, k), at(ring + 1, k + 1)]);
        triangles.push([at(ring, k), at(ring + 1, k + 1), at(ring, k + 1)]);
    }
    Mesh { points, triangles, fixed: Vec::new() }
}

fn problem(mesh: &Mesh) -> Problem {
    prepare(mesh).unwrap().1
}

/// Targets that turn and stretch from place to place.
fn with_targets(mesh: &Mesh) -> Problem {
    let mut problem = problem(mesh);
    let tensor = |p: &[f64; 2]| {
        let (sin, cos) = (0.1 * p[0] + 0.05 * p[1]).sin_cos();
        [1.0 + 2.0 * cos * cos, 2.0 * sin * cos, 1.0 + 2.0 * sin * sin]
    };
    let tensors: Vec<[f64; 3]> = mesh.points.iter().map(tensor).collect();
    problem.set_targets(&Targets::tensors(&tensors).unwrap());
    problem
}

/// The two engines of one run, at equal positions.
struct Engines<'a> {
    cpu: CpuEngine,
    device: GpuEngine<'a>,
    sweep: SweepParams,
}

impl<'a> Engines<'a> {
    /// Makes the engines of a run by a metric, after `sweeps` sweeps.
    fn new(gpu: &'a Gpu, problem: &Problem, metric: Metric, sweeps: u32) -> Self {
        let plan = Plan::new(&Options { scheme: metric.into(), ..Options::default() });
        let (steps, start) = (Corrections::steps(&plan), problem.positions().to_vec());
        let sweep = steps[1];
        let mut cpu = CpuEngine::new(problem, start.clone(), None, &plan);
        for _ in 0..sweeps {
            now(cpu.sweep(&sweep)).unwrap();
        }
        let swept = now(cpu.positions()).unwrap().into_owned();
        let device = GpuEngine::new(gpu, problem, &swept, None, plan, steps, Waiting::Block);
        Self { cpu, device: now(device).unwrap(), sweep }
    }

    /// Sweeps and takes a step on both engines. Returns the steps and the positions of the CPU, then of the device.
    fn step(&mut self, request: &StepRequest) -> [(NewtonStep, Vec<DVec2>); 2] {
        let Self { cpu, device, sweep } = self;
        let step = now(cpu.sweep_and_step(sweep, request)).unwrap().unwrap();
        let of_cpu = (step, now(cpu.positions()).unwrap().into_owned());
        let step = now(device.sweep_and_step(sweep, request)).unwrap().unwrap();
        [of_cpu, (step, now(device.positions()).unwrap().into_owned())]
    }
}

/// Compares a step after some sweeps.
fn compare(gpu: &Gpu, problem: &Problem, metric: Metric) {
    let mut engines = Engines::new(gpu, problem, metric, 8);
    let [(cpu, of_cpu), (device, of_device)] = engines.step(&REQUEST);
    let all = format!("{metric:?}\n{cpu:?}\n{device:?}");
    let near = |a: f64, b: f64, by: f64| (a - b).abs() <= by * a.abs().max(b.abs());
    assert!(near(cpu.swept, device.swept, 1e-5), "{all}");
    assert!(cpu.is_curved_down == device.is_curved_down, "{all}");
    if cpu.is_curved_down {
        // The iteration that meets negative curvature depends on rounding.
        assert!(device.excess < device.swept, "{all}");
        return;
    }
    assert!(near(cpu.model_gain, device.model_gain, 3e-3), "{all}");
    assert!((cpu.length, cpu.is_broken) == (device.length, device.is_broken), "{all}");
    assert!(near(cpu.excess, device.excess, 1e-4), "{all}");
    let apart = |a: &[DVec2], b: &[DVec2]| {
        let squares: f64 = a.iter().zip(b).map(|(a, b)| a.distance_squared(*b)).sum();
        squares.sqrt()
    };
    let (off, way) = (apart(&of_cpu, &of_device), apart(problem.positions(), &of_cpu));
    assert!(off <= 1e-2 * way, "{all}\n{off} of {way}");
}

#[test]
fn steps_of_the_device_are_those_of_the_cpu() {
    let gpu = Gpu::open(None).unwrap();
    let lattice_of_21 = problem(&lattice(21));
    for metric in Metric::ALL.iter().filter(|metric| metric.curved().is_some()) {
        compare(&gpu, &lattice_of_21, *metric);
    }
    // Levels that are solved directly at once, several levels, and a vertex whose aggregate leaves out its neighbors.
    for mesh in [lattice(4), lattice(61), hub(40)] {
        compare(&gpu, &problem(&mesh), Metric::Imr);
    }
    compare(&gpu, &with_targets(&lattice(21)), Metric::Imr);
    compare(&gpu, &with_targets(&lattice(21)), Metric::Tmop94);
}

/// A submission holds a few iterations and two trials. Steps that need more go on in further submissions.
#[test]
fn long_steps_take_several_submissions() {
    let gpu = Gpu::open(None).unwrap();
    let problem = problem(&hub(40));
    let mut engines = Engines::new(&gpu, &problem, Metric::Imr, 0);
    let request = StepRequest { forcing: 1e-6, least_ritz: 1e-3, ..REQUEST };
    let [(cpu, _), (device, _)] = engines.step(&request);
    assert!(device.iterations > super::FIRST_ITERATIONS, "{device:?}");
    assert!((cpu.length - device.length).abs() <= 0.05 * cpu.length, "{cpu:?}\n{device:?}");
    assert!((cpu.excess - device.excess).abs() <= 1e-2 * cpu.excess, "{cpu:?}\n{device:?}");
}

/// The device judges conjugate gradients by the bound of the CPU engine: both follow from the coefficients of the iterations.
#[test]
fn the_bound_is_that_of_the_coefficients() {
    let gpu = Gpu::open(None).unwrap();
    let problem = problem(&lattice(21));
    for least_ritz in [0.1, 0.9] {
        let mut engines = Engines::new(&gpu, &problem, Metric::Imr, 3);
        let request = StepRequest { least_ritz, least_gain: 1e-6, ..REQUEST };
        let [_, (step, _)] = engines.step(&request);
        let truncated = engines.device.truncated().unwrap();
        let count = step.iterations as usize;
        assert!(count > 4 && step.bound > 0.0, "{step:?}");
        let (state, coefficients) = now(truncated.solved(&gpu, count)).unwrap();
        // ρ of each iteration, from that of the last.
        let mut rhos = vec![f64::from(state.rho)];
        for [_, beta] in coefficients[1..].iter().rev() {
            rhos.push(rhos[rhos.len() - 1] / f64::from(*beta));
        }
        let mut bound = ErrorBound::new(least_ritz);
        let (mut gain, mut left) = (0.0, 0.0);
        let least_gain = f64::from(state.least_gain);
        for ([alpha, beta], rho) in coefficients.into_iter().zip(rhos.into_iter().rev()) {
            gain += 0.5 * f64::from(alpha) * rho;
            left = bound.add(alpha.into(), beta.into(), rho);
            let accuracy = request.accuracy(gain, least_gain, false);
            if accuracy <= least_gain && left <= accuracy {
                left = bound.refined(rho);
            }
        }
        assert!((f64::from(state.bound) / left - 1.0).abs() < 1e-2, "{left} {state:?}");
        assert!((bound.least_ritz() / step.least_ritz - 1.0).abs() < 1e-4, "{step:?}");
    }
}
