//! Constants of a sweep's visits, common to CPU and GPU. [`SearchRule::SWEEP`](crate::patch::SearchRule) has the
//! constants of the line search.

/// Largest factor by which steps are lengthened in runs with corrections from coarser levels. Trials of longer steps
/// failed more often.
pub(crate) const LONGEST: f64 = 8.0;
/// Share of the shape guard kept in reserve, so that a triangle that passes in single precision also passes in exact
/// arithmetic.
pub(crate) const GUARD_RESERVE: f64 = 1e-3;
/// Length of a step, as a share of an edge of the patch, below which a visit of several steps ends. With finite
/// differences, a visit does all steps. Their gradient does not vanish at the minimum of the objective, and Mesquite,
/// the model for finite differences, does all steps too.
pub(crate) const SETTLED: f64 = 1e-4;
/// Step of forward differences, relative to the smallest distance of the vertex from an edge of its one-ring. The step
/// is large enough for second differences in single precision.
pub(crate) const DIFFERENCE: f64 = 1e-2;
/// The 16 displacements of Mesquite's forward differences, in steps along x and y. Four points give the value and the
/// three first differences at the vertex. Four more points each belong to the vertex displaced by one step along x, y
/// and z. A planar mesh does not need displacements along z. Mesquite computes them anyway, and the cost model counts
/// them.
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
