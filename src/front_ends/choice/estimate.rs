//! Estimates the duration of a run on the CPU and on a GPU, and chooses the faster backend.

use crate::error::GpuError;
use crate::front_ends::choice::kept::Kept;
use crate::front_ends::choice::reason::BackendReason;
use crate::mesh::MeshSize;
use crate::options::Options;
use crate::smoother::Backend;

/// Times of a part of a run in microseconds for each vertex: on one thread, and on one core if all cores share the work.
struct Work {
    alone: f64,
    shared: f64,
}

impl Work {
    /// Returns the time in seconds for each vertex on this number of cores.
    fn on(&self, cores: usize) -> f64 {
        1e-6 * (self.alone + self.shared / cores as f64)
    }
}

/// The model of the time of a run, without reading, preparing and writing the mesh, which take equally long for all engines.
///
/// A run on a device takes the start, the work of the host, and its sweeps at the rate of the device. docs/performance.md states
/// how the constants were obtained.
struct Model {
    /// A run of the default method on the CPU. Measured on one and on two cores, with 250,000 and a million vertices by `imr`.
    cpu: Work,
    /// Work of the host in a run on a device: coarser levels, judgment and checks. From a study of the library, not measured
    /// beside a card.
    host: Work,
    /// Vertex updates per second and core of sweeps alone on the CPU, measured with `imr` on two cores.
    cpu_updates_per_core: f64,
    /// Time to start a GPU's driver, device and kernels, in seconds. An assumption: Mesa's software driver takes 0.06 to 0.25.
    start: f64,
    /// Vertex updates per second of a discrete GPU in a laptop; a card of a data center does eight times as many. Calculated from
    /// the instructions and the bytes of a sweep, not measured.
    discrete_updates: f64,
    /// Vertex updates per second of a GPU that shares the CPU's memory, or of an unknown kind. Calculated, not measured.
    integrated_updates: f64,
    /// The work of a run of the default method on a device, in sweeps: some 8 sweeps, and 2 Newton steps of some 6 sweeps each.
    stepped_sweeps: f64,
    /// Sweeps of a run without steps: over-relaxed imr takes this many to come within 1e-6 of its limit.
    plain_sweeps: f64,
}

