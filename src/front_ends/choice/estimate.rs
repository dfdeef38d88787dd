//! Estimates the duration of a run on the CPU and on a GPU, and chooses the faster backend.

use crate::error::GpuError;
use crate::front_ends::choice::kept::Kept;
use crate::front_ends::choice::reason::BackendReason;
use crate::mesh::MeshSize;
use crate::options::Options;
use crate::smoother::Backend;

/// Vertex updates per second and core of the CPU engine, measured with imr on two cores (`docs/performance.md`).
const CPU_UPDATES_PER_CORE: f64 = 16e6;
/// Time to start a GPU's driver, device and kernels, in seconds. A cautious assumption, as no graphics card has been
/// measured yet; Mesa's software driver takes 0.06 to 0.25.
const GPU_START: f64 = 0.3;
/// Vertex updates per second of a discrete GPU. A cautious assumption, not measured.
const DISCRETE_UPDATES: f64 = 1e9;
/// Vertex updates per second of a GPU that shares the CPU's memory, or of an unknown kind. A cautious assumption, not
/// measured.
const INTEGRATED_UPDATES: f64 = 150e6;
/// The work of a run with corrections from coarser levels, in sweeps: about 12 sweeps, and 5 corrections of 1.5 sweeps
/// each.
const CORRECTED_SWEEPS: f64 = 20.0;
/// Sweeps of a run without corrections: over-relaxed imr takes this many to come within 1e-6 of its limit.
const PLAIN_SWEEPS: f64 = 130.0;

/// Returns the backend on which a run is estimated to end soonest, and the reason; see
/// [`Backend::auto_tried`]. `kept` has the adapter and its device.
pub(super) fn choose(
    kept: &Kept,
    size: MeshSize,
    options: &Options,
    try_drivers: impl FnOnce() -> Result<(), GpuError>,
) -> (Backend, BackendReason) {
    if options.max_sweeps == 0 {
        return (Backend::Cpu, BackendReason::NoSweeps);
    }
    let (cores, sweeps) = (rayon::current_num_threads(), expected_sweeps(options));
    let best = pays_from(FASTEST, cores, sweeps);
    if best.is_none_or(|least| size.vertices < least) {
        return (Backend::Cpu, BackendReason::CpuIsFaster { adapter: None, pays_from: best });
    }
    let chosen = kept.best(try_drivers, |adapter| {
        let summary = adapter.summary();
        if summary.is_software() {
            return (Backend::Cpu, BackendReason::OnlySoftware(summary));
        }
        match pays_from(summary.kind, cores, sweeps) {
            Some(pays_from) if size.vertices >= pays_from => {
                match adapter.gpu().and_then(|gpu| gpu.check_size(size).map(|()| gpu)) {
                    Ok(gpu) => (Backend::Gpu(gpu), BackendReason::GpuIsFaster { pays_from }),
                    Err(error) => (Backend::Cpu, BackendReason::GpuFails(error)),
                }
            }
            pays_from => {
                (Backend::Cpu, BackendReason::CpuIsFaster { adapter: Some(summary), pays_from })
            }
        }
    });
    chosen.unwrap_or_else(|error| (Backend::Cpu, BackendReason::GpuFails(error)))
}

/// The adapter kind with the highest assumed speed. Meshes too small for this kind start no driver.
const FASTEST: &str = "discrete GPU";

/// Returns the vertex updates per second of an adapter of this [kind](crate::adapter::AdapterSummary::kind). `None` for a
/// software adapter, as the CPU engine is always faster.
fn gpu_updates(kind: &str) -> Option<f64> {
    match kind {
        "discrete GPU" => Some(DISCRETE_UPDATES),
        "CPU" => None,
        _ => Some(INTEGRATED_UPDATES),
    }
}

/// Returns the work that a run is likely to take, in sweeps, corrections included.
fn expected_sweeps(options: &Options) -> f64 {
    // With EDGE as its base, which is not smooth, a run with corrections takes as many sweeps as one without.
    let is_short = options.is_multilevel() && options.scheme.base().is_smooth();
    let usual = if is_short { CORRECTED_SWEEPS } else { PLAIN_SWEEPS };
    usual.min(options.max_sweeps.into())
}

