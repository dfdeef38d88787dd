//! Loss of a device during a run, between frames, or before.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::mpsc;
use std::task::{Context, Poll, Waker};
use std::time::{Duration, Instant};

use gpu_smooth::{
    Backend, CheckpointPolicy, Gpu, GpuError, Mesh, Options, Outcome, Progress, Quality, Scheme,
    Smoother, Stop, Stopping, TargetField, Targets,
    gpu::{Budget, DeviceMesh, Readback, Sweeps, VertexBuffer},
    wgpu,
};

use crate::app::{App, Vertices, bad_plate, gpu_error, interior};
use support::{SplitMix64, check, f_imr};

/// Executes `work` on another thread, and fails after a minute without result.
fn within_a_minute<T: Send + 'static>(work: impl FnOnce() -> T + Send + 'static) -> T {
    let (sender, receiver) = mpsc::channel();
    let worker = std::thread::spawn(move || sender.send(work()));
    match receiver.recv_timeout(Duration::from_secs(60)) {
        Err(mpsc::RecvTimeoutError::Timeout) => panic!("it hangs"),
        result => {
            let _ = worker.join().expect("it panicked");
            result.unwrap()
        }
    }
}

#[track_caller]
fn assert_lost(error: &GpuError) {
    assert!(matches!(error, GpuError::Lost(_)), "{error:?}");
    assert!(error.to_string().starts_with("the device was lost: "), "{error}");
}

fn endless() -> Options {
    Options::default().stopping(Stopping::Tolerance(0.0)).max_sweeps(u32::MAX)
}

#[test]
fn a_run_says_that_the_device_was_lost() {
    within_a_minute(|| {
        let mesh = bad_plate(500);
        let smoother = Smoother::new(&mesh).unwrap();
        let app = App::new();
        let backend = Backend::Gpu(app.another_gpu());
        let calls = AtomicU32::new(0);
        let observe = |_: &Progress| {
            if calls.fetch_add(1, Ordering::Relaxed) == 1 {
                app.device().destroy();
            }
            ControlFlow::Continue(())
        };
        let error = smoother.run(&endless()).on(&backend).observe(observe).block().unwrap_err();
        assert_lost(&gpu_error(error));
        assert_eq!(calls.load(Ordering::Relaxed), 2);
        // A later run on the device fails with an equal error.
        let error = smoother.run(&endless()).on(&backend).observe(observe).block().unwrap_err();
        assert_lost(&gpu_error(error));
    });
}

/// A policy that continues a run on the CPU after a failure of the device.
struct GoesOn {
    interval: Duration,
    told: Vec<(GpuError, u32)>,
}

impl CheckpointPolicy for GoesOn {
    fn falls_back_to_cpu(&mut self, error: &GpuError, from: u32) -> bool {
        self.told.push((error.clone(), from));
        true
    }

    fn interval(&self) -> Duration {
        self.interval
    }
}

/// Smooths on a device that another thread destroys after the duration `after`.
fn run_with_a_loss(
    smoother: &Smoother<'_>,
    options: &Options,
    after: Duration,
) -> (Outcome, GoesOn) {
    let app = App::new();
    let backend = Backend::Gpu(app.another_gpu());
    let device = app.device().clone();
    let mut policy = GoesOn { interval: Duration::ZERO, told: Vec::new() };
    let killer = std::thread::spawn(move || {
        std::thread::sleep(after);
        device.destroy();
    });
    let outcome = smoother
        .run(options)
        .on(&backend)
        .checkpoints(&mut policy)
        .observe(|_: &Progress| ControlFlow::Continue(()))
        .block()
        .unwrap();
    killer.join().unwrap();
    (outcome, policy)
}

/// Measures the duration of a run without a loss.
fn time_of_a_run(smoother: &Smoother<'_>, options: &Options) -> Duration {
    let backend = Backend::Gpu(App::new().another_gpu());
    let mut policy = GoesOn { interval: Duration::ZERO, told: Vec::new() };
    let start = Instant::now();
    smoother
        .run(options)
        .on(&backend)
        .checkpoints(&mut policy)
        .observe(|_: &Progress| ControlFlow::Continue(()))
        .block()
        .unwrap();
    start.elapsed()
}

