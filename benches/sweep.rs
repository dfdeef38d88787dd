//! Vertex visits and objective evaluations per second, by metric, engine and mesh size.
//!
//! ```text
//! cargo bench --bench sweep -- imr/cpu          # RAYON_NUM_THREADS=1 for one core
//! ```
//!
//! Without an adapter, the GPU has no rows.

mod mesh;

use divan::Bencher;
use divan::counter::ItemsCount;
use gpu_smooth::{
    Gpu, Metric, Options, Stopping,
    internal::{Plan, Problem, Stepwise, prepare, run_on_cpu, run_on_gpu},
};
use std::fmt;
use std::sync::OnceLock;

fn main() {
    divan::main();
}

/// Cells along a side of the lattices, for ten thousand, 57 thousand and a million vertices.
const SIDES: [usize; 3] = [99, 238, 999];

fn problem(size: usize) -> &'static Problem {
    static PROBLEMS: [OnceLock<Problem>; SIDES.len()] = [const { OnceLock::new() }; SIDES.len()];
    PROBLEMS[size].get_or_init(|| {
        let mesh = mesh::mixed(SIDES[size], 1);
        prepare(&mesh).unwrap().1
    })
}

fn gpu() -> Option<&'static Gpu> {
    static GPU: OnceLock<Option<Gpu>> = OnceLock::new();
    GPU.get_or_init(|| Gpu::open(None).block().ok()).as_ref()
}

struct Case {
    metric: Metric,
    on_gpu: bool,
    size: usize,
}

impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let engine = if self.on_gpu { "gpu" } else { "cpu" };
        let vertices = (SIDES[self.size] + 1).pow(2);
        write!(f, "{}/{engine}/{vertices}", self.metric)
    }
}

fn cases(engines: &[bool]) -> Vec<Case> {
    let sizes = 0..SIDES.len();
    let of = |&metric: &Metric| {
        let sizes = sizes.clone();
        let on = move |&on_gpu: &bool| sizes.clone().map(move |size| Case { metric, on_gpu, size });
        engines.iter().flat_map(on)
    };
    Metric::ALL.iter().flat_map(of).collect()
}

impl Case {
    fn engine(&self) -> Option<Box<dyn Stepwise>> {
        let problem = problem(self.size);
        let options = Options::default()
            .scheme(self.metric.into())
            .stopping(Stopping::Tolerance(0.0))
            .max_sweeps(u32::MAX);
        let plan = Plan::new(&options);
        if self.on_gpu {
            let engine = run_on_gpu(gpu()?, problem, problem.positions(), plan);
            Some(Box::new(engine.unwrap()))
        } else {
            Some(Box::new(run_on_cpu(problem, problem.positions(), plan)))
        }
    }
}

/// Measures an over-relaxed sweep including the objective, from the sixth sweep on. Counts free vertices.
#[divan::bench(args = cases(&[false, true]), max_time = 2, sample_size = 1)]
fn sweep(bencher: Bencher, case: &Case) {
    let Some(mut engine) = case.engine() else { return };
    engine.advance(5).unwrap();
    bencher
        .counter(ItemsCount::new(problem(case.size).free_count()))
        .bench_local(|| engine.advance(1).unwrap());
}

/// Measures the objective alone. Counts triangles.
#[divan::bench(args = cases(&[false]), max_time = 0.5, sample_size = 1)]
fn objective(bencher: Bencher, case: &Case) {
    bencher
        .counter(ItemsCount::new(problem(case.size).triangles().len()))
        .with_inputs(|| case.engine().unwrap())
        .bench_local_values(|mut engine| engine.advance(0).unwrap());
}
