//! The bounds of free vertices on a device: discs behind the positions, with reserves for single precision.

use glam::DVec2;

use crate::gpu::kernels::uniforms::split;
use crate::layout::Problem;
use crate::run::multilevel::NONE;

/// Share by which radii are smaller than on the CPU, more than the error of a point of the circle in single precision.
pub(super) const RESERVE: f64 = 1e-6;
/// Rounding error of a pair of floats, relative to its value, with a margin.
const PAIR_ROUNDING: f64 = 1.0 / (1u64 << 46) as f64;

/// Returns the number of rows in the buffer of positions: positions, maps, and two rows for each disc.
pub(crate) fn rows(problem: &Problem) -> usize {
    first_row(problem) + 2 * problem.radii().map_or(0, <[_]>::len)
}

/// Returns the number of rows before the discs.
fn first_row(problem: &Problem) -> usize {
    problem.positions().len() + problem.maps().map_or(0, <[_]>::len)
}

/// Returns the index of the first row of discs in the buffer of positions; [`NONE`] without discs.
pub(crate) fn first_disc(problem: &Problem) -> u32 {
    problem.radii().map_or(NONE, |_| first_row(problem) as u32)
}

/// Returns the rows of the discs: the center of each free vertex as pairs of floats, and then the radius.
pub(crate) fn discs(problem: &Problem) -> Vec<[f32; 4]> {
    let discs = problem.radii().unwrap_or_default().iter().zip(problem.positions());
    let of = |(&radius, &center): (&f64, &DVec2)| {
        let rounding = center.abs().max_element() * PAIR_ROUNDING;
        let radius = (radius * (1.0 - RESERVE) - rounding).max(0.0);
        [split(center), [radius as f32, 0.0, 0.0, 0.0]]
    };
    discs.flat_map(of).collect()
}