/// Returns the mesh size in vertices, rounded up to two digits, from which an adapter of this kind finishes before the
/// CPU. `None` if the CPU always finishes first.
fn pays_from(kind: &str, cores: usize, sweeps: f64) -> Option<usize> {
    let cpu_updates = CPU_UPDATES_PER_CORE * cores as f64;
    let saved = sweeps * (1.0 / cpu_updates - 1.0 / gpu_updates(kind)?);
    if saved <= 0.0 {
        return None;
    }
    let least = GPU_START / saved;
    let unit = 10f64.powf(least.log10().floor() - 1.0).max(1.0);
    Some(((least / unit).ceil() * unit) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metric::Metric;
    use crate::options::Method;

    #[test]
    fn a_gpu_pays_from_where_its_start_is_made_up_for() {
        // 500,000 vertices, 20 sweeps, 32 million a second: 0.3125 s on the CPU, 0.310 s on the card.
        assert_eq!(pays_from("discrete GPU", 2, 20.0), Some(500_000));
        for kind in ["integrated GPU", "virtual GPU", "other"] {
            assert_eq!(pays_from(kind, 2, 20.0), Some(620_000));
        }
        // The threshold rises with the number of cores, until the CPU is as fast as the GPU.
        assert_eq!(pays_from("discrete GPU", 16, 20.0), Some(5_200_000));
        assert_eq!(pays_from("integrated GPU", 10, 20.0), None);
        assert_eq!(pays_from("discrete GPU", 63, 20.0), None);
        for (cores, sweeps) in [(1, 20.0), (2, 20.0), (4, 130.0), (8, 1.0)] {
            let least = pays_from("discrete GPU", cores, sweeps).unwrap() as f64;
            let cpu = least * sweeps / (CPU_UPDATES_PER_CORE * cores as f64);
            let gpu = GPU_START + least * sweeps / DISCRETE_UPDATES;
            assert!(gpu <= cpu && cpu <= 1.1 * gpu, "{cores} cores: {gpu} s, {cpu} s");
        }
    }

    #[test]
    fn a_run_that_takes_many_sweeps_pays_for_a_gpu_earlier() {
        let expected = |scheme: Metric, method, max_sweeps| {
            let scheme = scheme.into();
            expected_sweeps(&Options { scheme, method, max_sweeps, ..Options::default() })
        };
        assert_eq!(expected(Metric::Imr, Method::Auto, 1000), 20.0);
        assert_eq!(expected(Metric::Imr, Method::RELAXED, 1000), 130.0);
        assert_eq!(expected(Metric::Edge, Method::Auto, 1000), 130.0);
        assert_eq!(expected(Metric::Edge, Method::Auto, 7), 7.0);
        assert_eq!(pays_from("discrete GPU", 2, 0.0), None);
    }

    #[test]
    fn a_software_adapter_never_pays() {
        assert_eq!(pays_from("CPU", 1, 1e6), None);
    }

    #[test]
    fn a_run_without_sweeps_is_on_the_cpu_for_that_reason() {
        let size = MeshSize { vertices: 100_000_000, triangles: 200_000_000 };
        let options = Options { max_sweeps: 0, ..Options::default() };
        let (backend, reason) =
            choose(&Kept::new(), size, &options, || panic!("no driver is needed"));
        assert!(matches!((backend, &reason), (Backend::Cpu, BackendReason::NoSweeps)), "{reason}");
    }

    #[test]
    fn no_driver_is_started_for_a_small_mesh() {
        let size = MeshSize { vertices: 2001, triangles: 3735 };
        let (backend, reason) = Backend::auto(size, &Options::default());
        assert!(matches!(backend, Backend::Cpu));
        let BackendReason::CpuIsFaster { adapter: None, pays_from } = &reason else {
            panic!("{reason}")
        };
        if let Some(least) = pays_from {
            let told = reason.to_string().replace(',', "");
            assert_eq!(told, format!("fewer than {least} vertices"));
        }
    }
}
