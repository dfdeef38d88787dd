//! Sweeps and runs on both engines: convergence, invariance and safety.

mod acute;
mod adapted;
mod agreement;
mod altitude;
mod bounded;
mod coincident;
mod coloring;
mod counts;
mod fields;
mod flat;
mod floor;
mod global;
mod goals;
mod guard;
mod hard;
mod hubs;
mod invariance;
mod layers;
mod limit;
mod multilevel;
mod not_finite;
mod optimum;
mod periodic;
mod random;
mod requests;
mod resumed;
mod safety;
mod slide;
mod sphere;
mod still;
mod stretched;
mod stuck;
mod targets;
mod tolerance;
mod untangle;
mod worst;

use gpu_smooth::{
    Backend, Gpu, Mesh, Metric, Options, Outcome, Scheme, Smoother, Topology,
    internal::{Coloring, Plan, Problem, Stepwise, StopRule, run_on_cpu, run_on_gpu},
    layers::Layers,
    options::{Derivatives, PNormExponent},
};
use std::borrow::Cow;
use std::sync::OnceLock;

/// Prepares a mesh whose boundary layers may move.
fn with_free_layers(mesh: &Mesh) -> Smoother<'_> {
    Smoother::keeping(Cow::Borrowed(mesh), Layers::default()).unwrap()
}

/// The alternating schemes of the paper.
const SCHEMES: [&str; 8] = [
    "edge+imr",
    "area+imr",
    "rms+imr",
    "edge+ar",
    "area+ar",
    "rms+ar",
    "edge+imr+imr",
    "edge+imr+imr+imr",
];

fn scheme(name: &str) -> Scheme {
    name.parse().unwrap()
}

/// Returns all metrics as schemes, and the schemes of the paper.
fn all_schemes() -> Vec<Scheme> {
    let alone = Metric::ALL.iter().map(|&metric| metric.into());
    alone.chain(SCHEMES.map(scheme)).collect()
}

/// Returns whether a metric has penalties on angles. They bend within a hundredth of an edge, and amplify rounding.
fn is_of_angles(metric: Metric) -> bool {
    matches!(metric, Metric::Acute | Metric::AcuteSize)
}

/// Returns the CPU and the GPU backend. Panics without an adapter, because tests would then not cover the GPU.
fn backends() -> &'static [Backend; 2] {
    static BACKENDS: OnceLock<[Backend; 2]> = OnceLock::new();
    BACKENDS.get_or_init(|| {
        let gpu =
            Gpu::open(None).block().expect("these tests need a wgpu adapter, be it a software one");
        [Backend::Cpu, Backend::Gpu(gpu)]
    })
}

fn name(backend: &Backend) -> &'static str {
    match backend {
        Backend::Cpu => "CPU",
        Backend::Gpu(_) => "GPU",
    }
}

fn plate(vertices: usize) -> Mesh {
    let outline = support::Outline::parse(include_str!("../../meshes/plate.outline")).unwrap();
    support::triangulate(&outline, vertices).unwrap()
}

/// Returns a plate of two thousand vertices with a few nearly flat triangles.
fn perturbed() -> &'static Mesh {
    static MESH: OnceLock<Mesh> = OnceLock::new();
    MESH.get_or_init(|| support::perturb_random(&plate(2000), 1.0, 1))
}

/// Returns a plate of two thousand vertices displaced by long waves, which cost a local method the most
/// sweeps.
fn distorted() -> &'static Mesh {
    static MESH: OnceLock<Mesh> = OnceLock::new();
    MESH.get_or_init(|| support::distort_smooth(&plate(2000), 0.9))
}

fn run(smoother: &Smoother, options: &Options, backend: &Backend) -> Outcome {
    smoother.run(options).on(backend).block().unwrap()
}

fn with_points(mesh: &Mesh, points: &[[f64; 2]]) -> Mesh {
    Mesh { points: points.to_vec(), ..mesh.clone() }
}

/// Returns the history of f by `metric`, starting before the first sweep.
fn history(outcome: &Outcome, metric: Metric) -> Vec<f64> {
    outcome.history.iter().map(|objectives| objectives.of(metric).unwrap()).collect()
}

fn problem(mesh: &Mesh) -> Problem {
    let topology = Topology::new(mesh).unwrap();
    Problem::new(mesh, &topology, &Coloring::new(&topology))
}

/// Returns a plan of `sweeps` sweeps without another stop rule.
fn plan(scheme: Scheme, sweeps: u32) -> Plan {
    Plan {
        scheme,
        omega: Metric::ALL
            .iter()
            .map(|m| m.properties().omega)
            .collect::<Vec<_>>()
            .try_into()
            .unwrap(),
        unrelaxed_sweeps: 4,
        newton_steps: 1,
        derivatives: [Derivatives::Analytic; Metric::ALL.len()],
        sharpness: PNormExponent::FIXED,
        stop: StopRule { goal: None, tolerance: 0.0, max_sweeps: sweeps },
        track_all: false,
        worst_guard: f64::INFINITY,
        max_lengthening: 1.0,
        shape_guard: f64::INFINITY,
        is_guard_penalized: false,
    }
}

fn engine<'a>(backend: &'a Backend, problem: &'a Problem, plan: Plan) -> Box<dyn Stepwise + 'a> {
    let start = problem.positions();
    match backend {
        Backend::Cpu => Box::new(run_on_cpu(problem, start, plan)),
        Backend::Gpu(gpu) => Box::new(run_on_gpu(gpu, problem, start, plan).unwrap()),
    }
}
