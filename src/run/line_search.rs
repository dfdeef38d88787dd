//! Constants of a sweep's visits, common to CPU and GPU. [`SearchRule::SWEEP`](crate::patch::SearchRule) has the
//! constants of the line search.

/// The most that steps are longer in runs with corrections from coarser levels. Longer ones were tried in vain more often.
pub(crate) const LONGEST: f64 = 8.0;
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
