//! Whole sweeps, and the least each has to read and write.

use std::time::{Duration, Instant};

use gpu_smooth::SmoothError;
use gpu_smooth::internal::{Problem, Stepwise};

/// Sweeps before the clock starts: kernels are compiled, caches warm, over-relaxation begun.
const BEFORE: u32 = 6;
/// Sweeps timed at once take about this long,
const BATCH: Duration = Duration::from_millis(100);
/// and of so many such times the median counts, within the seconds the user gives.
const BATCHES: usize = 15;

/// Bytes of a position, in double precision or as two floats a coordinate.
const POSITION: u64 = 16;

/// Bytes that a sweep reads and writes if it touches everything once and nothing twice: all positions, the
/// one-rings of the free vertices, and what moved.
pub(crate) fn sweep_bytes(problem: &Problem) -> u64 {
    let (vertices, free) = (problem.positions().len() as u64, problem.free_count() as u64);
    let rings = 4 * (problem.ring().len() as u64 + free);
    POSITION * (vertices + free) + rings
}

/// The same for the objective: all positions and triangles.
pub(crate) fn objective_bytes(problem: &Problem) -> u64 {
    POSITION * problem.positions().len() as u64 + 12 * problem.triangles().len() as u64
}

/// The median time of a sweep with the objective after it, in seconds.
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
