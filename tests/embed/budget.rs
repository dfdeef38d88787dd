//! Time budgets, which determine the number of sweeps in a frame.

use std::time::Duration;

use gpu_smooth::{
    Options,
    gpu::{Budget, Sweeps},
    wgpu,
};

use crate::app::{App, bad_plate};

/// Executes frames within a budget, one after another. Returns the number of sweeps in each frame.
fn frames(app: &App, sweeps: &mut Sweeps, budget: &mut Budget, count: usize) -> Vec<u32> {
    let frame = |_| {
        let mut encoder = app.encoder();
        let encoded = sweeps.encode_within(&mut encoder, budget);
        app.gpu.queue().submit([encoder.finish()]);
        app.device().poll(wgpu::PollType::wait_indefinitely()).unwrap();
        encoded
    };
    (0..count).map(frame).collect()
}

#[test]
fn the_device_measures_how_many_sweeps_fit() {
    let app = App::with_timestamps();
    let mesh = bad_plate(2000);
    let device_mesh = app.mesh(&mesh);
    let mut sweeps = Sweeps::new(&device_mesh, &Options::default()).block().unwrap();
    let ample = Budget::new(Duration::from_secs(3600)).at_most(16);
    let mut ample = ample.timed_by(&app.gpu).unwrap();
    assert_eq!(frames(&app, &mut sweeps, &mut ample, 6), [1, 2, 4, 8, 16, 16]);
    let each = ample.estimate().unwrap();
    assert!(each > Duration::from_nanos(100) && each < Duration::from_secs(10), "{each:?}");
    let mut scant = Budget::micros(0).timed_by(&app.gpu).unwrap();
    assert_eq!(frames(&app, &mut sweeps, &mut scant, 4), [1; 4]);
    // Without measured times, a frame has one sweep.
    let mut untimed = Budget::new(Duration::from_secs(3600));
    assert_eq!(frames(&app, &mut sweeps, &mut untimed, 3), [1; 3]);
    untimed.record(1, Duration::from_millis(1));
    assert_eq!(frames(&app, &mut sweeps, &mut untimed, 1), [2]);
}

/// Ended sweeps do nothing and take no time. Measurements of ended sweeps would let the number of sweeps grow until the
/// mesh changes.
#[test]
fn sweeps_that_have_ended_are_not_measured() {
    let app = App::with_timestamps();
    let device_mesh = app.mesh(&bad_plate(300));
    let options = Options::default().max_sweeps(3);
    let mut sweeps = Sweeps::until_converged(&device_mesh, &options).block().unwrap();
    let budget = Budget::new(Duration::from_secs(3600));
    let mut budget = budget.timed_by(&app.gpu).unwrap();
    assert_eq!(frames(&app, &mut sweeps, &mut budget, 6), [1, 2, 2, 2, 2, 2]);
}

#[test]
fn a_device_without_a_clock_is_refused() {
    let app = App::new();
    let error = Budget::micros(500).timed_by(&app.gpu).unwrap_err();
    assert_eq!(error.to_string(), "timing needs a device made with the feature TIMESTAMP_QUERY");
}