/// Another thread destroys the device at a random moment. The run must continue on the CPU and reach an equal
/// quality. The environment variable ROUNDS is the number of runs.
#[test]
fn a_run_goes_on_on_the_cpu_when_the_device_is_lost() {
    let rounds = std::env::var("ROUNDS").ok().and_then(|n| n.parse().ok()).unwrap_or(4);
    let (sender, receiver) = mpsc::channel();
    std::thread::spawn(move || {
        let mesh = bad_plate(500);
        let smoother = Smoother::new(&mesh).unwrap();
        let mut random = SplitMix64::new(17);
        let mut lost = 0;
        for round in 0..rounds {
            let scheme: Scheme = ["imr", "edge+imr", "rms"][round % 3].parse().unwrap();
            let base = scheme.base();
            let options = Options::default().scheme(scheme);
            let on_cpu = smoother.run(&options).on(&Backend::Cpu).block().unwrap();
            // A fraction of the duration on this machine, because a fast machine would finish before a fixed time.
            let after = time_of_a_run(&smoother, &options).mul_f64(0.8 * random.unit());
            let (outcome, policy) = run_with_a_loss(&smoother, &options, after);
            let f = |o: &Outcome| Quality::of(&o.points, smoother.topology()).unwrap().f(base);
            let smoothed = Mesh { points: outcome.points.clone(), ..mesh.clone() };
            assert!(check::is_valid(&smoothed) && check::same_orientations(&mesh, &smoothed));
            assert_eq!(outcome.stop, on_cpu.stop, "round {round}");
            assert!((f(&outcome) - f(&on_cpu)).abs() < 2e-3 * f(&on_cpu), "round {round}");
            let Some(fault) = &outcome.device_fault else {
                assert!(policy.told.is_empty());
                continue;
            };
            lost += 1;
            assert_lost(&fault.error);
            assert_eq!(policy.told.len(), 1);
            assert!(fault.sweep <= outcome.sweeps && policy.told[0].1 == fault.sweep);
            assert_eq!(outcome.history.len() as u32, outcome.sweeps + 1);
        }
        sender.send(lost).unwrap();
    });
    let lost = receiver.recv_timeout(Duration::from_secs(60 + 10 * rounds as u64));
    assert!(lost.expect("it hangs, or has failed") > rounds / 4);
}

/// After a loss, a run continues from the latest positions in memory.
#[test]
fn a_run_goes_on_from_what_was_kept() {
    within_a_minute(|| {
        let mesh = bad_plate(500);
        let smoother = Smoother::new(&mesh).unwrap();
        let options = endless().max_sweeps(60);
        for (interval, from) in [(Duration::ZERO, 6), (Duration::MAX, 0)] {
            let app = App::new();
            let backend = Backend::Gpu(app.another_gpu());
            let mut policy = GoesOn { interval, told: Vec::new() };
            let mut lost_at = None;
            let mut observe = |progress: &Progress| {
                // Positions are stored after the call of the observer, so the loss appears one sweep later.
                if progress.sweep >= 6 && lost_at.is_none() {
                    lost_at = Some(progress.sweep);
                    app.device().destroy();
                }
                ControlFlow::Continue(())
            };
            let outcome = smoother
                .run(&options)
                .on(&backend)
                .checkpoints(&mut policy)
                .observe(&mut observe)
                .block()
                .unwrap();
            assert_eq!((outcome.stop, outcome.sweeps), (Stop::MaxSweeps, 60));
            let fault = outcome.device_fault.unwrap();
            assert_lost(&fault.error);
            if from == 0 {
                assert_eq!(fault.sweep, 0);
            } else {
                assert!((1..=lost_at.unwrap()).contains(&fault.sweep), "{}", fault.sweep);
            }
        }
    });
}

/// A run with bounds, or with a host stage between its sweeps, leaves a lost device once, and does not use it again.
#[test]
fn a_run_with_bounds_or_a_stage_leaves_a_lost_device_once() {
    within_a_minute(|| {
        let mesh = bad_plate(500);
        let bounded = Options::default().max_move(Some(0.3));
        let kept = Options::default().keep_altitude(true);
        let targets = Targets::equilateral(mesh.points.len());
        let field = || TargetField::new(&mesh, &targets).unwrap();
        for (options, has_stage) in [(bounded, false), (kept, false), (Options::default(), true)] {
            let mut smoother = Smoother::new(&mesh).unwrap();
            if has_stage {
                smoother.set_target_field(field()).unwrap();
            }
            let app = App::new();
            let backend = Backend::Gpu(app.another_gpu());
            let mut policy = GoesOn { interval: Duration::ZERO, told: Vec::new() };
            let mut is_lost = false;
            let mut observe = |progress: &Progress| {
                if progress.sweep >= 2 && !is_lost {
                    is_lost = true;
                    app.device().destroy();
                }
                ControlFlow::Continue(())
            };
            let outcome = smoother
                .run(&options)
                .on(&backend)
                .checkpoints(&mut policy)
                .observe(&mut observe)
                .block()
                .unwrap();
            assert_eq!(policy.told.len(), 1, "{:?}", policy.told);
            assert!(outcome.device_fault.is_some());
            assert_eq!(outcome.stop, Stop::Converged);
            let smoothed = Mesh { points: outcome.points, ..mesh.clone() };
            assert!(check::is_valid(&smoothed) && f_imr(&smoothed) < f_imr(&mesh));
        }
    });
}

