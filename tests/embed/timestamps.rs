//! Times of kernels, measured by the device.

use std::collections::BTreeMap;
use std::future::Future;
use std::pin::pin;
use std::task::{Context, Poll, Waker};

use gpu_smooth::{
    GpuError, Mesh, Metric, Options, Smoother,
    gpu::{Kernel, Span, Sweeps, Timestamps},
    options::Derivatives,
};
use wgpu::BufferUsages as Usage;

use gpu_smooth::wgpu;

use crate::app::{App, Vertices, bad_plate};

/// Executes a frame of import, sweeps, objective and export with timestamps.
fn timed_frame(app: &App, mesh: &Mesh, timestamps: &mut Timestamps, count: u32) -> Vec<Span> {
    let device_mesh = app.mesh(mesh);
    let options = Options::default().scheme("edge+imr".parse().unwrap());
    let mut sweeps = Sweeps::new(&device_mesh, &options).block().unwrap();
    let bound = Vertices::usual(app, mesh).bind(&device_mesh);
    let objective = sweeps.bind_objective(app.buffer(128, Usage::STORAGE).slice(..)).unwrap();
    let mut encoder = app.encoder();
    let mut timed = timestamps.time(&mut encoder);
    bound.encode_import(&mut timed);
    sweeps.encode_sweeps(&mut timed, count);
    objective.encode_objective(&mut timed);
    bound.encode_export(&mut timed);
    let spans = timed.resolve().unwrap();
    app.gpu.queue().submit([encoder.finish()]);
    spans.read().block().unwrap()
}

#[test]
fn every_kernel_is_timed_in_the_order_of_encoding() {
    let (app, mesh) = (App::with_timestamps(), bad_plate(3000));
    let colors = Smoother::new(&mesh).unwrap().colors() as u32;
    let mut timestamps = Timestamps::new(&app.gpu).unwrap();
    let spans = timed_frame(&app, &mesh, &mut timestamps, 3);
    let mut expected = vec![(Kernel::Import, None)];
    for metric in [Metric::Edge, Metric::Imr, Metric::Edge] {
        let sweep = Kernel::Sweep(metric, Derivatives::Analytic);
        expected.extend((0..colors).map(|color| (sweep.clone(), Some(color))));
    }
    let judged = [Kernel::Objective(vec![Metric::Edge]), Kernel::Finish(vec![Metric::Edge])];
    expected.extend(
        judged.into_iter().chain([Kernel::WriteObjective, Kernel::Export]).map(|k| (k, None)),
    );
    let found: Vec<_> = spans.iter().map(|span| (span.kernel.clone(), span.color)).collect();
    assert_eq!(found, expected);

    assert_eq!(spans[0].start, 0.0);
    // Not a test of speed: a working device needs some time, but not minutes.
    let sum: f64 = spans.iter().map(|span| span.nanoseconds).sum();
    assert!(sum > 1e3 && sum < 60e9, "{sum} ns");
    let mut by_metric = BTreeMap::new();
    for span in &spans {
        *by_metric.entry(span.kernel.label()).or_insert(0.0) += span.nanoseconds;
    }
    assert!(by_metric["gpu-smooth sweep edge"] > 0.0 && by_metric["gpu-smooth sweep imr"] > 0.0);
    for pair in spans.windows(2) {
        assert!(pair[0].start + pair[0].nanoseconds <= pair[1].start, "{pair:?}");
    }
}

#[test]
fn more_kernels_than_a_query_set_holds_are_timed() {
    let (app, mesh) = (App::with_timestamps(), bad_plate(200));
    let colors = Smoother::new(&mesh).unwrap().colors();
    let mut timestamps = Timestamps::new(&app.gpu).unwrap();
    // Timestamps can be reused, for fewer and for more kernels.
    for count in [600, 2, 900] {
        let spans = timed_frame(&app, &mesh, &mut timestamps, count);
        assert_eq!(spans.len(), count as usize * colors + 5);
        let end = spans.last().unwrap();
        assert!(spans.iter().all(|span| span.start >= 0.0 && span.start <= end.start));
        assert!(end.start > 0.0);
    }
}

#[test]
fn timing_changes_nothing_else() {
    let (app, mesh) = (App::with_timestamps(), bad_plate(700));
    let mut timestamps = Timestamps::new(&app.gpu).unwrap();
    let [plain, timed, unresolved] = [0, 1, 2].map(|case| {
        let device_mesh = app.mesh(&mesh);
        let mut sweeps = Sweeps::new(&device_mesh, &Options::default()).block().unwrap();
        app.submit(|encoder| {
            if case == 0 {
                return sweeps.encode_sweeps(encoder, 9);
            }
            let mut timed = timestamps.time(encoder);
            sweeps.encode_sweeps(&mut timed, 9);
            // A call of the application in between: `timed` dereferences to the encoder.
            timed.push_debug_group("own");
            timed.pop_debug_group();
            if case == 1 {
                timed.resolve().unwrap();
            }
        });
        app.points(&device_mesh)
    });
    assert_eq!(plain, timed);
    assert_eq!(plain, unresolved);
}

#[test]
fn two_frames_in_flight_are_each_their_own() {
    let (app, mesh) = (App::with_timestamps(), bad_plate(2000));
    let colors = Smoother::new(&mesh).unwrap().colors();
    let device_mesh = app.mesh(&mesh);
    let mut sweeps = Sweeps::new(&device_mesh, &Options::default()).block().unwrap();
    let mut timestamps = Timestamps::new(&app.gpu).unwrap();
    let frames = [1, 30].map(|count| {
        let mut encoder = app.encoder();
        let mut timed = timestamps.time(&mut encoder);
        sweeps.encode_sweeps(&mut timed, count);
        let spans = timed.resolve().unwrap();
        app.gpu.queue().submit([encoder.finish()]);
        spans
    });
    let [first, second] = frames.map(|spans| {
        let mut future = pin!(spans.read().into_future());
        let mut context = Context::from_waker(Waker::noop());
        loop {
            if let Poll::Ready(spans) = future.as_mut().poll(&mut context) {
                return spans.unwrap();
            }
            app.device().poll(wgpu::PollType::Poll).unwrap();
        }
    });
    assert_eq!([first.len(), second.len()], [colors, 30 * colors]);
    let end = |spans: &[Span]| spans.last().map(|s| s.start + s.nanoseconds).unwrap();
    assert!(end(&first) > 0.0 && end(&first) < end(&second));
}

#[test]
fn an_empty_encoder_has_no_timed_kernels() {
    let app = App::with_timestamps();
    let mut timestamps = Timestamps::new(&app.gpu).unwrap();
    let mut encoder = app.encoder();
    let spans = timestamps.time(&mut encoder).resolve().unwrap();
    app.gpu.queue().submit([encoder.finish()]);
    assert_eq!(spans.read().block().unwrap(), []);
}

#[test]
fn a_device_without_a_clock_is_refused() {
    let app = App::new();
    let error = Timestamps::new(&app.gpu).err().unwrap();
    assert!(matches!(error, GpuError::Feature { feature: "TIMESTAMP_QUERY", .. }), "{error:?}");
    assert_eq!(error.to_string(), "timing needs a device made with the feature TIMESTAMP_QUERY");
}
