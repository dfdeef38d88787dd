//! The report of a run, as `--report` writes it in JSON.

use std::collections::BTreeMap;
use std::time::Duration;

use gpu_smooth::{
    Metric, Outcome, Quality, Scheme,
    measure::{Change, Distribution},
    outcome::Slid,
};
use serde::Serialize;

use crate::load::explain::BadTriangleReport;
use crate::report::{
    Certificate, FlooredReport, ImprovedReport, LargeAnglesReport, ProfileChange, SpacingReport,
    TargetReport,
};

/// The report of a run. Times are in seconds, angles in degrees.
#[derive(Serialize)]
pub(crate) struct Report {
    pub(crate) engine: EngineReport,
    pub(crate) mesh: MeshReport,
    /// The result of untangling before the run; `None` if no triangle was inverted or flat.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) untangled: Option<UntangleReport>,
    pub(crate) scheme: String,
    /// The options of the table that the command line has, with their values.
    pub(crate) options: serde_json::Map<String, serde_json::Value>,
    /// The target of the elements; `None` if elements are to be equilateral in the plane.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) target: Option<TargetReport>,
    pub(crate) sweeps: u32,
    /// Number of sweeps corrected from coarser levels.
    pub(crate) corrections: u32,
    /// Number of sweeps with a Newton step of all vertices, and of iterations in all of these steps.
    pub(crate) newton_steps: u32,
    pub(crate) newton_iterations: u32,
    /// Number of first sweeps computed in double precision on the CPU, because triangles were too flat, too small, or too
    /// stretched relative to their targets, for the GPU, or because moves or altitudes in degrees are bounded.
    pub(crate) opening_sweeps: u32,
    /// Number of last sweeps computed in double precision on the CPU, because triangles had become too flat for the GPU.
    pub(crate) closing_sweeps: u32,
    pub(crate) levels_left_out: bool,
    /// The sweep whose result was written; 0 for the mesh as it was.
    pub(crate) best_sweep: u32,
    /// f over the triangles that can move, by the metric that judges the run, before and after the run.
    pub(crate) movable_f: [f64; 2],
    /// Estimated remaining gain as a fraction of f; null if the decay of f allows no estimate.
    pub(crate) remaining: Option<f64>,
    /// Whether a GPU ended the run as converged, although its single precision cannot tell a gain of the tolerance.
    #[serde(skip)]
    pub(crate) imprecise: bool,
    /// Estimated distance, as a fraction of f, between the optimum in the projection of the sphere and the optimum on the
    /// sphere. `None` if the distance is within the tolerance.
    #[serde(skip)]
    pub(crate) projection_error: Option<f64>,
    /// reached, converged, stalled, held-back, max-sweeps, canceled, time-limit, not-finite or nothing-to-do.
    pub(crate) stop: &'static str,
    /// Sweeps completed at the checkpoint from which the run continued; `None` for uninterrupted runs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) continued_from: Option<u32>,
    /// The reason why no vertex needed to move; `None` if the mesh was smoothed.
    #[serde(skip)]
    pub(crate) nothing_to_do: Option<String>,
    /// A line for each option that fixes or frees vertices.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(crate) choices: Vec<String>,
    /// A sentence on the vertex data that were interpolated at the new positions.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) interpolated: Option<String>,
    /// Number of vertices that the guard kept from moving at the end of an otherwise converged run.
    pub(crate) held_back: usize,
    /// Whether `--guard worst` was given.
    #[serde(skip)]
    pub(crate) guards_worst: bool,
    /// Fraction of the gain in f that is lost by rounding coordinates to the digits of the file.
    pub(crate) lost: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) goal: Option<GoalReport>,
    /// Number of vertices moved back because rounding had inverted a triangle.
    pub(crate) returned: usize,
    pub(crate) change: ChangeReport,
    /// Spacing at the walls. Without a report or a page, empty if nearly no triangle at a wall is flat.
    pub(crate) spacing: Vec<SpacingReport>,
    pub(crate) before: QualityReport,
    pub(crate) after: QualityReport,
    /// The limits of `--for` before and after the run; `None` without `--for`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) profile: Option<ProfileChange>,
    /// Movement of vertices along lines; `None` without `--slide`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) slid: Option<SlideReport>,
    /// Work of the floor under the worst triangles; `None` if the sweeps made no shape worse.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) floored: Option<FlooredReport>,
    /// Work on large angles after a run by ACUTE; `None` if the sweeps left none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) large_angles: Option<LargeAnglesReport>,
    /// Result of improving the worst triangles; `None` without `--improve-worst`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) improved: Option<ImprovedReport>,
    /// Facts proved from the files alone; `None` if the mesh was not written to a file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) certificate: Option<Certificate>,
    pub(crate) history: Vec<SweepReport>,
    pub(crate) seconds: Seconds,
}

