//! Newton steps on a device against those of the CPU engine.

use std::sync::Arc;

use glam::DVec2;

use crate::cpu::CpuEngine;
use crate::gpu::Gpu;
use crate::gpu::device::pending::Waiting;
use crate::gpu::run::GpuEngine;
use crate::layout::Problem;
use crate::mesh::Mesh;
use crate::metric::Metric;
use crate::options::Options;
use crate::parallel::pace::now;
use crate::run::corrections::Corrections;
use crate::run::truncated::fixtures::{hub, lattice, problem, quadrilaterals, with_targets};
use crate::run::truncated::{ErrorBound, NewtonStep, StepRequest};
use crate::run::{Ending, Engine, GoesOn, Plan, SweepParams, Work};
use crate::slide::{OnCurves, Periodic, Slide, Sliding};
use crate::topology::Topology;

const REQUEST: StepRequest = StepRequest {
    objective: 1.0,
    forcing: 1e-3,
    least_gain: 1e-12,
    least_ritz: 0.1,
    is_exact: true,
};

/// The two engines of one run, at equal positions.
struct Engines<'a> {
    cpu: CpuEngine,
    device: GpuEngine<'a>,
    sweep: SweepParams,
}

impl<'a> Engines<'a> {
    /// Makes the engines of a run by a metric, after `sweeps` sweeps.
    fn new(gpu: &'a Gpu, problem: &Problem, metric: Metric, sweeps: u32) -> Self {
        Self::on_curves(gpu, problem, None, metric, sweeps)
    }

    /// Makes the engines of a run whose vertices slide, if curves are given.
    fn on_curves(
        gpu: &'a Gpu,
        problem: &Problem,
        curves: Option<OnCurves>,
        metric: Metric,
        sweeps: u32,
    ) -> Self {
        let plan = Plan::new(&Options { scheme: metric.into(), ..Options::default() });
        let (steps, start) = (Corrections::steps(&plan), problem.positions().to_vec());
        let sweep = steps[1];
        let work = Work { steps, ending: Ending::Steps, is_measured: true };
        let mut cpu = CpuEngine::new(problem, start.clone(), curves, &plan);
        for _ in 0..sweeps {
            now(cpu.sweep(&sweep)).unwrap();
        }
        let swept = now(cpu.positions()).unwrap().into_owned();
        let curves = now(cpu.best_curves()).unwrap();
        let of_device = curves.as_ref();
        let device = GpuEngine::new(gpu, problem, &swept, of_device, plan, work, Waiting::Block);
        Self { cpu, device: now(device).unwrap(), sweep }
    }

    /// Sweeps and takes a step on both engines. Returns the steps and the positions of the CPU, then of the device.
    fn step(&mut self, request: &StepRequest) -> [(NewtonStep, Vec<DVec2>); 2] {
        self.step_while(request, &mut || true)
    }

    /// Sweeps and takes a step as [`step`](Self::step) does, while the run goes on.
    fn step_while(
        &mut self,
        request: &StepRequest,
        goes_on: &mut GoesOn<'_>,
    ) -> [(NewtonStep, Vec<DVec2>); 2] {
        let Self { cpu, device, sweep } = self;
        let step = now(cpu.sweep_and_step(sweep, request, goes_on)).unwrap().unwrap();
        let of_cpu = (step, now(cpu.positions()).unwrap().into_owned());
        let step = now(device.sweep_and_step(sweep, request, goes_on)).unwrap().unwrap();
        [of_cpu, (step, now(device.positions()).unwrap().into_owned())]
    }
}

/// Compares a step after some sweeps.
fn compare(gpu: &Gpu, problem: &Problem, metric: Metric) {
    compare_at(Engines::new(gpu, problem, metric, 8), problem, metric, [1e-5, 3e-3]);
}

