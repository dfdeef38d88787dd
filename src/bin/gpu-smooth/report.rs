//! What a run did, as JSON and as a table.

use std::collections::BTreeMap;
use std::fmt::Write;

use gpu_smooth::{Change, Metric, Outcome, Quality, Scheme, Slid, Spread};
use serde::Serialize;

use crate::explain::BadTriangleReport;
use crate::numbers::{percent, six};
use crate::proof::Certificate;
use crate::worst_args::ImprovedReport;

/// The report of a run. Times are in seconds, angles in degrees.
#[derive(Serialize)]
pub(crate) struct Report {
    pub(crate) engine: EngineReport,
    pub(crate) mesh: MeshReport,
    /// How the mesh was untangled before the run, if it had to be.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) untangled: Option<UntangleReport>,
    pub(crate) scheme: String,
    /// What elements were to look like, if not equilateral in the plane.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) target: Option<TargetReport>,
    pub(crate) sweeps: u32,
    /// Corrections from coarser levels, each after a sweep.
    pub(crate) corrections: u32,
    /// The first sweeps, if they were done in double precision on the CPU because triangles were too flat or too small for
    /// the GPU.
    pub(crate) opening_sweeps: u32,
    pub(crate) levels_left_out: bool,
    /// The sweep whose state was written.
    pub(crate) best_sweep: u32,
    /// The share of f that is estimated to be left to gain; null where the decay of f says nothing.
    pub(crate) remaining: Option<f64>,
    /// reached, converged, stalled, held-back, max-sweeps, cancelled, time-limit, not-finite or nothing-to-do.
    pub(crate) stop: &'static str,
    /// The sweep after which the run was left before, if it goes on from a checkpoint.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) continued_from: Option<u32>,
    /// Why there was nothing to do.
    #[serde(skip)]
    pub(crate) nothing_to_do: Option<String>,
    /// What the options hold or let move, a line each.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(crate) choices: Vec<String>,
    /// What data of vertices were taken to the new places.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) interpolated: Option<String>,
    /// Vertices that the guard keeps from moving on at the end of a run that converged otherwise.
    pub(crate) held_back: usize,
    /// The share of the gain in f that is lost as coordinates are rounded to the digits they have.
    pub(crate) lost: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) goal: Option<GoalReport>,
    /// Vertices put back because rounding had inverted a triangle.
    pub(crate) returned: usize,
    /// How far vertices might move, in lengths of an edge, if there was a bound.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) max_move: Option<f64>,
    pub(crate) change: ChangeReport,
    pub(crate) before: QualityReport,
    pub(crate) after: QualityReport,
    /// What slid along lines, if vertices might.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) slid: Option<SlideReport>,
    /// What improving the worst triangles did, if it was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) improved: Option<ImprovedReport>,
    /// What the files alone say, where the mesh was written to a file and a report is written.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) certificate: Option<Certificate>,
    pub(crate) history: Vec<SweepReport>,
    pub(crate) seconds: Seconds,
}

/// The report of a run that was refused because of inverted or flat triangles.
#[derive(Serialize)]
pub(crate) struct Refusal {
    /// The message on the terminal, without its list of triangles.
    pub(crate) error: String,
    /// All inverted and flat triangles, in the order of the file.
    pub(crate) triangles: Vec<BadTriangleReport>,
}

#[derive(Serialize)]
pub(crate) struct EngineReport {
    /// gpu or cpu.
    pub(crate) kind: &'static str,
    pub(crate) adapter: Option<String>,
    pub(crate) driver: Option<String>,
    /// Why this engine was taken, if the command line left that open.
    pub(crate) reason: Option<String>,
    /// The fault of the GPU after which the run went on on the CPU.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) fault: Option<FaultReport>,
}

#[derive(Serialize)]
pub(crate) struct FaultReport {
    /// The last sweep on the GPU that was kept.
    pub(crate) sweep: u32,
    pub(crate) error: String,
}

