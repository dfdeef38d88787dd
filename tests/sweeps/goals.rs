//! Goals: the paper's test of convergence, with all of its schemes.

use crate::{SCHEMES, backends, history, name, perturbed, run, scheme};
use gpu_smooth::{
    Backend, Goal, Mesh, Metric, Options, Quality, Smoother, Stop, Stopping, options::PNormExponent,
};
use std::sync::OnceLock;

/// Returns the approximate optimum of a metric on the perturbed plate, found by over-relaxed sweeps
/// on the CPU.
fn desired(metric: Metric) -> f64 {
    static FOUND: OnceLock<Vec<(Metric, f64)>> = OnceLock::new();
    let found = FOUND.get_or_init(|| {
        let smoother = Smoother::new(perturbed()).unwrap();
        let find = |metric: Metric| {
            let sharpness = Some(PNormExponent::CONTINUED);
            let options =
                Options::default().scheme(metric.into()).edge_norm(sharpness).max_sweeps(500);
            let f = history(&run(&smoother, &options, &backends()[0]), metric);
            (metric, f.into_iter().fold(f64::INFINITY, f64::min))
        };
        [Metric::Edge, Metric::Area, Metric::Rms].map(find).to_vec()
    });
    found.iter().find(|(m, _)| *m == metric).unwrap().1
}

#[test]
fn both_engines_reach_goals_at_the_same_sweep() {
    let smoother = Smoother::new(perturbed()).unwrap();
    for name_of_scheme in SCHEMES {
        for fraction in [0.95, 0.99] {
            let scheme = scheme(name_of_scheme);
            let base = scheme.base();
            let stopping = Stopping::Goal(Goal { fraction, desired: Some(desired(base)) });
            let options = Options::paper(scheme).stopping(stopping).max_sweeps(300);
            let [cpu, gpu] = backends().each_ref().map(|backend| run(&smoother, &options, backend));
            let [f_cpu, f_gpu] =
                [&cpu, &gpu].map(|o| history(o, base).into_iter().fold(f64::INFINITY, f64::min));
            let label = format!("{name_of_scheme} to {fraction}");
            assert_eq!((cpu.stop, cpu.sweeps), (gpu.stop, gpu.sweeps), "{label}");
            assert_eq!(cpu.best_sweep, gpu.best_sweep, "{label}");
            // Near slivers, the last digits of a comparison decide whether EDGE accepts a step.
            let bound = if base == Metric::Edge { 1e-4 } else { 1e-6 };
            assert!((f_gpu / f_cpu - 1.0).abs() < bound, "{label}: {f_gpu} for {f_cpu}");
        }
    }
}

/// On an optimal mesh, the runs that search the optimum gain only rounding errors.
#[test]
fn the_optimum_is_reached_from_the_start_on_an_optimal_mesh() {
    // The only free vertex is in the center of its neighbors.
    let points = (0..9).map(|i| [f64::from(i % 3) / 2.0, f64::from(i / 3) / 2.0]).collect();
    let cells = [[0, 1, 4, 3], [1, 2, 5, 4], [3, 4, 7, 6], [4, 5, 8, 7]];
    let halves = cells.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
    let mesh = Mesh { points, triangles: halves.collect(), ..Mesh::default() };
    let smoother = Smoother::new(&mesh).unwrap();
    for name_of_scheme in ["imr", "rms", "area+imr"] {
        let stopping = Stopping::Goal(Goal { fraction: 0.95, desired: None });
        let options = Options::default().stopping(stopping).scheme(scheme(name_of_scheme));
        for backend in backends() {
            let outcome = run(&smoother, &options, backend);
            let label = format!("{name_of_scheme} on the {}", name(backend));
            assert_eq!((outcome.stop, outcome.sweeps), (Stop::Reached, 0), "{label}");
            assert_eq!(outcome.goal.unwrap().best_fraction, 1.0, "{label}");
            assert!(outcome.points == mesh.points, "{label}");
        }
    }
}

#[test]
fn a_goal_out_of_reach_is_not_reached_and_the_best_state_is_returned() {
    let mesh = perturbed();
    let smoother = Smoother::new(mesh).unwrap();
    for (name_of_scheme, beyond) in [("area+imr", 0.0), ("edge+imr", 0.02), ("imr", 0.02)] {
        for backend in backends() {
            let scheme = scheme(name_of_scheme);
            let base = scheme.base();
            let optimum = if base == Metric::Imr { 1.0 } else { desired(base) };
            let stopping = Stopping::Goal(Goal { fraction: 1.0, desired: Some(optimum - beyond) });
            let options = Options::paper(scheme).stopping(stopping).max_sweeps(400);
            let outcome = run(&smoother, &options, backend);
            let label = format!("{name_of_scheme} on the {}", name(backend));
            assert!(matches!(outcome.stop, Stop::Stalled | Stop::MaxSweeps), "{label}");
            let history = history(&outcome, base);
            let best = history.iter().copied().fold(f64::INFINITY, f64::min);
            // In a scheme of one metric, the last state is the best, apart from rounding on a device.
            let returned = history[outcome.best_sweep as usize];
            assert!(returned <= best * (1.0 + 1e-9), "{label}: {returned} for {best}");
            let f = Quality::of(&outcome.points, smoother.topology()).unwrap().f(base);
            // The device sums terms that are evaluated in single precision.
            let digits = if matches!(backend, Backend::Cpu) { 1e-12 } else { 2e-7 };
            let rounding = digits * (best - base.ideal_squared());
            assert!((f - best).abs() <= rounding + 1e-14, "{label}: {f} returned, {best} seen");
            if name_of_scheme == "area+imr" {
                let last = history[outcome.sweeps as usize];
                assert!(last > 1.001 * best, "the best is not the last: {last} after {best}");
            }
            let goal = outcome.goal.unwrap();
            let gone = (history[0] - best) / (history[0] - goal.desired);
            assert!((goal.best_fraction - gone).abs() < 1e-6 && gone < 1.0, "{label}: {gone}");
        }
    }
}