/// The report of a run that was refused because of inverted or flat triangles.
#[derive(Serialize)]
pub(crate) struct Refusal {
    /// The message of the error, without its list of triangles.
    pub(crate) error: String,
    /// All inverted and flat triangles, in the order of the file.
    pub(crate) triangles: Vec<BadTriangleReport>,
}

#[derive(Serialize)]
pub(crate) struct EngineReport {
    /// `gpu` or `cpu`.
    pub(crate) kind: &'static str,
    pub(crate) adapter: Option<String>,
    pub(crate) driver: Option<String>,
    /// The reason for choosing this engine; `None` if the command line determined the engine.
    pub(crate) reason: Option<String>,
    /// The fault of the GPU after which the run continued on the CPU.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) fault: Option<FaultReport>,
}

#[derive(Serialize)]
pub(crate) struct FaultReport {
    /// The last sweep on the GPU whose result was kept.
    pub(crate) sweep: u32,
    pub(crate) error: String,
}

/// Returns whether a number is 0.
fn is_zero(number: &usize) -> bool {
    *number == 0
}

#[derive(Serialize)]
pub(crate) struct MeshReport {
    pub(crate) format: String,
    /// The format of OUT; `None` if IN and OUT have one format.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) output_format: Option<String>,
    pub(crate) vertices: usize,
    pub(crate) triangles: usize,
    /// Number of quadrilaterals whose vertices may move. Absent if there are none.
    #[serde(skip_serializing_if = "is_zero")]
    pub(crate) quadrilaterals: usize,
    pub(crate) free: usize,
    pub(crate) colors: usize,
}

/// Distances that vertices moved, and changes of element sizes at vertices.
#[derive(Serialize)]
pub(crate) struct ChangeReport {
    /// Distances in lengths of an edge at the vertex.
    pub(crate) moved: DistributionReport,
    /// Factors by which element sizes grew or shrank, at least 1.
    pub(crate) size: DistributionReport,
    /// Smallest triangle altitude before and after, in units of the mesh.
    pub(crate) least_altitude: [f64; 2],
}

#[derive(Serialize)]
pub(crate) struct DistributionReport {
    pub(crate) median: f64,
    /// The 95th percentile: 19 of 20 vertices have values up to this one.
    pub(crate) p95: f64,
    pub(crate) most: f64,
}

impl From<Distribution> for DistributionReport {
    fn from(Distribution { median, p95, most }: Distribution) -> Self {
        Self { median, p95, most }
    }
}

impl From<Change> for ChangeReport {
    fn from(change: Change) -> Self {
        let Change { moved, size, least_altitude } = change;
        Self { moved: moved.into(), size: size.into(), least_altitude }
    }
}

/// Movement of vertices along lines.
#[derive(Serialize)]
pub(crate) struct SlideReport {
    /// Number of vertices that were allowed to slide.
    pub(crate) vertices: usize,
    /// Number of vertices that slid.
    pub(crate) moved: usize,
    /// Number of vertices that would have been allowed to slide if no group ended at them.
    pub(crate) ends: usize,
    /// Number of periodic pairs, or pairs across weirs, among the sliding vertices. Both vertices of a pair slide
    /// together.
    pub(crate) pairs: usize,
    /// Number of pairs of vertices with equal coordinates among the sliding vertices, which keep equal coordinates.
    pub(crate) coincident: usize,
    /// Whether pairs are across weirs and not periodic.
    #[serde(skip)]
    pub(crate) has_weirs: bool,
    /// Number of vertices that a bound stopped for the rest of the run.
    pub(crate) frozen: usize,
    /// Largest distance between the lines of output and input, in units of the mesh.
    pub(crate) off: f64,
    /// Largest of these distances, as a share of the local edge length.
    pub(crate) off_share: f64,
    /// Change of the mesh's area as a fraction of the area.
    pub(crate) area_change: f64,
}