#[derive(Serialize)]
pub(crate) struct MeshReport {
    pub(crate) format: String,
    pub(crate) vertices: usize,
    pub(crate) triangles: usize,
    pub(crate) free: usize,
    pub(crate) colors: usize,
}

/// What elements were to look like, if not equilateral in the plane.
#[derive(Serialize)]
pub(crate) struct TargetReport {
    /// equilateral, keep-size, keep-shape, size=SOURCE or metric=SOURCE.
    pub(crate) kind: String,
    /// vertex, if vertices take their targets along, or place.
    pub(crate) of: &'static str,
    /// plane or sphere.
    pub(crate) surface: &'static str,
    /// Over how many rings of neighbors sizes and shapes were averaged.
    pub(crate) rings: u32,
    /// The base metric's objective of the triangles as targets show them, before and after.
    pub(crate) f: [f64; 2],
}

/// How far free vertices moved, and how the sizes of elements at them changed.
#[derive(Serialize)]
pub(crate) struct ChangeReport {
    /// In lengths of an edge at the vertex.
    pub(crate) moved: SpreadReport,
    /// Factors, up or down.
    pub(crate) size: SpreadReport,
    /// The least altitude of a triangle, before and after.
    pub(crate) least_altitude: [f64; 2],
}

#[derive(Serialize)]
pub(crate) struct SpreadReport {
    pub(crate) median: f64,
    /// Of twenty vertices nineteen have no more.
    pub(crate) most_of_twenty: f64,
    pub(crate) most: f64,
}

impl From<Spread> for SpreadReport {
    fn from(Spread { median, most_of_twenty, most }: Spread) -> Self {
        Self { median, most_of_twenty, most }
    }
}

impl From<Change> for ChangeReport {
    fn from(change: Change) -> Self {
        let Change { moved, size, least_altitude } = change;
        Self { moved: moved.into(), size: size.into(), least_altitude }
    }
}

/// What slid along lines.
#[derive(Serialize)]
pub(crate) struct SlideReport {
    /// Vertices that might slide.
    pub(crate) vertices: usize,
    /// Those that did.
    pub(crate) moved: usize,
    /// Periodic pairs among those that might slide, of which both vertices move together.
    pub(crate) pairs: usize,
    /// Rounds of sweeps, each followed by sweeps along the lines.
    pub(crate) rounds: u32,
    /// How far the lines are from those before, in the unit of the mesh.
    pub(crate) off: f64,
    /// The change of the area of the mesh, as a share of it.
    pub(crate) area_change: f64,
}

impl From<Slid> for SlideReport {
    fn from(Slid { vertices, moved, pairs, rounds, off, area }: Slid) -> Self {
        Self { vertices, moved, pairs, rounds, off, area_change: area }
    }
}

/// What untangling did.
#[derive(Serialize)]
pub(crate) struct UntangleReport {
    /// Triangles that were inverted or flat.
    pub(crate) bad_before: usize,
    pub(crate) sweeps: u32,
    /// Vertices that it moved.
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
    /// The objective by each metric.
    pub(crate) f: BTreeMap<&'static str, f64>,
    pub(crate) min_angle: f64,
    pub(crate) max_angle: f64,
    pub(crate) worst_imr: f64,
    /// The worst inverse mean ratio of a triangle with a free vertex.
    pub(crate) worst_movable_imr: f64,
    pub(crate) inverted: usize,
}

#[derive(Serialize)]
pub(crate) struct SweepReport {
    pub(crate) sweep: u32,
    /// The metric this sweep minimized; none before the first.
    pub(crate) metric: Option<&'static str>,
    /// The base metric's objective after the sweep.
    pub(crate) f: f64,
    /// The objective of every metric, where asked for.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub(crate) all: BTreeMap<&'static str, f64>,
}

