//! Coordinates that are not finite appear in f, at any vertex.

use gpu_smooth::{
    Backend, Metric,
    internal::{Stepwise, run_on_cpu, run_on_gpu},
};

use super::{backends, name, plan, plate, problem};

/// Evaluates f by each metric on each engine, at positions with a single NaN or infinite coordinate.
#[test]
fn a_position_that_is_no_number_shows_in_f() {
    let mesh = plate(300);
    let problem = problem(&mesh);
    let free = 0..10;
    for backend in backends() {
        for &metric in Metric::ALL {
            for (vertex, spoiled) in free.clone().zip([f64::NAN, f64::INFINITY, -f64::INFINITY]) {
                for axis in 0..2 {
                    let mut positions = problem.positions().to_vec();
                    positions[vertex][axis] = spoiled;
                    let plan = plan(metric.into(), 1);
                    let log = match backend {
                        Backend::Cpu => run_on_cpu(&problem, &positions, plan).advance(0),
                        Backend::Gpu(gpu) => {
                            run_on_gpu(gpu, &problem, &positions, plan).unwrap().advance(0)
                        }
                    };
                    let f = log.unwrap()[0].of(metric);
                    let what = format!("{metric} on the {}, {spoiled}: f {f:?}", name(backend));
                    assert!(f.is_none_or(|f| !f.is_finite()), "{what}");
                }
            }
        }
    }
}
