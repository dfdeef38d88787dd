//! Constants of Newton steps and their line search, the same for both engines and injected into WGSL.

/// Share of the predicted decrease that a trial must reach (Armijo).
pub(crate) const SUFFICIENT_DECREASE: f64 = 1e-4;
/// How much rounding in single precision may add to a patch's objective, relative to the sum of q².
/// The CPU engine allows for it too, so that both engines accept the same steps.
pub(crate) const SLACK: f64 = 1e-6;
/// Number of trials after which the vertex stays where it is.
pub(crate) const TRIALS: u32 = 8;
/// Factor on the step length after a trial that inverts a triangle or breaks the shape guard.
pub(crate) const SHORTEN_INFEASIBLE: f64 = 0.25;
/// Factor on the step length after a trial that does not decrease the objective enough.
pub(crate) const SHORTEN: f64 = 0.5;
/// Share of the shape guard kept in reserve, so that a triangle that passes in single precision
/// also passes in exact arithmetic.
pub(crate) const GUARD_RESERVE: f64 = 1e-3;
/// A visit of several steps ends after a step shorter than this share of an edge of the patch. With finite differences
/// it does all steps: their gradient does not vanish at the minimum of the objective, and Mesquite, which they imitate,
/// does so too.
pub(crate) const SETTLED: f64 = 1e-4;
/// Step of forward differences, relative to the least distance of the vertex from an edge of its one-ring. Large
/// enough for second differences in single precision.
pub(crate) const DIFFERENCE: f64 = 1e-2;
/// The 16 displacements of Mesquite's forward differences, in steps along x and y: four points for the value and the
/// three first differences at the vertex, then four points each for the vertex displaced by one step along x, y and z.
/// A planar mesh does not need those along z. Mesquite computes them all the same, and the cost model counts them.
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
