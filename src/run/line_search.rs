//! Constants of Newton steps and their line search, the same for both engines and injected into WGSL.

/// Share of the predicted decrease that a trial must reach (Armijo).
pub(crate) const SUFFICIENT_DECREASE: f64 = 1e-4;
/// How much rounding in single precision may add to a patch's objective, relative to the sum of q².
/// The CPU engine allows for it too, so that both engines accept the same steps.
pub(crate) const SLACK: f64 = 1e-6;
/// Where nearly flat triangles make up the objective E of a patch, E goes as 1/d² with their altitude d, and a Newton step makes d
/// larger by a third at most. Steps there are for -E^(1 - BENT) instead: it has the same minima, is nearly linear in d, and
/// its Newton step goes in the same direction, 1 / (1 - BENT r) times as far, with r = gᵀH⁻¹g / E.
pub(crate) const BENT: f64 = 1.4;
/// The least r from which steps are so long. It is 2/3 for 1/d², and at most a half for 1/d.
pub(crate) const MOSTLY_FLAT: f64 = 0.6;
/// The least sum of q² around a vertex from which steps are so long: a triangle has an inverse mean ratio of a thousand. Less flat
/// ones open in a few steps of Newton's own length.
pub(crate) const LEAST_FLAT: f64 = 1e6;
/// The most that steps are longer in runs with corrections from coarser levels. Longer ones were tried in vain more often.
pub(crate) const LONGEST: f64 = 8.0;
/// The least share of its coordinates that a vertex is first moved out of a nearly flat triangle on the CPU: 128 times what they are rounded to.
/// A device is given no triangles so flat.
pub(crate) const LEAST_MOVE: f64 = 1.0 / (1u64 << 46) as f64;
/// Number of trials after which the vertex is left where it is.
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