#[derive(Clone, Copy, Serialize)]
pub(crate) struct Seconds {
    pub(crate) read: f64,
    pub(crate) prepare: f64,
    pub(crate) smooth: f64,
    pub(crate) write: f64,
    pub(crate) total: f64,
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

/// How a run ends that should not.
const NOT_FINITE: &str = "undone: a sweep made a number that is not finite, which is a mistake of this program; the mesh is of the last good state";

/// The history of a run, sweep by sweep.
pub(crate) fn history(outcome: &Outcome, scheme: &Scheme, all: bool) -> Vec<SweepReport> {
    let metric = |sweep| match sweep <= outcome.alternated {
        true => scheme.metric(sweep),
        false => scheme.base(),
    };
    let one = |(sweep, objectives): (u32, &gpu_smooth::Objectives)| SweepReport {
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

/// Changes of size by more than this factor at one vertex in twenty are worth a word.
const LARGE_CHANGE: f64 = 1.25;
/// In a mesh whose f by imr is below this, sizes are likely to be meant.
const SOUND: f64 = 2.0;

impl Report {
    /// The metric that judges.
    pub(crate) fn base(&self) -> &str {
        self.scheme.split('+').next().unwrap_or("imr")
    }

    /// The summary for the terminal: what was done, before and after, and where the time went.
    pub(crate) fn summary(&self) -> String {
        let mut text = self.subject() + "\n\n";
        let _ = writeln!(text, "{:<14}{:>12}{:>12}", "", "before", "after");
        for [name, before, after] in self.rows() {
            let _ = writeln!(text, "{name:<14}{before:>12}{after:>12}");
        }
        let _ = writeln!(text, "\n{}", self.ending());
        let _ = writeln!(text, "{}", self.moves());
        if let Some(slides) = self.slides() {
            let _ = writeln!(text, "{slides}");
        }
        if let Some(improved) = &self.improved {
            let _ = writeln!(text, "{}", improved.told());
        }
        if let Some(warning) = self.warning() {
            let _ = writeln!(text, "{warning}");
        }
        let Seconds { read, prepare, smooth, write, total } = self.seconds;
        let _ = write!(
            text,
            "read {read:.3} s, prepare {prepare:.3} s, smooth {smooth:.3} s, write {write:.3} s; total {total:.3} s"
        );
        text
    }

    /// What was smoothed, where and by what.
    pub(crate) fn subject(&self) -> String {
        let mut text = String::new();
        let MeshReport { vertices, triangles, free, colors, .. } = self.mesh;
        let s = if colors == 1 { "" } else { "s" };
        let _ = writeln!(
            text,
            "{vertices} vertices ({free} free, {colors} color{s}), {triangles} triangles"
        );
        let on = self.engine.adapter.as_deref().unwrap_or("all cores");
        let _ = write!(text, "{} on {} ({on})", self.scheme, self.engine.kind);
        if let Some(reason) = &self.engine.reason {
            let _ = write!(text, ": {reason}");
        }
        text.push('\n');
        if let Some(UntangleReport { bad_before, sweeps, moved }) = self.untangled {
            let count = |n: usize, one: &str, many: &str| match n {
                1 => format!("1 {one}"),
                n => format!("{n} {many}"),
            };
            let _ = writeln!(
                text,
                "untangled {} in {}, which moved {}",
                count(bad_before, "inverted or flat triangle", "inverted or flat triangles"),
                count(sweeps as usize, "sweep", "sweeps"),
                count(moved, "vertex", "vertices"),
            );
        }
        text.trim_end().to_owned()
    }

    /// What changed: a name, and the values before and after.
    pub(crate) fn rows(&self) -> Vec<[String; 3]> {
        let base = self.base();
        let mut rows = Vec::new();
        let mut row = |name: &str, before, after| rows.push([name.to_owned(), before, after]);
        let mut metrics = vec![base];
        if !matches!(base, "imr" | "ar") {
            metrics.push("imr");
        }
        if let Some(TargetReport { f: [before, after], .. }) = self.target {
            row("f of targets", six(before), six(after));
            metrics = vec!["imr"];
        }
        for metric in metrics {
            row(&format!("f {metric}"), six(self.before.f[metric]), six(self.after.f[metric]));
        }
        let angle = |a: f64| format!("{a:.2}°");
        row("min angle", angle(self.before.min_angle), angle(self.after.min_angle));
        row("max angle", angle(self.before.max_angle), angle(self.after.max_angle));
        row("worst imr", six(self.before.worst_imr), six(self.after.worst_imr));
        if self.after.worst_movable_imr < self.after.worst_imr {
            let (before, after) = (self.before.worst_movable_imr, self.after.worst_movable_imr);
            row("  of movable", six(before), six(after));
        }
        let [before, after] = self.change.least_altitude;
        row("min altitude", six(before), six(after));
        row("inverted", self.before.inverted.to_string(), self.after.inverted.to_string());
        rows
    }

    /// A remark on the worst element if it is worse than before by a hundredth or more.
    pub(crate) fn warning(&self) -> Option<String> {
        let (before, after) = (self.before.worst_movable_imr, self.after.worst_movable_imr);
        if after <= 1.01 * before {
            return None;
        }
        let judges_shape =
            |metric: &str| metric.parse::<Metric>().is_ok_and(|metric| metric.properties().barrier);
        let shape = self.scheme.split('+').any(judges_shape);
        let base = self.base();
        let remedy = match shape {
            true => "f is a mean, which may fall as one element gets worse; --guard worst does not let it".to_owned(),
            false => format!("{base} does not judge shapes; --scheme imr or {base}+imr does"),
        };
        let (before, after) = (six(before), six(after));
        Some(format!("worst imr rose from {before} to {after}: {remedy}"))
    }

    /// How far vertices moved and how much sizes changed, in a sentence.
    pub(crate) fn moves(&self) -> String {
        let ChangeReport { moved, size, .. } = &self.change;
        if moved.most == 0.0 {
            return "no vertex moved".to_owned();
        }
        let percent = |factor: f64| match 100.0 * (factor - 1.0) {
            change if change < 99.5 => format!("{change:.0} %"),
            _ => format!("{factor:.1} times"),
        };
        // Sizes of a mesh in a bad state mean nothing.
        let is_sound = self.before.f["imr"] < SOUND;
        let keeps = match self.target.is_none() && is_sound && size.most_of_twenty > LARGE_CHANGE {
            true => "; --target keep-size keeps sizes",
            false => "",
        };
        format!(
            "19 of 20 vertices moved {:.2} edges at most (half {:.2}, the farthest {:.2}), and sizes there changed by {} (half {}, the most {}){keeps}",
            moved.most_of_twenty,
            moved.median,
            moved.most,
            percent(size.most_of_twenty),
            percent(size.median),
            percent(size.most),
        )
    }

    /// What slid and what that did to the domain, in a sentence.
    pub(crate) fn slides(&self) -> Option<String> {
        let SlideReport { vertices, moved, pairs, off, area_change, .. } = self.slid.as_ref()?;
        let pairs = match pairs {
            0 => "",
            1 => ", a periodic pair together",
            n => &format!(", {n} periodic pairs together"),
        };
        let area = match 100.0 * area_change {
            change if change.abs() < 1e-9 => "stayed the same".to_owned(),
            change => format!("changed by {change:+.2e} %"),
        };
        Some(format!(
            "{moved} of {vertices} vertices on lines slid along them{pairs}; the lines are within {off:.1e} of what they were, and the area of the mesh {area}"
        ))
    }

    /// How far the run is from the limit of f, as far as that can be told.
    fn left(&self) -> String {
        match self.remaining {
            Some(left) => format!("; f is estimated to be {left:.1e} of itself above its limit"),
            None => "; more sweeps may gain more".into(),
        }
    }

    /// Why the run ended, if it neither converged nor reached its goal.
    pub(crate) fn fell_short(&self) -> Option<String> {
        let is_done = match &self.goal {
            Some(goal) => goal.reached,
            None => self.stop == "converged" || self.nothing_to_do.is_some(),
        };
        (!is_done).then(|| self.ending())
    }

    /// Why the run ended, in a sentence.
    pub(crate) fn ending(&self) -> String {
        if let Some(reason) = &self.nothing_to_do {
            return format!("nothing to do: {reason}; the mesh is written as it was");
        }
        let sweeps = match self.sweeps {
            1 => "1 sweep".to_owned(),
            n => format!("{n} sweeps"),
        };
        let sweeps = match self.corrections {
            0 => sweeps,
            n => format!("{sweeps} ({n} corrected from coarser levels)"),
        };
        let held = match self.held_back {
            1 => "1 vertex".to_owned(),
            n => format!("{n} vertices"),
        };
        let mut text = match (self.stop, &self.goal) {
            (stop, Some(goal)) => {
                let desired = six(goal.desired);
                let went = match goal.best_fraction {
                    beyond if beyond > 1.0 => format!("beyond f = {desired}"),
                    share => format!("{} % of the way to f = {desired}", percent(share)),
                };
                match (goal.reached, stop) {
                    (true, _) if self.sweeps == 0 => {
                        format!("nothing to do: f is as low as the desired {desired} already")
                    }
                    (true, _) => format!("reached after {sweeps}: {went}"),
                    (false, "stalled") => {
                        format!("not reached: no more progress after {sweeps}, {went}")
                    }
                    (false, "time-limit") => {
                        format!("ended by --time-limit after {sweeps}, {went}")
                    }
                    (false, "not-finite") => {
                        format!("{NOT_FINITE}, after {sweeps}, {went}")
                    }
                    (false, "cancelled") => format!("interrupted after {sweeps}, {went}"),
                    (false, _) => format!("not reached after {sweeps} (the most): {went}"),
                }
            }
            ("converged", None) if self.held_back > 0 => {
                format!("converged after {sweeps}; --guard worst keeps {held} from moving on")
            }
            ("converged", None) => format!("converged after {sweeps}"),
            ("stalled", None) => format!("no more progress after {sweeps}{}", self.left()),
            ("held-back", None) => {
                format!("held back by the shape guard at {held} after {sweeps}")
            }
            ("time-limit", None) => format!("ended by --time-limit after {sweeps}{}", self.left()),
            ("not-finite", None) => format!("{NOT_FINITE}, after {sweeps}"),
            ("cancelled", None) => format!("interrupted after {sweeps}; more may gain more"),
            (_, None) => {
                format!("stopped after {sweeps}, the most allowed (--max-sweeps){}", self.left())
            }
        };
        if self.sweeps > 0 && self.best_sweep == 0 {
            text.push_str("; nothing was gained, so the mesh is written as it was");
        } else if self.best_sweep != self.sweeps {
            let _ = write!(text, "; written is the best state, after sweep {}", self.best_sweep);
        }
        if let Some(FaultReport { sweep, error }) = &self.engine.fault {
            let _ = write!(text, "; on the CPU from sweep {sweep} on, as the GPU failed: {error}");
        }
        if self.opening_sweeps > 0 {
            let n = self.opening_sweeps;
            let _ = write!(
                text,
                "; the first {n} on the CPU, as triangles were too flat or small for the GPU"
            );
        }
        if self.lost > 0.01 {
            let share = percent(self.lost);
            let _ = write!(
                text,
                "; {share} % of the gain is lost to rounding, as coordinates have too few digits for this mesh"
            );
        }
        if self.levels_left_out {
            text.push_str("; coarser levels of so large a mesh do not fit the GPU");
        }
        if self.returned > 0 {
            let _ = write!(text, "; vertices put back for rounding: {}", self.returned);
        }
        text
    }
}
