//! Durations for which an awaited run blocks its polling thread: the longest poll, the sum of all
//! polls, and the longest poll of the device between them.
//!
//! `cargo bench --bench polls -- [VERTICES...]`, 2,000 and 57,000 by default.

#![allow(clippy::print_stdout)]

#[path = "../tests/support/mod.rs"]
mod support;

use std::pin::pin;
use std::task::{Context, Poll, Waker};
use std::time::{Duration, Instant};

use gpu_smooth::{Backend, Gpu, Method, Options, Smoother};

fn main() {
    let sizes: Vec<usize> = std::env::args().filter_map(|arg| arg.parse().ok()).collect();
    let sizes = if sizes.is_empty() { vec![2000, 57_000] } else { sizes };
    let outline = support::Outline::parse(include_str!("../meshes/plate.outline")).unwrap();
    let gpu = Gpu::open(None).unwrap();
    let backend = Backend::Gpu(gpu.clone());
    println!("{}: milliseconds", gpu.adapter().name);
    for vertices in sizes {
        let plate = support::triangulate(&outline, vertices).unwrap();
        let mesh = support::perturb_random(&plate, 1.0, 1);
        let smoother = Smoother::new(&mesh).unwrap();
        for method in [Method::Multilevel, Method::RELAXED] {
            let options = Options { method, ..Options::default() };
            let start = Instant::now();
            let mut run = pin!(smoother.run(&options).on(&backend).into_future());
            let mut context = Context::from_waker(Waker::noop());
            let (mut polls, mut of_device) = (Vec::new(), Vec::new());
            let timed = |times: &mut Vec<Duration>, from: Instant| times.push(from.elapsed());
            let outcome = loop {
                let now = Instant::now();
                let polled = run.as_mut().poll(&mut context);
                timed(&mut polls, now);
                if let Poll::Ready(outcome) = polled {
                    break outcome.unwrap();
                }
                let now = Instant::now();
                gpu.device().poll(wgpu::PollType::Poll).unwrap();
                timed(&mut of_device, now);
            };
            let ms = |time: Duration| time.as_secs_f64() * 1e3;
            let most = |times: &[Duration]| ms(times.iter().copied().max().unwrap_or_default());
            println!(
                "{vertices:>7} {method:?}: {:.0} in all for {} sweeps; longest poll {:.1}, all polls {:.0}; longest of the device {:.1}",
                ms(start.elapsed()),
                outcome.sweeps,
                most(&polls),
                ms(polls.iter().sum()),
                most(&of_device),
            );
        }
    }
}
