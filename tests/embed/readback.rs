//! Buffers read in each frame without waiting.

use gpu_smooth::{
    GpuError, Options,
    gpu::{ObjectiveValues, Readback, Sweeps},
    wgpu,
};
use wgpu::BufferUsages as Usage;

use crate::app::{App, Vertices, bad_plate};

fn wait(app: &App) {
    app.device().poll(wgpu::PollType::wait_indefinitely()).unwrap();
}

#[test]
fn the_latest_values_are_those_of_the_last_frame_that_is_done() {
    let app = App::new();
    let mesh = bad_plate(300);
    let device_mesh = app.mesh(&mesh);
    let mut sweeps = Sweeps::new(&device_mesh, &Options::default()).block().unwrap();
    let numbers =
        app.buffer(8 + size_of::<ObjectiveValues>() as u64, Usage::STORAGE | Usage::COPY_SRC);
    let objective = sweeps.bind_objective(numbers.slice(8..)).unwrap();
    let vertices = Vertices::usual(&app, &mesh);
    let bound = vertices.bind(&device_mesh);
    let mut values = Readback::<ObjectiveValues>::new(&app.gpu, numbers.slice(8..), 1).unwrap();
    let count = mesh.points.len();
    let mut positions =
        Readback::<[f32; 3]>::new(&app.gpu, vertices.buffer.slice(..), count).unwrap();
    assert!(values.latest().unwrap().is_none() && values.age().is_none());
    let mut seen = Vec::new();
    for frame in 0..8 {
        app.submit(|encoder| {
            sweeps.encode_sweeps(encoder, 1);
            objective.encode_objective(encoder);
            bound.encode_export(encoder);
            values.encode_readback(encoder);
            positions.encode_readback(encoder);
        });
        wait(&app);
        let &[found] = values.latest().unwrap().unwrap() else { panic!("one") };
        assert_eq!(values.age(), Some(0));
        assert_eq!(found, app.objective(&sweeps), "frame {frame}");
        seen.push(found.f);
        let expected: Vec<u32> = app.read(&vertices.buffer);
        let found = positions.latest().unwrap().unwrap();
        assert!(bytemuck::cast_slice::<_, u32>(found) == expected, "frame {frame}");
    }
    assert!(seen.windows(2).all(|pair| pair[0] != pair[1]));
}

#[test]
fn a_device_that_is_behind_gets_no_more_copies_and_nothing_waits() {
    let app = App::new();
    let buffer = app.buffer(4, Usage::COPY_DST | Usage::COPY_SRC);
    let mut readback = Readback::<u32>::new(&app.gpu, buffer.slice(..), 1).unwrap();
    app.gpu.queue().write_buffer(&buffer, 0, &7_u32.to_le_bytes());
    // No copy arrives before the submission.
    let mut encoder = app.encoder();
    let copied: Vec<bool> = (0..10).map(|_| readback.encode_readback(&mut encoder)).collect();
    assert_eq!(copied, [vec![true; 3], vec![false; 7]].concat());
    assert_eq!(readback.latest().unwrap(), None);
    app.gpu.queue().submit([encoder.finish()]);
    wait(&app);
    assert_eq!(readback.latest().unwrap(), Some(&[7][..]));
    // Refused copies count, as the values are those of a frame before them.
    assert_eq!(readback.age(), Some(7));
    app.submit(|encoder| assert!(readback.encode_readback(encoder)));
    assert_eq!(readback.age(), Some(8));
    wait(&app);
    assert_eq!(readback.latest().unwrap(), Some(&[7][..]));
    assert_eq!(readback.age(), Some(0));
}

/// A former defect: copies that had arrived held their staging buffers until `latest` was called, so that later copies
/// were refused, and `latest` returned the oldest values with age 0.
#[test]
fn the_latest_values_are_new_although_nobody_asked_for_earlier_ones() {
    let app = App::new();
    let buffer = app.buffer(4, Usage::COPY_DST | Usage::COPY_SRC);
    let mut readback = Readback::<u32>::new(&app.gpu, buffer.slice(..), 1).unwrap();
    for number in 1..=60_u32 {
        app.gpu.queue().write_buffer(&buffer, 0, &number.to_le_bytes());
        let mut is_copied = false;
        app.submit(|encoder| is_copied = readback.encode_readback(encoder));
        wait(&app);
        assert!(is_copied, "copy {number}");
        if number % 20 == 7 {
            assert_eq!(readback.latest().unwrap(), Some(&[number][..]));
            assert_eq!(readback.age(), Some(0));
        }
    }
    // The values that were returned in frame 47 are 13 copies old, although newer ones have arrived.
    assert_eq!(readback.age(), Some(13));
}

#[test]
fn an_encoder_that_is_dropped_takes_no_copy_with_it() {
    let app = App::new();
    let buffer = app.buffer(8, Usage::STORAGE | Usage::COPY_SRC);
    let mut readback = Readback::<[u32; 2]>::new(&app.gpu, buffer.slice(..), 1).unwrap();
    for _ in 0..10 {
        let mut encoder = app.encoder();
        readback.encode_readback(&mut encoder);
        drop(encoder.finish());
        readback.encode_readback(&mut app.encoder());
    }
    wait(&app);
    assert_eq!(readback.latest().unwrap(), None);
    app.submit(|encoder| {
        readback.encode_readback(encoder);
    });
    wait(&app);
    assert_eq!(readback.latest().unwrap(), Some(&[[0, 0]][..]));
}

#[test]
fn a_readback_reports_a_lost_device() {
    let app = App::new();
    let buffer = app.buffer(4, Usage::COPY_SRC);
    let mut readback = Readback::<u32>::new(&app.gpu, buffer.slice(..), 1).unwrap();
    app.submit(|encoder| {
        readback.encode_readback(encoder);
    });
    app.device().destroy();
    let _ = app.device().poll(wgpu::PollType::Poll);
    app.submit(|encoder| {
        readback.encode_readback(encoder);
    });
    let _ = app.device().poll(wgpu::PollType::Poll);
    assert!(matches!(readback.latest(), Err(GpuError::Lost(_))));
    app.take_uncaptured();
}

#[test]
fn readbacks_of_wrong_buffers_and_ranges_are_refused() {
    let (app, other) = (App::new(), App::new());
    let usage = Usage::COPY_SRC;
    let refused = |values: wgpu::BufferSlice<'_>, count, part: &str| {
        let error = Readback::<f32>::new(&app.gpu, values, count).err().unwrap();
        assert!(matches!(error, GpuError::Buffer(_)), "{error:?}");
        assert!(error.to_string().contains(part), "{error}");
    };
    let good = app.buffer(16, usage);
    refused(app.buffer(16, Usage::STORAGE).slice(..), 1, "needs COPY_SRC as well");
    refused(good.slice(4..), 4, "it has 12 bytes from byte 4 on, and 16 are needed");
    refused(good.slice(..12), 4, "it has 12 bytes from byte 0 on, and 16 are needed");
    refused(good.slice(..), usize::MAX, "bytes");
    refused(good.slice(2..), 1, "must be multiples of 4");
    refused(good.slice(..), 0, "must be multiples of 4");
    refused(other.buffer(16, usage).slice(..), 1, "belongs to another device");
}
