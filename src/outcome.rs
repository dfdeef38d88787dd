//! The outcome of a run: new positions, and a report.

use std::time::Duration;

use crate::error::GpuError;
use crate::options::WorstBy;
pub use crate::run::Objectives;
use crate::run::Stop;

/// The result of a run.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Position of every vertex, in the order and unit of the mesh: the positions with the least f by the base metric. If
    /// the run lowered f by no more than rounding (1e-9 of f), these are the positions before the run, unless
    /// [`Options::improve_worst`](crate::Options::improve_worst) has made the worst triangle better. Exact predicates on
    /// these values find no triangle inverted or flat.
    pub points: Vec<[f64; 2]>,
    /// The reason why the run ended.
    pub stop: Stop,
    /// Number of sweeps done.
    pub sweeps: u32,
    /// Number of sweeps, from the first on, in which the scheme's metrics alternated. Later sweeps used only the base
    /// metric, which corrections require.
    pub alternated: u32,
    /// Number of corrections from coarser levels taken; see [`Method::Multilevel`](crate::Method::Multilevel).
    pub corrections: u32,
    /// Number of Newton steps of all vertices at once, each counted as a part of its sweep, with which a run by a smooth
    /// metric ends.
    pub newton_steps: u32,
    /// Number of iterations of conjugate gradients in all Newton steps.
    pub newton_iterations: u32,
    /// Number of sweeps at the start of a run on a GPU that the CPU did. The CPU does the first sweeps if triangles are too
    /// flat or too small for single precision, and every sweep if its first sweeps left such triangles. The CPU also
    /// does every sweep of a run with coarser levels if triangles are strongly stretched relative to their targets, as
    /// a GPU has no room for such a mesh's second map per vertex, and of a run with a bound of moves or altitudes in degrees,
    /// as single precision has too few digits for latitudes.
    pub opening_sweeps: u32,
    /// Number of last sweeps that the CPU did in a run on a GPU. The CPU replaces the GPU if targets of places have
    /// moved vertices to triangles too flat for single precision.
    pub closing_sweeps: u32,
    /// Whether [`Method::Auto`](crate::Method::Auto) ran without corrections because the coarser levels do not fit the
    /// device's limits.
    pub levels_left_out: bool,
    /// Time in which the coarser levels were built and fitted: a part of [`smooth`](Self::smooth), with the readback of
    /// the stiffness and the upload of the levels. A run that has left its device counts from then on.
    pub levels: Duration,
    /// The sweep whose positions are [`points`](Self::points); 0 for the mesh before the run.
    pub best_sweep: u32,
    /// Objectives: entry 0 before the first sweep, entry k after sweep k.
    pub history: Vec<Objectives>,
    /// Objective by the base metric over the triangles with a corner that is free or slides, before the run and in
    /// [`points`](Self::points). The tolerance, [`remaining`](Self::remaining) and the test for a gain use this objective,
    /// as other triangles never change. Equal to the mean over all triangles if targets belong to places.
    pub movable_f: [f64; 2],
    /// Estimated gain of further sweeps, as a share of f over the triangles that can move (of 1e-6 if f is smaller). The
    /// estimate extrapolates the decay of f in the last sweeps, but never beyond the ideal of f. After a Newton step of all
    /// vertices, the number is instead a bound of the gain of the quadratic model, plus the discrepancy of model and f in that
    /// step. Where a run by a smooth metric ends by sweeps alone or with corrections, and targets belong to vertices, the number
    /// is the gain that the quadratic model of a further Newton step has. Bounds or a guard may forbid
    /// that gain, so after corrections, a gain of more than ten tolerances does not count with them, and sweeps alone with bounds
    /// are not measured. After a run by EDGE with corrections, the estimate includes the distance
    /// between the minima of f and of EDGE's p-norm.
    ///
    /// The estimate has lower bounds. If an extrapolation ended the run as converged, the bound is the tolerance, or twice the
    /// tolerance if bounds or a guard may hold vertices. If the last correction gained nothing, the bound is a tenth of the
    /// tolerance, but at least 1e-8. If a run converged because f is level up to rounding, the bound is the variation of f over
    /// its last sweeps. On a device, the bound is the error of the f that the run was judged by, in single precision. In a
    /// projection, the bound is [`projection_error`](Self::projection_error).
    ///
    /// `None` if the run has not converged and its sweeps allow no estimate: the run did too few sweeps, or the gains per
    /// sweep do not decay. Also `None` if targets belong to places and the run ended because no part of its last move
    /// lowered f; see [`Smoother::set_target_field`](crate::Smoother::set_target_field).
    pub remaining: Option<f64>,
    /// Estimate, as a share of f, of the distance between the optimum in the projection of a sphere
    /// ([`Smoother::project_from_sphere`](crate::Smoother::project_from_sphere)) and the optimum on the sphere, where
    /// triangles are measured at their centers. The estimate falls with the square of the edge length. 0 without a
    /// projection.
    pub projection_error: f64,
    /// Number of vertices that a guard kept from moving further at the end of a run. Computed only if the run has
    /// converged or has done [`Options::max_sweeps`](crate::Options::max_sweeps) sweeps. If the number is above 0, a
    /// run that has converged without [`Guard::Worst`](crate::Guard::Worst) reports [`Stop::HeldBack`].
    pub held_back: usize,
    /// Share of the gain in f that was lost by rounding positions to [`Options::stored`](crate::Options::stored), and
    /// by setting back vertices whose rounding inverted a triangle. Near 1 for a mesh whose elements are hardly larger
    /// than the last digit of its coordinates.
    pub lost: f64,
    /// The way toward the goal; `None` for a run without a goal.
    pub goal: Option<GoalOutcome>,
    /// Number of vertices set back to their positions before the run because rounding had inverted a triangle, or had left
    /// an altitude below the bound of [`Options::keep_altitude`](crate::Options::keep_altitude), or because a vertex that
    /// slides would otherwise be [misplaced](crate::Slide::misplaced).
    pub returned: usize,
    /// The result of sliding; `None` if no vertex could slide; see
    /// [`Smoother::set_slide`](crate::Smoother::set_slide).
    pub slid: Option<Slid>,
    /// The work of the floor under the worst triangles. `None` if no shape was worse after the sweeps than before the run,
    /// or if the options or the mesh have another aim; see [`Floored`].
    pub floored: Option<Floored>,
    /// The work on large angles after the sweeps of a run by [`Acute`](crate::Metric::Acute) without targets, or by
    /// [`AcuteSize`](crate::Metric::AcuteSize) without targets that stretch triangles. `None` if the sweeps left no large angle,
    /// and after other runs; see [`LargeAngles`].
    pub large_angles: Option<LargeAngles>,
    /// The result of improving the worst triangles; `None` without
    /// [`Options::improve_worst`](crate::Options::improve_worst).
    pub improved: Option<Improved>,
    /// The device fault after which the run continued on the CPU; `None` if the device did not fail.
    pub device_fault: Option<DeviceFault>,
    /// The duration of the run, including the search for a desired objective.
    pub smooth: Duration,
}

