//! Meshes on which frames of sweeps are slow, and say too early that they have converged.

use std::fmt;

use crate::layout::Problem;

/// Number of neighbors of a free vertex up to which corrections serve. Around a vertex of 100, 200, 400 and 1,000 on meshes of 8,001
/// vertices, a corrected sweep took as long as 4.4, 4.6, 6.0 and 8.5 sweeps alone on Mesa's software driver.
const MOST_NEIGHBORS: u32 = 200;
/// Ratio of lengths along and across the triangles of a vertex, from which corrections of encoded sweeps do not pay. A plate of
/// 1,200 vertices stretched 2, 5 and 10-fold was within 1e-4 of the limit after 8, 21 and 28 corrected sweeps, or 27, 32 and 33
/// sweeps alone, and a corrected sweep takes as long as three to four.
const STRETCHED: f64 = 5.0;
/// Share of stretched vertices from which a mesh counts as stretched.
const SHARE: f64 = 0.25;

/// A reason why encoded sweeps on a mesh are slow, so that sweeps
/// [`until_converged`](crate::gpu::Sweeps::until_converged) may end farther from the limit of f than their tolerance: gains of
/// single sweeps become small long before the sum of all further gains is. A whole [run](crate::Smoother::run) ends by
/// Newton steps, which know what remains.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Doubt {
    /// A free vertex has more than 200 neighbors: this number.
    Hub(u32),
    /// A quarter of the vertices have triangles that are five times as long as they are wide, or longer. Targets transform the
    /// triangles before.
    Stretched,
}

impl fmt::Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Hub(neighbors) => write!(f, "a vertex has {neighbors} neighbors"),
            Self::Stretched => {
                write!(f, "a quarter of the vertices have triangles stretched fivefold or more")
            }
        }
    }
}

impl Doubt {
    /// Returns the doubt about sweeps on a mesh at the positions of the problem.
    pub(crate) fn of(problem: &Problem) -> Option<Self> {
        let free = 0..problem.free_count() as u32;
        let degrees = free.map(|v| problem.neighbors(v).count() as u32);
        match degrees.max() {
            Some(most) if most > MOST_NEIGHBORS => Some(Self::Hub(most)),
            _ => {
                let share = problem.share_stretched(problem.positions(), STRETCHED);
                (share >= SHARE).then_some(Self::Stretched)
            }
        }
    }
}
