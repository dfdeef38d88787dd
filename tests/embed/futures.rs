//! Runs as futures: polling of the device, and dropped futures.

use std::future::Future;
use std::ops::ControlFlow;
use std::pin::pin;
use std::sync::atomic::{AtomicBool, Ordering};
use std::task::{Context, Poll, Waker};
use std::time::{Duration, Instant};

use gpu_smooth::{
    Backend, Goal, Gpu, Method, Metric, Options, Outcome, Progress, Quality, Smoother, Stop,
    Stopping, gpu::Sweeps, wgpu,
};

use crate::app::{App, bad_plate};

/// Polls a future like an application that polls its device once per frame. Returns the result and the number of
/// frames.
fn drive<F: IntoFuture>(device: &wgpu::Device, future: F) -> (F::Output, u32) {
    let mut future = pin!(future.into_future());
    let mut context = Context::from_waker(Waker::noop());
    let end = Instant::now() + Duration::from_secs(60);
    let mut frames = 0;
    while Instant::now() < end {
        if let Poll::Ready(output) = future.as_mut().poll(&mut context) {
            return (output, frames);
        }
        device.poll(wgpu::PollType::Poll).unwrap();
        frames += 1;
    }
    panic!("the future was not done after {frames} frames");
}

fn go_on(_: &Progress) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// Compares two outcomes except for their times.
fn assert_same(expected: &Outcome, found: &Outcome) {
    assert_eq!(expected.points, found.points);
    assert_eq!((expected.stop, expected.sweeps), (found.stop, found.sweeps));
    assert_eq!((expected.best_sweep, &expected.goal), (found.best_sweep, &found.goal));
    let f = |outcome: &Outcome| -> Vec<_> {
        outcome.history.iter().map(|o| Metric::ALL.iter().map(|&m| o.of(m)).collect()).collect()
    };
    let (a, b): (Vec<Vec<_>>, _) = (f(expected), f(found));
    assert_eq!(a, b);
}

fn cases() -> [Options; 3] {
    let edge = Options::default().scheme("edge+imr".parse().unwrap()).method(Method::RELAXED);
    let goal = Goal { fraction: 0.95, desired: None };
    [
        Options::default().track_all(true),
        edge.max_sweeps(30),
        Options::default().stopping(Stopping::Goal(goal)),
    ]
}

#[test]
fn a_run_polled_by_the_application_is_the_blocking_run() {
    let mesh = bad_plate(600);
    let smoother = Smoother::new(&mesh).unwrap();
    let app = App::new();
    let on_app = Backend::Gpu(app.gpu.clone());
    let backend = Backend::Gpu(app.another_gpu());
    for options in cases() {
        let expected = smoother.run(&options).on(&backend).block().unwrap();
        let observe = go_on;
        let future = smoother.run(&options).on(&on_app).observe(observe);
        let (found, frames) = drive(app.device(), future);
        assert_same(&expected, &found.unwrap());
        assert!(frames > 0, "the future blocked the thread");
    }
}

/// A multithreaded runtime accepts only futures that are `Send`.
#[test]
fn futures_can_move_between_threads() {
    const fn is_send<T: Send>(_: &T) {}
    let mesh = bad_plate(200);
    let smoother = Smoother::new(&mesh).unwrap();
    let app = App::new();
    let on_app = Backend::Gpu(app.gpu.clone());
    let (device_mesh, options) = (app.mesh(&mesh), Options::default());
    is_send(&smoother.run(&options).on(&on_app).observe(|_: &Progress| ControlFlow::Break(())));
    let observe: &mut (dyn FnMut(&Progress) -> ControlFlow<()> + Send) = &mut go_on;
    is_send(&smoother.run(&options).on(&on_app).observe(observe));
    is_send(&smoother.run(&options).on(&on_app).into_future());
    is_send(&device_mesh.read_points().into_future());
    // A function may return the future of a run with options and a backend of its own.
    fn begun(smoother: &Smoother<'_>, gpu: Gpu) -> impl Future<Output: Send> + Send {
        let run = smoother.run(&Options::default()).on(&Backend::Gpu(gpu));
        run.into_future()
    }
    is_send(&begun(&smoother, app.gpu.clone()));
}

/// A runtime requires spawned tasks to be `Send` and `'static`.
#[test]
fn a_prepared_mesh_that_owns_all_it_needs_is_run_in_another_thread() {
    fn spawn<T: Send + 'static>(
        task: impl Future<Output = T> + Send + 'static,
    ) -> std::thread::JoinHandle<T> {
        std::thread::spawn(|| pollster::block_on(task))
    }
    let mesh = bad_plate(400);
    let expected =
        Smoother::new(&mesh).unwrap().run(&Options::default()).on(&Backend::Cpu).block().unwrap();
    let owned = Smoother::new(&mesh).unwrap().into_owned();
    drop(mesh);
    let task = spawn(async move { owned.run(&Options::default()).on(&Backend::Cpu).block() });
    assert_same(&expected, &task.join().unwrap().unwrap());

    let owned = Smoother::new(&bad_plate(400)).unwrap().into_owned();
    let app = App::new();
    let gpu = app.another_gpu();
    let device = gpu.device().clone();
    let task = spawn(async move { owned.run(&Options::default()).on(&Backend::Gpu(gpu)).await });
    while !task.is_finished() {
        device.poll(wgpu::PollType::Poll).unwrap();
    }
    assert!(task.join().unwrap().unwrap().sweeps > 0);
}

