//! Fits the sweeps of a frame into a time budget.

use std::collections::VecDeque;
use std::time::Duration;

use wgpu::BufferUsages as Usage;

use crate::error::GpuError;
use crate::gpu::device::Gpu;
use crate::gpu::device::buffers::zeroed;
use crate::gpu::embed::Readback;
use crate::gpu::scope::{check_alive, scoped};

/// A limit on the device's time for sweeps in each frame. Times of earlier frames determine the number of sweeps in the
/// next frame: at least one sweep, and at most double the last measured frame's sweeps.
///
/// With [`timed_by`](Self::timed_by), the device measures, and
/// [`Sweeps::encode_within`](crate::gpu::Sweeps::encode_within) chooses, encodes and records. If the device has no
/// timestamps, the application measures and calls [`record`](Self::record).
///
/// ```
/// # use std::time::Duration;
/// use gpu_smooth::gpu::Budget;
///
/// let mut budget = Budget::micros(500);
/// assert_eq!(budget.sweeps(), 1);
/// // Two sweeps took 80 µs.
/// budget.record(2, Duration::from_micros(80));
/// assert_eq!(budget.sweeps(), 4);
/// budget.record(4, Duration::from_micros(160));
/// budget.record(8, Duration::from_micros(320));
/// assert_eq!(budget.sweeps(), 12);
/// ```
#[derive(Debug)]
pub struct Budget {
    time: Duration,
    most: u32,
    /// Seconds per sweep in the last measured frames, as a ring buffer.
    measured: [f64; FRAMES],
    /// Number of measured frames, including overwritten ones.
    count: usize,
    /// Number of sweeps in the last measurement.
    last: u32,
    pub(crate) clock: Option<Clock>,
}

/// Number of measured frames that the estimate uses. The estimate is the time per sweep in the second slowest frame.
/// This rule prefers too few sweeps to a late frame, but ignores a single late frame, such as the first frame of a
/// driver.
const FRAMES: usize = 6;
/// Default limit of the sweeps in a frame; see [`Budget::at_most`].
const DEFAULT_MAX_SWEEPS: u32 = 100;

impl Budget {
    /// Creates a budget of `micros` microseconds for each frame.
    pub fn micros(micros: u64) -> Self {
        Self::new(Duration::from_micros(micros))
    }

    /// Creates a budget of `time` for the sweeps of each frame.
    pub fn new(time: Duration) -> Self {
        Self {
            time,
            most: DEFAULT_MAX_SWEEPS,
            measured: [0.0; FRAMES],
            count: 0,
            last: 1,
            clock: None,
        }
    }

    /// Sets the limit of the sweeps in a frame, whatever the budget. The default is 100, and 0 counts as 1.
    pub fn at_most(self, sweeps: u32) -> Self {
        Self { most: sweeps.max(1), ..self }
    }

    /// Lets the device measure the sweeps of [`Sweeps::encode_within`](crate::gpu::Sweeps::encode_within) by
    /// timestamps, which are read without waiting, a frame or two later.
    ///
    /// # Errors
    /// [`GpuError::Feature`] if the device was created without `TIMESTAMP_QUERY`; see [`Gpu::optional_features`].
    /// Another [`GpuError`] if the device fails.
    pub fn timed_by(self, gpu: &Gpu) -> Result<Self, GpuError> {
        let clock = Some(Clock::new(gpu)?);
        check_alive(&gpu.device)?;
        Ok(Self { clock, ..self })
    }

    /// Returns the number of sweeps for which the next frame has time; 1 before the first measurement.
    pub fn sweeps(&self) -> u32 {
        let Some(each) = self.seconds() else { return 1 };
        // A float too large for an integer becomes the largest one.
        let fit = (self.time.as_secs_f64() / each) as u32;
        fit.min(self.last.saturating_mul(2)).clamp(1, self.most)
    }

    /// Records a measurement: `sweeps` sweeps took `time`. A frame with 0 sweeps is ignored. Exclude sweeps
    /// [`until_converged`](crate::gpu::Sweeps::until_converged) that had already ended, as such sweeps take no time.
    pub fn record(&mut self, sweeps: u32, time: Duration) {
        if sweeps == 0 {
            return;
        }
        self.measured[self.count % FRAMES] = time.as_secs_f64() / f64::from(sweeps);
        self.count = self.count.saturating_add(1);
        self.last = sweeps;
    }

    /// Returns the expected time of a sweep in seconds; `None` before the first measurement.
    fn seconds(&self) -> Option<f64> {
        let mut measured = self.measured;
        let measured = &mut measured[..self.count.min(FRAMES)];
        measured.sort_unstable_by(f64::total_cmp);
        measured.get(measured.len().saturating_sub(2)).copied()
    }

    /// Returns the expected time of a sweep; `None` before the first measurement. A time too long for a [`Duration`]
    /// is returned as [`Duration::MAX`].
    pub fn estimate(&self) -> Option<Duration> {
        let time = |seconds| Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX);
        self.seconds().map(time)
    }

    /// Records the latest measurement by the device, if there is a new one.
    pub(crate) fn collect(&mut self) {
        if let Some((sweeps, time)) = self.clock.as_mut().and_then(Clock::measured) {
            self.record(sweeps, time);
        }
    }
}