impl From<Slid> for SlideReport {
    fn from(slid: Slid) -> Self {
        let Slid { vertices, moved, pairs, coincident, frozen, off, off_share, area } = slid;
        let (ends, has_weirs, area_change) = (0, false, area);
        Self {
            vertices,
            moved,
            ends,
            pairs,
            has_weirs,
            coincident,
            frozen,
            off,
            off_share,
            area_change,
        }
    }
}

/// The result of untangling.
#[derive(Serialize)]
pub(crate) struct UntangleReport {
    /// Number of triangles that were inverted or flat.
    pub(crate) bad_before: usize,
    pub(crate) sweeps: u32,
    /// Number of moved vertices.
    pub(crate) moved: usize,
}

#[derive(Serialize)]
pub(crate) struct GoalReport {
    pub(crate) fraction: f64,
    pub(crate) desired: f64,
    pub(crate) origin: String,
    pub(crate) reached: bool,
    pub(crate) best_fraction: f64,
}

#[derive(Serialize)]
pub(crate) struct QualityReport {
    /// Objectives of all metrics, by the metric's name.
    pub(crate) f: BTreeMap<&'static str, f64>,
    pub(crate) min_angle: f64,
    pub(crate) max_angle: f64,
    pub(crate) worst_imr: f64,
    /// Worst inverse mean ratio of the triangles with a free vertex.
    pub(crate) worst_movable_imr: f64,
    pub(crate) inverted: usize,
}

#[derive(Serialize)]
pub(crate) struct SweepReport {
    pub(crate) sweep: u32,
    /// The metric minimized by this sweep; `None` for the entry before the first sweep.
    pub(crate) metric: Option<&'static str>,
    /// The base metric's objective after the sweep.
    pub(crate) f: f64,
    /// Objectives of all metrics after the sweep; empty without `--history all`.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub(crate) all: BTreeMap<&'static str, f64>,
}

/// Durations of the stages of a run in seconds.
#[derive(Clone, Copy, Serialize)]
pub(crate) struct Seconds {
    pub(crate) read: f64,
    pub(crate) prepare: f64,
    pub(crate) smooth: f64,
    pub(crate) write: f64,
    /// Drawing and writing the picture and the page; 0 without both.
    pub(crate) pictures: f64,
    /// The sum of all parts.
    pub(crate) total: f64,
}

impl Seconds {
    /// Replaces the time of pictures and pages, also in the total.
    pub(crate) fn with_pictures(self, pictures: Duration) -> Self {
        let pictures = pictures.as_secs_f64();
        Self { pictures, total: self.total - self.pictures + pictures, ..self }
    }
}

impl From<&Quality> for QualityReport {
    fn from(quality: &Quality) -> Self {
        Self {
            f: Metric::ALL.iter().map(|&m| (m.name(), quality.f(m))).collect(),
            min_angle: quality.min_angle,
            max_angle: quality.max_angle,
            worst_imr: quality.worst_imr,
            worst_movable_imr: quality.worst_movable_imr,
            inverted: quality.inverted,
        }
    }
}

/// Returns the history of a run, one entry per sweep.
pub(crate) fn history(outcome: &Outcome, scheme: &Scheme, all: bool) -> Vec<SweepReport> {
    let metric = |sweep| match sweep <= outcome.alternated {
        true => scheme.metric(sweep),
        false => scheme.base(),
    };
    let one = |(sweep, objectives): (u32, &gpu_smooth::outcome::Objectives)| SweepReport {
        sweep,
        metric: (sweep > 0).then(|| metric(sweep).name()),
        f: objectives.of(scheme.base()).unwrap_or(f64::NAN),
        all: match all {
            false => BTreeMap::new(),
            true => Metric::ALL
                .iter()
                .filter_map(|&m| objectives.of(m).map(|f| (m.name(), f)))
                .collect(),
        },
    };
    (0..).zip(&outcome.history).map(one).collect()
}
