//! The outcome of a run.

use std::time::Duration;

use crate::error::GpuError;
use crate::options::WorstBy;
pub use crate::run::Objectives;
use crate::run::Stop;

/// The result of a run.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Position of every vertex, in the mesh's order and units: the best state by the base metric. It is the mesh
    /// before the run if f of that state is not lower by more than rounding (1e-9 of f), unless
    /// [`Options::improve_worst`](crate::Options::improve_worst) has made the worst triangle better. By exact
    /// predicates on these values, no triangle is inverted or flat.
    pub points: Vec<[f64; 2]>,
    /// Why the run ended.
    pub stop: Stop,
    /// Number of sweeps done.
    pub sweeps: u32,
    /// Number of sweeps in which the metrics of the scheme took turns. The sweeps after them were by the base metric,
    /// so that corrections could follow.
    pub alternated: u32,
    /// Number of corrections from coarser levels taken; see [`Method::Multilevel`](crate::Method::Multilevel).
    pub corrections: u32,
    /// Number of sweeps done on the CPU although the backend is a GPU, because triangles were too flat or too small for
    /// single precision. These are the first sweeps, or all if the first ones did not open every triangle.
    pub opening_sweeps: u32,
    /// Whether [`Method::Auto`](crate::Method::Auto) ran without corrections because the coarser levels do not fit the
    /// device's limits.
    pub levels_left_out: bool,
    /// The sweep after which the mesh was as in `points`; 0 for the mesh before the run.
    pub best_sweep: u32,
    /// Objectives before the first sweep and after each.
    pub history: Vec<Objectives>,
    /// The share of f, or of 1e-6 where f is less, that further sweeps are estimated to gain, extrapolated from the decay of the
    /// last sweeps, and at most what f is above its ideal; `None` if they do not decay or are too few. After a run by EDGE with
    /// corrections, it includes what EDGE's p-norm leaves of f.
    pub remaining: Option<f64>,
    /// Number of vertices that a guard kept from moving further at the end of a run that has otherwise converged, or has done
    /// [`Options::max_sweeps`](crate::Options::max_sweeps) sweeps. Without [`Guard::Worst`](crate::Guard::Worst) a converged run is then
    /// said to have ended for this reason ([`Stop::HeldBack`]).
    pub held_back: usize,
    /// The share of the gain in f that is lost when positions are rounded to the digits that coordinates have, and
    /// vertices are set back because of it. Near 1 for a mesh as fine as its numbers.
    pub lost: f64,
    /// How far the run went toward its goal, if it had one.
    pub goal: Option<GoalOutcome>,
    /// Number of vertices set back to their positions before the run, because rounding had inverted a triangle, or had
    /// made its altitude smaller than [`Options::keep_altitude`](crate::Options::keep_altitude) allows.
    pub returned: usize,
    /// The result for vertices on curves, if vertices were to slide; see
    /// [`Smoother::set_slide`](crate::Smoother::set_slide).
    pub slid: Option<Slid>,
    /// The result of improving the worst triangles, if it was asked for; see
    /// [`Options::improve_worst`](crate::Options::improve_worst).
    pub improved: Option<Improved>,
    /// The fault of the device after which the run continued on the CPU, if there was one.
    pub device_fault: Option<DeviceFault>,
    /// The duration of the run, including the search for a desired objective.
    pub smooth: Duration,
}

/// The result of improving the worst triangles after the last sweep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Improved {
    /// The measure that defines the worst.
    pub by: WorstBy,
    /// Number of vertices that were moved.
    pub vertices: usize,
    /// The worst triangle with a free vertex after the last sweep, and as returned: an inverse mean ratio, an angle in
    /// degrees, or an altitude in the unit of the mesh.
    pub worst: [f64; 2],
    /// Number of triangles that are worse than that but cannot be improved, as they have no vertex that is free or may
    /// slide.
    pub stuck: usize,
    /// The objective by the base metric: after the last sweep, and as returned.
    pub f: [f64; 2],
}

/// The result of sliding in a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slid {
    /// Number of vertices that were allowed to slide.
    pub vertices: usize,
    /// Number of these vertices that have moved.
    pub moved: usize,
    /// Number of pairs among these vertices that move together; see [`Slide::periodic`](crate::Slide::periodic).
    pub pairs: usize,
    /// Number of periods, each of sweeps over free vertices and then along the curves.
    pub rounds: u32,
    /// The largest distance of the lines between vertices from those in the mesh before the run, in its unit.
    pub off: f64,
    /// The change of the area of all triangles, as a share of that area.
    pub area: f64,
}

/// A fault of a device, after which a run continued on the CPU; see
/// [`CheckpointPolicy::falls_back_to_cpu`](crate::CheckpointPolicy::falls_back_to_cpu).
#[derive(Clone, Debug)]
pub struct DeviceFault {
    /// The last sweep on the device whose result was kept.
    pub sweep: u32,
    /// The error of the device.
    pub error: GpuError,
}

/// How far a run went toward its [`Goal`](crate::Goal).
#[derive(Clone, Debug, PartialEq)]
pub struct GoalOutcome {
    /// The share that [`Goal::fraction`](crate::Goal::fraction) asked for.
    pub fraction: f64,
    /// The desired objective.
    pub desired: f64,
    /// The origin of the desired objective: "given", or a description of the runs that found it.
    pub origin: String,
    /// The share of the way from the initial to the desired objective that is reached by [`Outcome::points`]; 1 if both
    /// were equal from the start.
    pub best_fraction: f64,
}
