//! Times of whole sweeps, and the smallest number of bytes that a sweep can transfer.

use std::time::{Duration, Instant};

use gpu_smooth::{
    SmoothError,
    internal::{Problem, Stepwise},
};

/// Sweeps before timing starts. Afterwards, kernels are compiled, caches are warm and sweeps are over-relaxed.
const BEFORE: u32 = 6;
/// Intended duration of a batch. The sweeps of a batch are timed together.
const BATCH: Duration = Duration::from_millis(100);
/// Largest number of batches, of which the median counts. The time limit of the user may end the measurement
/// earlier.
const BATCHES: usize = 15;

/// Bytes of a position: two coordinates, each in double precision or as a pair of floats.
const POSITION: u64 = 16;

/// Counts the bytes that a sweep transfers if it touches all data once: positions, one-rings of free vertices, and
/// moved vertices.
pub(crate) fn sweep_bytes(problem: &Problem) -> u64 {
    let (vertices, free) = (problem.positions().len() as u64, problem.free_count() as u64);
    let rings = 4 * (problem.ring().len() as u64 + free);
    POSITION * (vertices + free) + rings
}

/// Counts the bytes that the objective transfers if it reads all positions and triangles once.
pub(crate) fn objective_bytes(problem: &Problem) -> u64 {
    POSITION * problem.positions().len() as u64 + 12 * problem.triangles().len() as u64
}

/// Returns the median duration of a sweep with the objective after it, in seconds.
pub(crate) fn time(engine: &mut dyn Stepwise, seconds: f64) -> Result<f64, SmoothError> {
    engine.advance(BEFORE)?;
    let mut timed = |sweeps: u32| -> Result<f64, SmoothError> {
        let start = Instant::now();
        engine.advance(sweeps)?;
        Ok(start.elapsed().as_secs_f64() / f64::from(sweeps))
    };
    let start = Instant::now();
    let first = timed(1)?;
    let batch = (BATCH.as_secs_f64() / first).clamp(1.0, 100.0) as u32;
    let mut times = Vec::new();
    while times.is_empty() || times.len() < BATCHES && start.elapsed().as_secs_f64() < seconds {
        times.push(timed(batch)?);
    }
    times.sort_by(f64::total_cmp);
    Ok(times[times.len() / 2])
}
