//! The work that a whole run gives to a device: dispatches, submissions, waits, late kernels and bytes.
//!
//! On a graphics card each of these quantities costs time that measurements on a software driver do not show. A commit
//! that changes a number also changes the number in this test, and a commit that raises a number states the reason.

use std::time::Duration;

use gpu_smooth::internal::{DeviceCounts, Plan, Stepwise, device_counts, prepare, run_on_gpu};
use gpu_smooth::{
    Backend, CheckpointPolicy, Gpu, Mesh, Method, Options, Scheme, Slide, Smoother, Stopping,
};

/// The counts of one run, with bytes for each vertex, rounded.
#[derive(Debug, PartialEq)]
struct Work {
    sweeps: u32,
    /// Corrections, or Newton steps of all vertices.
    steps: u32,
    dispatches: u64,
    submissions: u64,
    waits: u64,
    /// Kernels compiled before the first sweep of the run and after it.
    kernels: [u64; 2],
    uploaded: u64,
    read_back: u64,
    allocated: u64,
}

fn open() -> Gpu {
    Gpu::open(Some("llvmpipe")).block().expect("lavapipe is needed: tests/run installs it")
}

fn perturbed(vertices: usize) -> Mesh {
    let outline = support::Outline::parse(include_str!("../../meshes/plate.outline")).unwrap();
    support::perturb_random(&support::triangulate(&outline, vertices).unwrap(), 1.0, 1)
}

/// Returns the work of a run that gave `counts` to its device, on a mesh of `vertices` vertices.
fn work(counts: DeviceCounts, vertices: usize, [sweeps, steps]: [u32; 2]) -> Work {
    let DeviceCounts { dispatches, submissions, waits, kernels, late_kernels, .. } = counts;
    let each = |bytes: u64| (bytes as f64 / vertices as f64).round() as u64;
    Work {
        sweeps,
        steps,
        dispatches,
        submissions,
        waits,
        kernels: [kernels - late_kernels, late_kernels],
        uploaded: each(counts.uploaded),
        read_back: each(counts.read_back),
        allocated: each(counts.allocated),
    }
}

/// A policy that never saves positions. The default policy saves them each second, with a readback.
struct NeverSaved;

impl CheckpointPolicy for NeverSaved {
    fn interval(&self) -> Duration {
        Duration::MAX
    }
}

/// A whole run on a device of its own, which compiles every kernel in the run.
#[test]
fn a_run_to_its_end_gives_the_device_no_more_work_than_before() {
    let (gpu, mesh) = (open(), perturbed(20_000));
    let smoother = Smoother::new(&mesh).unwrap();
    let before = device_counts(&gpu);
    let backend = Backend::Gpu(gpu.clone());
    let options = Options::default();
    let run = smoother.run(&options).on(&backend).checkpoints(NeverSaved);
    let outcome = run.block().unwrap();
    let counts = device_counts(&gpu).since(&before);
    let done = [outcome.sweeps, outcome.newton_steps];
    // Newton steps in place of corrections raised dispatches from 180 and bytes from 135: an iteration of conjugate gradients
    // passes all levels. Submissions were 19, waits 14.
    let expected = Work {
        sweeps: 8,
        steps: 2,
        dispatches: 608,
        submissions: 11,
        waits: 11,
        kernels: [25, 0],
        uploaded: 79,
        read_back: 25,
        allocated: 295,
    };
    assert_eq!(work(counts, mesh.points.len(), done), expected);
}

/// Runs compile their kernels on all threads before the first sweep, whatever follows the sweeps.
#[test]
fn no_kernel_is_compiled_after_the_first_sweep() {
    let quadrilaterals =
        support::quadrilaterals::perturbed(&support::quadrilaterals::squares(30), 0.3);
    let mixed = support::quadrilaterals::perturbed(&support::quadrilaterals::mixed(30), 0.2);
    for (mesh, scheme, slides) in [
        (perturbed(900), "imr+rms", false),
        (perturbed(900), "shape-size", false),
        (perturbed(900), "imr", true),
        (quadrilaterals, "imr", false),
        (mixed, "rms", false),
    ] {
        let gpu = open();
        let mut smoother = Smoother::new(&mesh).unwrap();
        smoother.set_slide(slides.then(Slide::default).as_ref()).unwrap();
        let options = Options::default().scheme(scheme.parse::<Scheme>().unwrap());
        let backend = Backend::Gpu(gpu.clone());
        let outcome = smoother.run(&options).on(&backend).block().unwrap();
        assert!(outcome.corrections + outcome.newton_steps > 0, "{scheme}");
        let DeviceCounts { kernels, late_kernels, .. } = device_counts(&gpu);
        assert!(kernels > 10 && late_kernels == 0, "{scheme}: {late_kernels} of {kernels}");
    }
}

/// Whole runs without corrections do as many sweeps in a submission as take a tenth of a second. Here one submission has
/// all sweeps, whatever their time.
#[test]
fn sweeps_alone_give_the_device_no_more_work_than_before() {
    let (gpu, mesh) = (open(), perturbed(2000));
    let (_, problem) = prepare(&mesh).unwrap();
    let stopping = Stopping::Tolerance(0.0);
    let plan = Plan::new(&Options::default().method(Method::RELAXED).stopping(stopping));
    let before = device_counts(&gpu);
    run_on_gpu(&gpu, &problem, problem.positions(), plan).unwrap().advance(20).unwrap();
    let counts = device_counts(&gpu).since(&before);
    let expected = Work {
        sweeps: 20,
        steps: 0,
        dispatches: 142,
        submissions: 1,
        waits: 1,
        kernels: [3, 0],
        uploaded: 63,
        // The twelfth metric adds 8 bytes to each evaluation of a history: the numbers were 13 and 78.
        read_back: 14,
        allocated: 79,
    };
    assert_eq!(work(counts, mesh.points.len(), [20, 0]), expected);
}