/// Compares a step. The tolerances are those of f after the sweep and of the model's gain.
fn compare_at(mut engines: Engines<'_>, problem: &Problem, metric: Metric, by: [f64; 2]) {
    let [(cpu, of_cpu), (device, of_device)] = engines.step(&REQUEST);
    let all = format!("{metric:?}\n{cpu:?}\n{device:?}");
    let near = |a: f64, b: f64, by: f64| (a - b).abs() <= by * a.abs().max(b.abs());
    assert!(near(cpu.swept, device.swept, by[0]), "{all}");
    assert!(cpu.is_curved_down == device.is_curved_down, "{all}");
    if cpu.is_curved_down {
        // The iteration that meets negative curvature depends on rounding.
        assert!(device.excess < device.swept, "{all}");
        return;
    }
    assert!(near(cpu.model_gain, device.model_gain, by[1]), "{all}");
    assert!((cpu.length, cpu.is_broken) == (device.length, device.is_broken), "{all}");
    assert!((cpu.held, cpu.is_exact) == (device.held, device.is_exact), "{all}");
    assert!(near(cpu.excess, device.excess, 1e-4_f64.max(by[0])), "{all}");
    let apart = |a: &[DVec2], b: &[DVec2]| {
        let squares: f64 = a.iter().zip(b).map(|(a, b)| a.distance_squared(*b)).sum();
        squares.sqrt()
    };
    let (off, way) = (apart(&of_cpu, &of_device), apart(problem.positions(), &of_cpu));
    assert!(off <= 1e-2 * way, "{all}\n{off} of {way}");
}

#[test]
fn steps_of_the_device_are_those_of_the_cpu() {
    let gpu = Gpu::open(None).block().unwrap();
    let lattice_of_21 = problem(&lattice(21, 1.0));
    for metric in Metric::ALL.iter().filter(|metric| metric.curved().is_some()) {
        compare(&gpu, &lattice_of_21, *metric);
    }
    // Levels that are solved directly at once, several levels, and a vertex whose aggregate leaves out its neighbors.
    for mesh in [lattice(4, 1.0), lattice(61, 1.0), hub(40)] {
        compare(&gpu, &problem(&mesh), Metric::Imr);
    }
    compare(&gpu, &with_targets(&lattice(21, 1.0)), Metric::Imr);
    compare(&gpu, &with_targets(&lattice(21, 1.0)), Metric::Tmop94);
}

#[test]
fn steps_of_the_device_on_quadrilaterals_are_those_of_the_cpu() {
    let gpu = Gpu::open(None).block().unwrap();
    let squares = quadrilaterals(21, |_| true);
    let mixed = quadrilaterals(21, |cell| cell * cell % 3 != 0);
    // AREA does not change if all squares become equal parallelograms, so a step has no definite end.
    let is_definite = |metric: &&Metric| metric.curved().is_some() && **metric != Metric::Area;
    for mesh in [&squares, &mixed] {
        for metric in Metric::ALL.iter().filter(is_definite) {
            compare(&gpu, &problem(mesh), *metric);
        }
        compare(&gpu, &with_targets(mesh), Metric::Imr);
    }
}

/// Returns a mesh as a problem, with its vertices on curves.
fn on_curves(mesh: &Mesh, slide: &Slide, problem: &Problem) -> OnCurves {
    let topology = Topology::new(mesh).unwrap();
    let sliding = Sliding::new(&mesh.points, &topology, slide);
    let curves = OnCurves::new(Arc::new(sliding.numbered(problem, mesh.points.len())), None, 0.0);
    assert!(curves.fans().count() > 20);
    curves
}