const MODEL: Model = Model {
    cpu: Work { alone: 0.1, shared: 3.6 },
    host: Work { alone: 0.13, shared: 0.65 },
    cpu_updates_per_core: 16e6,
    start: 0.3,
    discrete_updates: 1e9,
    integrated_updates: 0.2e9,
    stepped_sweeps: 20.0,
    plain_sweeps: 130.0,
};

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
    let (cores, sweeps) = (rayon::current_num_threads(), ExpectedSweeps::of(options));
    let best = pays_from(FASTEST, cores, &sweeps);
    if best.is_none_or(|least| size.vertices < least) {
        return (Backend::Cpu, BackendReason::CpuIsFaster { adapter: None, pays_from: best });
    }
    let chosen = kept.best(try_drivers, |adapter| {
        let summary = adapter.summary();
        if summary.is_software() {
            return (Backend::Cpu, BackendReason::OnlySoftware(summary));
        }
        match pays_from(summary.kind, cores, &sweeps) {
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
        "discrete GPU" => Some(MODEL.discrete_updates),
        "CPU" => None,
        _ => Some(MODEL.integrated_updates),
    }
}

/// The work that a run is likely to take.
struct ExpectedSweeps {
    /// The number of sweeps, steps included.
    count: f64,
    /// Whether Newton steps of all vertices or corrections follow the sweeps. If not, the run has sweeps alone.
    is_multilevel: bool,
}

impl ExpectedSweeps {
    fn of(options: &Options) -> Self {
        // With EDGE as its base, which is not smooth, a run with corrections takes as many sweeps as one without.
        let is_multilevel = options.is_multilevel() && options.scheme.base().is_smooth();
        let usual = if is_multilevel { MODEL.stepped_sweeps } else { MODEL.plain_sweeps };
        Self { count: usual.min(options.max_sweeps.into()), is_multilevel }
    }

    /// Returns the time of the sweeps on the CPU, in seconds for each vertex.
    fn on_cpu(&self, cores: usize) -> f64 {
        match self.is_multilevel {
            true => MODEL.cpu.on(cores) * self.count / MODEL.stepped_sweeps,
            false => self.count / (MODEL.cpu_updates_per_core * cores as f64),
        }
    }

    /// Returns the time of the sweeps and of the work of the host in a run on a device, in seconds for each vertex.
    fn on_device(&self, cores: usize, updates: f64) -> f64 {
        let host = if self.is_multilevel { MODEL.host.on(cores) } else { 0.0 };
        host + self.count / updates
    }
}

/// Returns the mesh size in vertices, rounded up to two digits, from which an adapter of this kind finishes before the
/// CPU. `None` if the CPU always finishes first.
fn pays_from(kind: &str, cores: usize, sweeps: &ExpectedSweeps) -> Option<usize> {
    let saved = sweeps.on_cpu(cores) - sweeps.on_device(cores, gpu_updates(kind)?);
    if saved <= 0.0 {
        return None;
    }
    let least = MODEL.start / saved;
    let unit = 10f64.powf(least.log10().floor() - 1.0).max(1.0);
    Some(((least / unit).ceil() * unit) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metric::Metric;
    use crate::options::Method;

    const STEPPED: ExpectedSweeps = ExpectedSweeps { count: 20.0, is_multilevel: true };

    #[test]
    fn a_gpu_pays_from_where_its_start_is_made_up_for() {
        // On two cores, 1.9 µs for a vertex on the CPU, and 0.475 µs with a card: 0.3 s are saved with 211,000 vertices.
        assert_eq!(pays_from("discrete GPU", 2, &STEPPED), Some(220_000));
        for kind in ["integrated GPU", "virtual GPU", "other"] {
            assert_eq!(pays_from(kind, 2, &STEPPED), Some(230_000));
        }
        // The threshold rises with the number of cores, until the CPU is as fast as the GPU.
        assert_eq!(pays_from("discrete GPU", 16, &STEPPED), Some(2_300_000));
        assert_eq!(pays_from("integrated GPU", 10, &STEPPED), Some(1_900_000));
        assert_eq!(pays_from("integrated GPU", 32, &STEPPED), None);
        assert_eq!(pays_from("discrete GPU", 63, &STEPPED), None);
        let few = ExpectedSweeps { count: 8.0, is_multilevel: true };
        let plain = ExpectedSweeps { count: 130.0, is_multilevel: false };
        for (cores, sweeps) in [(1, &STEPPED), (2, &STEPPED), (4, &plain), (2, &few)] {
            let least = pays_from("discrete GPU", cores, sweeps).unwrap() as f64;
            let cpu = least * sweeps.on_cpu(cores);
            let gpu = MODEL.start + least * sweeps.on_device(cores, MODEL.discrete_updates);
            assert!(gpu <= cpu && cpu <= 1.1 * gpu, "{cores} cores: {gpu} s, {cpu} s");
        }
    }

    #[test]
    fn a_run_that_takes_many_sweeps_pays_for_a_gpu_earlier() {
        let expected = |scheme: Metric, method, max_sweeps| {
            let scheme = scheme.into();
            let options = Options { scheme, method, max_sweeps, ..Options::default() };
            let ExpectedSweeps { count, is_multilevel } = ExpectedSweeps::of(&options);
            (count, is_multilevel)
        };
        assert_eq!(expected(Metric::Imr, Method::Auto, 1000), (20.0, true));
        assert_eq!(expected(Metric::Imr, Method::RELAXED, 1000), (130.0, false));
        assert_eq!(expected(Metric::Edge, Method::Auto, 1000), (130.0, false));
        assert_eq!(expected(Metric::Edge, Method::Auto, 7), (7.0, false));
        let sweeps = |count| ExpectedSweeps { count, is_multilevel: false };
        assert!(
            pays_from("discrete GPU", 2, &sweeps(130.0))
                < pays_from("discrete GPU", 2, &sweeps(20.0))
        );
        assert_eq!(pays_from("discrete GPU", 2, &sweeps(0.0)), None);
    }

    #[test]
    fn a_software_adapter_never_pays() {
        assert_eq!(pays_from("CPU", 1, &STEPPED), None);
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