/// The result of improving the worst triangles after the last sweep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Improved {
    /// The measure that ranks triangles.
    pub by: WorstBy,
    /// Number of moved vertices.
    pub vertices: usize,
    /// Measure of the worst triangle with a free vertex, after the last sweep and in [`Outcome::points`]: an inverse mean
    /// ratio, an angle in degrees, or an altitude in the unit of the mesh.
    pub worst: [f64; 2],
    /// Number of worse elements without a vertex that is free or slides. No vertex can improve such an element.
    pub stuck: usize,
    /// f by the base metric, after the last sweep and in [`Outcome::points`].
    pub f: [f64; 2],
}

/// The work of the floor under the worst triangles after the last sweep.
///
/// A run with the default metric, method and guard, without a goal, targets and
/// [`Options::improve_worst`](crate::Options::improve_worst), ends with no smaller angle and no larger inverse mean ratio
/// than the mesh had before the run. Only triangles with a corner that is free or slides count, in the coordinates as stored
/// ([`Options::stored`](crate::Options::stored)). If the sweeps end with a worse triangle, the free vertices around the
/// triangle take Newton steps by penalties on its angles and its inverse mean ratio, on the CPU. Vertices for which these
/// steps do not suffice go back to their positions before the run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Floored {
    /// Number of vertices that the floor moved elsewhere.
    pub moved: usize,
    /// Number of vertices that went back to their positions before the run. These are all vertices that had moved if the run
    /// gained nothing beside its floor; [`Outcome::points`] are then the mesh before the run.
    pub returned: usize,
    /// Smallest angle of a triangle that can move, in degrees: before the run, after the last sweep, and in
    /// [`Outcome::points`].
    pub least_angle: [f64; 3],
    /// Largest inverse mean ratio of a triangle that can move, likewise.
    pub worst_imr: [f64; 3],
    /// f by the base metric, after the last sweep and in [`Outcome::points`].
    pub f: [f64; 2],
}

