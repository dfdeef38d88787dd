//! Number of sweeps that a run takes to approach its limit. Compares the duration of the run, including the set-up of
//! coarse levels, with the duration of one plain sweep.
//!
//! ```text
//! cargo bench --bench convergence -- 57000          # vertices of the plates; without any argument 57,000
//! cargo bench --bench convergence -- MESH...        # mesh files instead of generated meshes
//! ```
//!
//! Compare ratios, not times. The variable `GPU_SMOOTH_ADAPTER` names the adapter; the default is the best.

#![allow(clippy::print_stdout)]

use std::path::Path;
use std::time::Duration;

use gpu_smooth::{Backend, Gpu, Mesh, Method, Metric, Options, Outcome, Smoother, Stopping};

/// Number of runs, of which the median counts.
const REPEATS: usize = 5;
/// Number of plain sweeps timed together.
const PLAIN: u32 = 20;

fn main() {
    let (sizes, files) = arguments();
    let outline = support::Outline::parse(include_str!("../meshes/plate.outline")).unwrap();
    let mut backends = vec![("cpu".to_owned(), Backend::Cpu)];
    match Gpu::open(std::env::var("GPU_SMOOTH_ADAPTER").ok().as_deref()).block() {
        Ok(gpu) => backends.push((gpu.adapter().name.clone(), Backend::Gpu(gpu))),
        Err(error) => println!("no GPU: {error}"),
    }
    println!("sweeps to 95 %, 99 %, 1e-4 and 1e-6 of the limit; time to 1e-6 in plain sweeps");
    let single = if files.is_empty() { hard_meshes() } else { read(&files) };
    for (start, mesh) in single {
        for (name, backend) in &backends {
            let row = measure(&mesh, Metric::Imr, Method::Multilevel, backend);
            println!("{:>8} {start} imr on {name}: {row}", mesh.points.len());
        }
    }
    for vertices in sizes {
        let plate = support::triangulate(&outline, vertices).unwrap();
        let starts = [
            ("perturbed", support::perturb_random(&plate, 1.0, 1)),
            ("distorted", support::distort_smooth(&plate, 0.9)),
            ("to collapse", support::distort_smooth(&plate, 1.0)),
        ];
        for (start, mesh) in &starts {
            for (name, backend) in &backends {
                for metric in [Metric::Imr, Metric::Rms] {
                    for method in [Method::Multilevel, Method::RELAXED] {
                        let row = measure(mesh, metric, method, backend);
                        println!("{vertices:>8} {start} {metric:<4} {method:?} on {name}: {row}");
                    }
                }
            }
        }
    }
}

/// Returns the numbers of vertices and the mesh files on the command line; 57,000 vertices without arguments.
fn arguments() -> (Vec<usize>, Vec<String>) {
    let mut sizes = Vec::new();
    let mut files = Vec::new();
    for argument in std::env::args().skip(1).filter(|argument| argument != "--bench") {
        match argument.parse() {
            Ok(vertices) => sizes.push(vertices),
            Err(_) => files.push(argument),
        }
    }
    if sizes.is_empty() && files.is_empty() {
        sizes.push(57_000);
    }
    (sizes, files)
}

fn read(files: &[String]) -> Vec<(String, Mesh)> {
    files.iter().map(|file| (file.clone(), support::read_mesh(Path::new(file)))).collect()
}

/// Makes meshes on which corrections gain little without acceleration by secant pairs.
fn hard_meshes() -> Vec<(String, Mesh)> {
    let perturbed = |mesh: &Mesh, strength| support::perturb_random(mesh, strength, 1);
    let meshes = [
        ("graded over 1e3", perturbed(&support::graded(30, 1e-3), 1.0)),
        ("graded over 1e6", perturbed(&support::graded(30, 1e-6), 1.0)),
        ("a vertex of 50", perturbed(&support::hub(50, 1e-2), 1.0)),
        ("a vertex of 200", perturbed(&support::hub(200, 1e-1), 1.0)),
        ("rings in equal distances", perturbed(&support::hub_evenly(50, 40), 1.0)),
        ("a layer of 1:30", perturbed(&support::layered(90, 30.0), 0.3)),
        ("a layer of 1:100", perturbed(&support::wavy_layer(90, 100.0, 3.0), 0.3)),
    ];
    meshes.map(|(name, mesh)| (name.to_owned(), mesh)).into()
}

fn measure(mesh: &Mesh, metric: Metric, method: Method, backend: &Backend) -> String {
    let smoother = Smoother::new(mesh).unwrap();
    let run = |options: &Options| -> Outcome { smoother.run(options).on(backend).block().unwrap() };
    let median = |options: &Options| -> Duration {
        let mut times: Vec<_> = (0..REPEATS).map(|_| run(options).smooth).collect();
        times.sort();
        times[REPEATS / 2]
    };
    let options = Options::default().scheme(metric.into()).method(method);
    let base = |outcome: &Outcome| -> Vec<f64> {
        outcome.history.iter().map(|o| o.of(metric).unwrap()).collect()
    };
    let exact = options.clone().method(Method::Multilevel).stopping(Stopping::Tolerance(1e-10));
    let limit = base(&run(&exact)).into_iter().fold(f64::INFINITY, f64::min);
    let long = options.clone().stopping(Stopping::Tolerance(0.0)).max_sweeps(400);
    let long = if method == Method::Multilevel { exact } else { long };
    let history = base(&run(&long));
    let to = |f: f64| history.iter().position(|&reached| reached <= f);
    let way = |share: f64| to(history[0] - share * (history[0] - limit));
    let within = |share: f64| to(limit * (1.0 + share));
    let text = |sweeps: Option<usize>| sweeps.map_or("-".to_owned(), |n| n.to_string());
    let counts = [way(0.95), way(0.99), within(1e-4), within(1e-6)].map(text).join(" / ");
    let Some(sweeps) = within(1e-6) else { return format!("{counts}; not reached") };
    let plain = Options::paper(metric.into()).stopping(Stopping::Tolerance(0.0)).max_sweeps(PLAIN);
    let plain = median(&plain).as_secs_f64() / f64::from(PLAIN);
    let whole = options.stopping(Stopping::Tolerance(0.0)).max_sweeps(sweeps as u32);
    let whole = median(&whole).as_secs_f64();
    format!("{counts}; {:.1} (plain sweep {:.2} ms)", whole / plain, plain * 1e3)
}