#[test]
fn points_polled_by_the_application_are_those_read_by_blocking() {
    let mesh = bad_plate(600);
    let app = App::new();
    let device_mesh = app.mesh(&mesh);
    let mut sweeps = Sweeps::new(&device_mesh, &Options::default()).block().unwrap();
    app.submit(|encoder| sweeps.encode_sweeps(encoder, 5));
    let (found, frames) = drive(app.device(), device_mesh.read_points());
    assert!(frames > 0, "the future blocked the thread");
    assert_eq!(found.unwrap(), app.points(&device_mesh));
}

#[test]
fn another_thread_may_poll() {
    let mesh = bad_plate(600);
    let smoother = Smoother::new(&mesh).unwrap();
    let app = App::new();
    let on_app = Backend::Gpu(app.gpu.clone());
    let backend = Backend::Gpu(app.another_gpu());
    let [options, ..] = cases();
    let expected = smoother.run(&options).on(&backend).block().unwrap();
    let done = AtomicBool::new(false);
    let found = std::thread::scope(|scope| {
        scope.spawn(|| {
            while !done.load(Ordering::Relaxed) {
                app.device().poll(wgpu::PollType::Poll).unwrap();
                std::thread::sleep(Duration::from_micros(100));
            }
        });
        let found = pollster::block_on(smoother.run(&options).on(&on_app).into_future());
        done.store(true, Ordering::Relaxed);
        found
    });
    assert_same(&expected, &found.unwrap());
}

#[test]
fn two_runs_at_once_on_one_device_do_as_alone() {
    let meshes = [bad_plate(600), bad_plate(400)];
    let [first, second] = meshes.each_ref().map(|mesh| Smoother::new(mesh).unwrap());
    let [options, other, _] = cases();
    let app = App::new();
    let on_app = Backend::Gpu(app.gpu.clone());
    let backend = Backend::Gpu(app.another_gpu());
    let expected = [
        first.run(&options).on(&backend).block().unwrap(),
        second.run(&other).on(&backend).block().unwrap(),
    ];
    let (a, b) = (go_on, go_on);
    let mut futures = (
        pin!(first.run(&options).on(&on_app).observe(a).into_future()),
        pin!(second.run(&other).on(&on_app).observe(b).into_future()),
    );
    let mut found = (None, None);
    let both = std::future::poll_fn(|context| {
        if found.0.is_none()
            && let Poll::Ready(outcome) = futures.0.as_mut().poll(context)
        {
            found.0 = Some(outcome.unwrap());
        }
        if found.1.is_none()
            && let Poll::Ready(outcome) = futures.1.as_mut().poll(context)
        {
            found.1 = Some(outcome.unwrap());
        }
        if found.0.is_some() && found.1.is_some() { Poll::Ready(()) } else { Poll::Pending }
    });
    drive(app.device(), both);
    assert_same(&expected[0], &found.0.unwrap());
    assert_same(&expected[1], &found.1.unwrap());
}

#[test]
fn a_canceled_run_returns_the_best_state_so_far() {
    let mesh = bad_plate(600);
    let smoother = Smoother::new(&mesh).unwrap();
    let app = App::new();
    let on_app = Backend::Gpu(app.gpu.clone());
    for scheme in ["imr", "edge+imr"] {
        let options = Options::default()
            .scheme(scheme.parse().unwrap())
            .stopping(Stopping::Tolerance(0.0))
            .max_sweeps(100_000);
        let base = options.scheme.base();
        let mut heard = Vec::new();
        let mut observe = |progress: &Progress| {
            heard.push((progress.sweep, progress.f));
            if heard.len() < 2 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        };
        let (outcome, _) =
            drive(app.device(), smoother.run(&options).on(&on_app).observe(&mut observe));
        let outcome = outcome.unwrap();
        assert_eq!(outcome.stop, Stop::Canceled);
        assert_eq!(heard.len(), 2);
        assert_eq!(outcome.sweeps, heard[1].0);
        let f: Vec<f64> = outcome.history.iter().map(|o| o.of(base).unwrap()).collect();
        assert_eq!(heard[1].1, *f.last().unwrap());
        let least = f.iter().copied().fold(f64::INFINITY, f64::min);
        assert!(least < f[0]);
        let measured = Quality::of(&outcome.points, smoother.topology()).unwrap().f(base);
        assert!((measured / least - 1.0).abs() < 1e-6, "{measured} {least}");
    }
}

#[test]
fn a_dropped_run_leaves_the_device_usable() {
    let mesh = bad_plate(600);
    let smoother = Smoother::new(&mesh).unwrap();
    let app = App::new();
    let on_app = Backend::Gpu(app.gpu.clone());
    let [options, ..] = cases();
    let (expected, _) = drive(app.device(), smoother.run(&options).on(&on_app));
    let expected = expected.unwrap();
    let endless = Options::default().stopping(Stopping::Tolerance(0.0)).max_sweeps(u32::MAX);
    // Drops before the first poll, at the first wait, and later.
    for polls in [0, 1, 2, 7] {
        let observe = go_on;
        let mut future =
            Box::pin(smoother.run(&endless).on(&on_app).observe(observe).into_future());
        let mut context = Context::from_waker(Waker::noop());
        for _ in 0..polls {
            assert!(future.as_mut().poll(&mut context).is_pending());
            app.device().poll(wgpu::PollType::wait_indefinitely()).unwrap();
        }
        drop(future);
    }
    app.device().poll(wgpu::PollType::wait_indefinitely()).unwrap();
    let (found, _) = drive(app.device(), smoother.run(&options).on(&on_app));
    assert_same(&expected, &found.unwrap());
}