/// The work on large angles after the sweeps of a run by [`Acute`](crate::Metric::Acute) or
/// [`AcuteSize`](crate::Metric::AcuteSize): vertices around triangles that can move and have an angle above 87.1 degrees take
/// further Newton steps by growing penalties on large and on small angles.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct LargeAngles {
    /// Number of vertices that moved after the sweeps.
    pub moved: usize,
    /// Number of triangles that can move and have an angle above 87.1 degrees: after the last sweep, and in
    /// [`Outcome::points`].
    pub triangles: [usize; 2],
    /// Number of these triangles that are obtuse, likewise.
    pub obtuse: [usize; 2],
    /// f by the base metric, after the last sweep and in [`Outcome::points`].
    pub f: [f64; 2],
}

impl LargeAngles {
    /// Cotangent of the angle of 87.1 degrees, above which an angle is large. If all angles are smaller, no edge is longer
    /// than twenty times the distance between the circumcenters beside it.
    pub(crate) const COTANGENT: f64 = 0.05;
}

impl Floored {
    /// Returns the work of a floor that set back all vertices that the sweeps had moved, where f is `f`.
    pub(crate) fn undone(self, vertices: usize, f: f64) -> Self {
        let undone = |[before, swept, _]: [f64; 3]| [before, swept, before];
        Self {
            moved: 0,
            returned: vertices,
            least_angle: undone(self.least_angle),
            worst_imr: undone(self.worst_imr),
            f: [self.f[0], f],
        }
    }
}

/// The result of sliding in a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slid {
    /// Number of vertices that could slide.
    pub vertices: usize,
    /// Number of vertices that slid.
    pub moved: usize,
    /// Number of pairs of vertices that slide together; see [`Slide::periodic`](crate::Slide::periodic).
    pub pairs: usize,
    /// Number of pairs of vertices with equal coordinates that slide together, as on both sides of a crack.
    pub coincident: usize,
    /// Number of vertices, partners included, that stay at a bound: the distance of the new edges from the given vertices
    /// ([`Slide::hausdorff`](crate::Slide::hausdorff)), or [`Options::max_move`](crate::Options::max_move). These are the
    /// vertices that stayed in the last Newton step of all vertices. In a run without such steps, they are the vertices that
    /// three successive sweeps have pressed against a bound, and that later sweeps do not visit. The remaining gain of a run
    /// does not count further moves of these vertices.
    pub frozen: usize,
    /// Largest distance between the edges of the lines before and after the run, in the unit of the mesh: of a given vertex
    /// from the new edges, or of a moved vertex from the given edges. Moved vertices themselves are on the curves.
    pub off: f64,
    /// The largest of these distances as a share of the local edge length.
    pub off_share: f64,
    /// Relative change of the area of the mesh.
    pub area: f64,
}

/// A fault of a device, after which a run continued on the CPU; see
/// [`CheckpointPolicy::falls_back_to_cpu`](crate::CheckpointPolicy::falls_back_to_cpu).
#[derive(Clone, Debug)]
pub struct DeviceFault {
    /// The last sweep on the device whose positions the run kept.
    pub sweep: u32,
    /// The error of the device.
    pub error: GpuError,
}

/// Progress of a run toward its [`Goal`](crate::Goal).
#[derive(Clone, Debug, PartialEq)]
pub struct GoalOutcome {
    /// The wanted share, [`Goal::fraction`](crate::Goal::fraction).
    pub fraction: f64,
    /// The desired objective.
    pub desired: f64,
    /// Origin of the desired objective: "given", or a description of the search runs.
    pub origin: String,
    /// Share of the difference between the initial and the desired objective that [`Outcome::points`] have gained; 1 if
    /// both objectives are equal.
    pub best_fraction: f64,
}