/// Vertices slide around a circle, on straight sides with corners between them, and in pairs on opposite sides.
#[test]
fn steps_of_the_device_slide_vertices_as_the_cpu_does() {
    let gpu = Gpu::open(None).block().unwrap();
    let moved = |mut mesh: Mesh| {
        for (k, point) in (0_u32..).zip(&mut mesh.points) {
            let off = 0.2 * (f64::from(k / 21 + k % 21) * 1.3).sin();
            let is_inside = |k: u32| k > 0 && k < 20;
            for (axis, place, other) in [(0, k % 21, k / 21), (1, k / 21, k % 21)] {
                point[axis] += if is_inside(place) && !is_inside(other) { off } else { 0.0 };
            }
        }
        mesh
    };
    let sides = moved(lattice(21, 1.0));
    let squares = moved(quadrilaterals(21, |_| true));
    let mixed = moved(quadrilaterals(21, |cell| cell * cell % 3 != 0));
    let pairs = (1..20).map(|k| [21 * k, 21 * k + 20]).collect();
    let periodic = vec![Periodic { pairs, motion: None }];
    let targets = with_targets(&sides);
    let free = Slide::default();
    for (mesh, problem, slide, metrics) in [
        (&hub(40), problem(&hub(40)), &free, [Metric::Imr, Metric::Ar]),
        (&sides, problem(&sides), &free, [Metric::Imr, Metric::Rms]),
        (&sides, problem(&sides), &Slide { periodic, ..Slide::default() }, [Metric::Imr; 2]),
        (&sides, targets, &free, [Metric::Imr, Metric::Tmop94]),
        (&squares, problem(&squares), &free, [Metric::Imr, Metric::Rms]),
        (&mixed, problem(&mixed), &free, [Metric::Imr, Metric::Tmop94]),
    ] {
        for metric in metrics {
            let curves = Some(on_curves(mesh, slide, &problem));
            let engines = Engines::on_curves(&gpu, &problem, curves, metric, 60);
            // The engines visit sliding vertices in different orders.
            compare_at(engines, &problem, metric, [1e-3, 0.1]);
        }
    }
}

/// A submission holds a few iterations and two trials. Steps that need more go on in further submissions.
#[test]
fn long_steps_take_several_submissions() {
    let gpu = Gpu::open(None).block().unwrap();
    let problem = problem(&hub(40));
    let mut engines = Engines::new(&gpu, &problem, Metric::Imr, 0);
    let request = StepRequest { forcing: 1e-6, least_ritz: 1e-3, ..REQUEST };
    let [(cpu, _), (device, _)] = engines.step(&request);
    assert!(device.iterations > super::FIRST_ITERATIONS, "{device:?}");
    assert!((cpu.length - device.length).abs() <= 0.05 * cpu.length, "{cpu:?}\n{device:?}");
    assert!((cpu.excess - device.excess).abs() <= 1e-2 * cpu.excess, "{cpu:?}\n{device:?}");
}

/// An engine stops in the middle of the iterations if `goes_on` returns false. The sweep before the step counts.
#[test]
fn a_step_that_is_given_up_leaves_the_vertices_where_the_sweep_has_moved_them() {
    let gpu = Gpu::open(None).block().unwrap();
    let mesh = hub(40);
    let problem = problem(&mesh);
    let request = StepRequest { forcing: 1e-6, least_ritz: 1e-3, ..REQUEST };
    let curves = || on_curves(&mesh, &Slide::default(), &problem);
    for (curves, sweeps) in [(None, 0), (Some(curves()), 60)] {
        let engines = || Engines::on_curves(&gpu, &problem, curves.clone(), Metric::Imr, sweeps);
        let mut swept = engines();
        now(swept.cpu.sweep(&swept.sweep)).unwrap();
        let of_sweep = now(swept.cpu.positions()).unwrap().into_owned();
        let mut questions = 0;
        let mut goes_on = || {
            questions += 1;
            false
        };
        let mut given_up = engines();
        let steps = given_up.step_while(&request, &mut goes_on);
        for (step, positions) in steps {
            assert_eq!((step.length, step.model_gain), (0.0, 0.0), "{step:?}");
            assert!(step.excess == step.swept && step.bound.is_infinite(), "{step:?}");
            let far = positions.iter().zip(&of_sweep).map(|(a, b)| a.distance(*b));
            assert!(far.fold(0.0, f64::max) < 1e-5);
        }
        // Neither engine finishes a measurement.
        let Engines { cpu, device, sweep } = &mut given_up;
        assert_eq!(now(cpu.remaining(sweep, &request, &mut goes_on)).unwrap(), None);
        assert_eq!(now(device.remaining(sweep, &request, &mut goes_on)).unwrap(), None);
        assert_eq!(questions, 4);
    }
}

/// The device judges conjugate gradients by the bound of the CPU engine: both follow from the coefficients of the iterations.
#[test]
fn the_bound_is_that_of_the_coefficients() {
    let gpu = Gpu::open(None).block().unwrap();
    let problem = problem(&lattice(21, 1.0));
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