/// Measures the sweeps of each frame by the device's clock.
#[derive(Debug)]
pub(crate) struct Clock {
    queries: wgpu::QuerySet,
    /// Timestamps before and after the sweeps, and a word that is nonzero if the sweeps had ended by the stop rule.
    times: wgpu::Buffer,
    readback: Readback<[u64; 3]>,
    /// Copies in flight, as pairs of a copy's number and the number of measured sweeps.
    measuring: VecDeque<(u64, u32)>,
    taken: Option<u64>,
    /// Duration of a clock tick, in seconds.
    period: f64,
}

impl Clock {
    fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        if !gpu.device.features().contains(wgpu::Features::TIMESTAMP_QUERY) {
            return Err(GpuError::Feature { what: "timing", feature: "TIMESTAMP_QUERY" });
        }
        let (queries, times) = scoped(&gpu.device, || {
            let queries = gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("gpu-smooth budget"),
                ty: wgpu::QueryType::Timestamp,
                count: 2,
            });
            let usage = Usage::QUERY_RESOLVE | Usage::COPY_SRC | Usage::COPY_DST;
            (queries, zeroed(gpu, "budget", size_of::<[u64; 3]>() as u64, usage))
        })?;
        let readback = Readback::new(gpu, times.slice(..), 1)?;
        let period = 1e-9 * f64::from(gpu.queue.get_timestamp_period());
        let (measuring, taken) = (VecDeque::with_capacity(8), None);
        Ok(Self { queries, times, readback, measuring, taken, period })
    }

    /// Returns the queries to which the pass of the sweeps writes its times.
    pub(crate) fn writes(&self) -> wgpu::ComputePassTimestampWrites<'_> {
        wgpu::ComputePassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: Some(0),
            end_of_pass_write_index: Some(1),
        }
    }

    /// Encodes the readback of the times, after the pass of the sweeps. The first word of `control` is nonzero if the
    /// sweeps have ended.
    pub(crate) fn encode(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        control: &wgpu::Buffer,
        sweeps: u32,
    ) {
        encoder.resolve_query_set(&self.queries, 0..2, &self.times, 0);
        encoder.copy_buffer_to_buffer(control, 0, &self.times, 16, 4);
        if let Some(number) = self.readback.encode(encoder) {
            self.measuring.push_back((number, sweeps));
        }
    }

    /// Returns the sweeps and time of the latest measurement, once. `None` for a lost device, and for sweeps that had
    /// ended by the stop rule, as they took no time.
    fn measured(&mut self) -> Option<(u32, Duration)> {
        let &[[start, end, ended]] = self.readback.latest_unchecked()? else { return None };
        let number = self.readback.arrived().filter(|&number| self.taken != Some(number))?;
        self.taken = Some(number);
        self.measuring.retain(|&(older, _)| older >= number);
        let &(_, sweeps) = self.measuring.front().filter(|(first, _)| *first == number)?;
        // Clocks of devices are known to jump back now and then.
        let seconds = end.checked_sub(start)? as f64 * self.period;
        (ended == 0).then_some((sweeps, Duration::try_from_secs_f64(seconds).ok()?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Simulates frames on a device where a frame takes a constant time plus a time for each sweep, and returns the
    /// sweeps of the frame after them.
    fn settle(budget: &mut Budget, constant: f64, each: f64, frames: u32) -> u32 {
        for _ in 0..frames {
            let sweeps = budget.sweeps();
            let micros = constant + each * f64::from(sweeps);
            budget.record(sweeps, Duration::from_secs_f64(1e-6 * micros));
        }
        budget.sweeps()
    }

    #[test]
    fn the_budget_is_used_and_kept() {
        for (constant, each, expected) in [(0.0, 40.0, 12), (60.0, 40.0, 11), (0.0, 3000.0, 1)] {
            let mut budget = Budget::micros(500);
            assert_eq!(budget.sweeps(), 1);
            let sweeps = settle(&mut budget, constant, each, 60);
            assert!(sweeps.abs_diff(expected) <= 1, "{sweeps} for {expected}");
            assert!(sweeps == 1 || constant + each * f64::from(sweeps) <= 500.0);
        }
        let mut budget = Budget::micros(1_000_000).at_most(7);
        assert_eq!(settle(&mut budget, 0.0, 1.0, 20), 7);
        // A budget without any time.
        let mut budget = Budget::micros(0);
        assert_eq!(settle(&mut budget, 0.0, 1.0, 5), 1);
        let mut budget = Budget::micros(500);
        budget.record(1, Duration::ZERO);
        assert_eq!(budget.sweeps(), 2);
    }

    #[test]
    fn the_longest_measurable_time_is_estimated() {
        for sweeps in [1, u32::MAX] {
            let mut budget = Budget::micros(1000);
            budget.record(sweeps, Duration::MAX);
            let expected = Duration::MAX.as_secs_f64() / f64::from(sweeps);
            let estimate = budget.estimate().unwrap().as_secs_f64();
            assert!((estimate / expected - 1.0).abs() < 1e-9, "{estimate} {expected}");
            assert_eq!(budget.sweeps(), 1);
        }
    }

    #[test]
    fn slower_sweeps_count_sooner_than_faster_ones() {
        let mut budget = Budget::micros(1000);
        assert_eq!(settle(&mut budget, 0.0, 20.0, 40), 50);
        assert_eq!(settle(&mut budget, 0.0, 100.0, 2), 10);
        assert_eq!(settle(&mut budget, 0.0, 20.0, 4), 10);
        assert_eq!(settle(&mut budget, 0.0, 20.0, 4), 50);
        // Neither a single late frame nor a frame without sweeps changes the estimate.
        budget.record(50, Duration::from_secs(1));
        budget.record(0, Duration::from_secs(1));
        assert_eq!(budget.sweeps(), 50);
    }
}
