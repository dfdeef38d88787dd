//! Constants of the line search and of Newton steps, common to both engines and injected into WGSL.

/// Share of the predicted decrease that must be had (Armijo).
pub(crate) const SUFFICIENT_DECREASE: f64 = 1e-4;
/// What rounding in single precision may add to a patch's objective, relative to the sum of q².
/// The f64 engine grants it too, so that both accept the same steps.
pub(crate) const SLACK: f64 = 1e-6;
/// Trials before the vertex is left where it is.
pub(crate) const TRIALS: u32 = 8;
/// Shortening after a trial that inverts a triangle or breaks the shape guard.
pub(crate) const SHORTEN_INFEASIBLE: f64 = 0.25;
/// Shortening after a trial that does not decrease the objective enough.
pub(crate) const SHORTEN: f64 = 0.5;
/// Share of the shape guard kept in reserve, so that a triangle let through in single precision is
/// within the guard in exact arithmetic as well.
pub(crate) const GUARD_RESERVE: f64 = 1e-3;
/// A visit of several steps ends with one shorter than this share of an edge of the patch. Not so by
/// differences: their gradient does not vanish where the objective is least, and Mesquite, which
/// they imitate, goes on to the last step it is granted.
pub(crate) const SETTLED: f64 = 1e-4;
/// Step of forward differences, relative to the vertex's least height over a ring edge. Large
/// enough for the second differences to survive single precision.
pub(crate) const DIFFERENCE: f64 = 1e-2;
/// The 16 displacements of Mesquite's forward differences, in steps: the value and the three
/// first differences at the vertex, and the same again one step along each axis. A planar
/// mesh has no use for those along z, but they are paid for all the same.
pub(crate) const DISPLACEMENTS: [[u32; 2]; 16] = [
    [0, 0],
    [1, 0],
    [0, 1],
    [0, 0],
    [1, 0],
    [2, 0],
    [1, 1],
    [1, 0],
    [0, 1],
    [1, 1],
    [0, 2],
    [0, 1],
    [0, 0],
    [1, 0],
    [0, 1],
    [0, 0],
];