#[test]
fn a_future_completes_when_the_device_is_lost() {
    within_a_minute(|| {
        let mesh = bad_plate(500);
        let smoother = Smoother::new(&mesh).unwrap();
        // The device is lost before the first poll, or between later polls.
        for waited in [0, 1, 5] {
            let app = App::new();
            let backend = Backend::Gpu(app.gpu.clone());
            let options = endless();
            let observe = |_: &Progress| ControlFlow::Continue(());
            let mut future =
                Box::pin(smoother.run(&options).on(&backend).observe(observe).into_future());
            let mut context = Context::from_waker(Waker::noop());
            let mut polls = 0;
            let error = loop {
                if polls == waited {
                    app.device().destroy();
                }
                if let Poll::Ready(outcome) = future.as_mut().poll(&mut context) {
                    break outcome.unwrap_err();
                }
                // Polling a lost device may fail, which the application must handle.
                let _ = app.device().poll(wgpu::PollType::Poll);
                polls += 1;
            };
            assert!(polls >= waited);
            assert_lost(&gpu_error(error));
        }
    });
}

#[test]
fn encoding_for_a_lost_device_neither_panics_nor_hangs() {
    within_a_minute(|| {
        let mesh = bad_plate(500);
        let app = App::new();
        let device_mesh = app.mesh(&mesh);
        let mut sweeps = Sweeps::new(&device_mesh, &Options::default()).block().unwrap();
        let vertices = Vertices::usual(&app, &mesh);
        let usage = wgpu::BufferUsages::STORAGE;
        let published = app.buffer(128, usage | wgpu::BufferUsages::COPY_SRC);
        let bound = vertices.bind(&device_mesh);
        let objective = sweeps.bind_objective(published.slice(..)).unwrap();
        let mut judged =
            Sweeps::until_converged(&device_mesh, &Options::default()).block().unwrap();
        let words = app.buffer(8 * mesh.points.len() as u64, usage);
        let mask = device_mesh.bind_mask(words.slice(..)).unwrap();
        let mut readback = Readback::<f32>::new(&app.gpu, published.slice(..), 1).unwrap();
        app.gpu.errors().block().unwrap();
        assert_eq!(readback.latest().unwrap(), None);
        let targets = VertexBuffer::new(words.slice(..), 8);
        let drag = device_mesh.bind_move(&[7], &targets, 8.0, published.slice(56..)).unwrap();
        app.submit(|encoder| sweeps.encode_sweeps(encoder, 2));
        app.device().destroy();
        app.submit(|encoder| {
            // Encoding for a lost device succeeds like encoding for a working one.
            bound.encode_import(encoder);
            mask.encode_mask(encoder);
            drag.encode_move(encoder);
            sweeps.encode_sweeps(encoder, 2);
            judged.encode_sweeps(encoder, 2);
            objective.encode_objective(encoder);
            bound.encode_export(encoder);
        });
        // No copy is in flight that the loss could end.
        assert_lost(&readback.latest().unwrap_err());
        assert_lost(&app.gpu.errors().block().unwrap_err());
        let (device, queue) = (app.device().clone(), app.gpu.queue().clone());
        // The queue of a lost device must not be mistaken for that of another device.
        assert_lost(&Gpu::new(device, queue).err().unwrap());
        let free = interior(&mesh)[0];
        assert_lost(&gpu_error(device_mesh.pin(&[free]).unwrap_err()));
        assert_lost(&gpu_error(device_mesh.set_pinned(&[]).unwrap_err()));
        assert_lost(&gpu_error(app.gpu.prepare(&Options::default()).unwrap_err()));
        judged.restart();
        let _ = device_mesh.bind_move(&[7], &targets, 8.0, published.slice(56..)).map(drop);
        let _ = device_mesh.bind_mask(words.slice(..)).map(drop);
        assert_lost(&Readback::<f32>::new(&app.gpu, published.slice(..), 1).err().unwrap());
        if app.device().features().contains(wgpu::Features::TIMESTAMP_QUERY) {
            assert_lost(&Budget::micros(100).timed_by(&app.gpu).err().unwrap());
        }
        assert_lost(&device_mesh.read_points().block().unwrap_err());
        match DeviceMesh::new(&app.gpu, &mesh) {
            Err(error) => assert_lost(&gpu_error(error)),
            Ok(device_mesh) => {
                assert_lost(&device_mesh.read_points().block().unwrap_err());
            }
        }
    });
}

#[test]
fn a_new_device_goes_on_from_the_last_positions() {
    within_a_minute(|| {
        let mut mesh = bad_plate(500);
        let options = Options::default();
        let start = f_imr(&mesh);
        {
            let app = App::new();
            let device_mesh = app.mesh(&mesh);
            let mut sweeps = Sweeps::new(&device_mesh, &options).block().unwrap();
            app.submit(|encoder| sweeps.encode_sweeps(encoder, 3));
            mesh.points = app.points(&device_mesh);
            app.submit(|encoder| sweeps.encode_sweeps(encoder, 3));
            app.device().destroy();
            assert_lost(&device_mesh.read_points().block().unwrap_err());
        }
        let saved = f_imr(&mesh);
        assert!(saved < start);
        let app = App::new();
        let device_mesh = app.mesh(&mesh);
        let mut sweeps = Sweeps::new(&device_mesh, &options).block().unwrap();
        app.submit(|encoder| sweeps.encode_sweeps(encoder, 20));
        let points = app.points(&device_mesh);
        assert!(f_imr(&Mesh { points, ..mesh.clone() }) < saved);
    });
}
