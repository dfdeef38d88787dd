//! Durations for which an awaited run blocks its polling thread: the longest poll before the first
//! report to the observer, between reports, and after the last report, the sum of all polls, and
//! the longest poll of the device between them. Other programs delay polls, so each duration is
//! the least of three runs.
//!
//! `cargo bench --bench polls -- [VERTICES...]`, 2,000 to a million by default.

#![allow(clippy::print_stdout)]

use std::ops::ControlFlow;
use std::pin::pin;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::task::{Context, Poll, Waker};
use std::time::{Duration, Instant};

use gpu_smooth::options::WorstBy;
use gpu_smooth::{Backend, Gpu, Mesh, Method, Metric, Options, Progress, Smoother};

/// Number of runs of each case.
const RUNS: usize = 3;
/// Largest number of sweeps of a run without corrections.
const SWEEPS: u32 = 60;

/// Durations of a run in milliseconds.
struct Measured {
    names: [&'static str; 6],
    ms: [f64; 6],
    sweeps: u32,
    opening: u32,
}

fn main() {
    let sizes: Vec<usize> = std::env::args().filter_map(|arg| arg.parse().ok()).collect();
    let sizes = if sizes.is_empty() { vec![2000, 57_000, 200_000, 1_000_000] } else { sizes };
    let outline = support::Outline::parse(include_str!("../meshes/plate.outline")).unwrap();
    let gpu = Gpu::open(None).block().unwrap();
    println!("{}: milliseconds, least of {RUNS} runs", gpu.adapter().name);
    for vertices in sizes {
        let plate = support::triangulate(&outline, vertices).unwrap();
        let mesh = support::perturb_random(&plate, 1.0, 1);
        let flat = with_flat_triangle(&plate);
        let corrected = Options::default().method(Method::Multilevel);
        let alone = Options::default().method(Method::RELAXED).max_sweeps(SWEEPS);
        let edge = corrected.clone().scheme(Metric::Edge.into()).max_sweeps(SWEEPS);
        let improved = corrected.clone().improve_worst(Some(WorstBy::Imr));
        let cases = [
            ("corrected", &mesh, &corrected),
            ("sweeps alone", &mesh, &alone),
            ("edge", &mesh, &edge),
            ("opening", &flat, &corrected),
            ("improve_worst", &mesh, &improved),
        ];
        for (name, mesh, options) in cases {
            let smoother = Smoother::new(mesh).unwrap();
            let runs = (0..RUNS).map(|_| measured(&gpu, &smoother, options));
            let least = runs.reduce(|a, b| {
                let ms = std::array::from_fn(|i| a.ms[i].min(b.ms[i]));
                Measured { ms, ..b }
            });
            let Measured { names, ms, sweeps, opening } = least.unwrap();
            let listed = names.iter().zip(ms).map(|(name, ms)| format!("{name} {ms:.1}"));
            let listed = listed.collect::<Vec<_>>().join(", ");
            println!("{vertices:>7} {name} ({sweeps} sweeps, {opening} in f64): {listed}");
        }
    }
}

/// Runs to the end, and polls the device between polls of the run.
fn measured(gpu: &Gpu, smoother: &Smoother<'_>, options: &Options) -> Measured {
    let backend = Backend::Gpu(gpu.clone());
    let polled = AtomicUsize::new(0);
    let mut reports = Vec::new();
    let observe = |_: &Progress| {
        reports.push(polled.load(Ordering::Relaxed));
        ControlFlow::Continue(())
    };
    let start = Instant::now();
    let (mut polls, mut of_device) = (Vec::new(), Vec::new());
    let outcome = {
        let mut run = pin!(smoother.run(options).on(&backend).observe(observe).into_future());
        let mut context = Context::from_waker(Waker::noop());
        loop {
            let now = Instant::now();
            let ready = run.as_mut().poll(&mut context);
            polls.push(now.elapsed());
            polled.store(polls.len(), Ordering::Relaxed);
            if let Poll::Ready(outcome) = ready {
                break outcome.unwrap();
            }
            let now = Instant::now();
            gpu.device().poll(gpu_smooth::wgpu::PollType::Poll).unwrap();
            of_device.push(now.elapsed());
        }
    };
    let ms = |time: Duration| time.as_secs_f64() * 1e3;
    let longest = |times: &[Duration]| ms(times.iter().copied().max().unwrap_or_default());
    // The poll of a report counts as one between reports.
    let first = reports.first().copied().unwrap_or(0);
    let last = reports.last().map_or(0, |last| last + 1);
    Measured {
        names: [
            "whole run",
            "all polls",
            "longest at the start",
            "longest between reports",
            "longest at the end",
            "longest of the device",
        ],
        ms: [
            ms(start.elapsed()),
            ms(polls.iter().sum()),
            longest(&polls[..first]),
            longest(&polls[first..last]),
            longest(&polls[last..]),
            longest(&of_device),
        ],
        sweeps: outcome.sweeps,
        opening: outcome.opening_sweeps,
    }
}

/// Returns a mesh in which a vertex is almost on the opposite edge of one of its triangles.
fn with_flat_triangle(mesh: &Mesh) -> Mesh {
    let mut mesh = mesh.clone();
    let free = gpu_smooth::Topology::new(&mesh).unwrap().free().to_vec();
    let at = mesh.triangles.len() / 2;
    let triangle = (at..).map(|t| mesh.triangles[t]).find(|t| t.iter().all(|&v| free[v as usize]));
    let [v, a, b] = triangle.unwrap().map(|v| v as usize);
    let [p, q, r] = [v, a, b].map(|v| mesh.points[v]);
    let share = 1.0 - 1e-7;
    mesh.points[v] = std::array::from_fn(|i| p[i] + share * (0.5 * (q[i] + r[i]) - p[i]));
    mesh
}
