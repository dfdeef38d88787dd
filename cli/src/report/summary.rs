//! The summary of a run for a terminal, with sentences that pages show too.

use std::fmt::Write;

use gpu_smooth::{Guard, Metric};
use gpu_smooth_job::{RiseReason, WorstRise};

use crate::load::stay_as_ends;
use crate::report::{
    ChangeReport, FaultReport, MeshReport, QualityReport, Report, Seconds, SlideReport,
    TargetReport, UntangleReport, spacing_sentences,
};
use crate::terminal::numbers::{elements, percent, rough, sig6};

/// The message of a run ended by a sweep whose objective was infinite or NaN.
const NOT_FINITE: &str = "undone: a sweep made f infinite or NaN, which is a defect of this program or of the GPU driver; the mesh has the positions of the last finite state";

/// If more than one vertex in twenty changes its size by more than this factor, the summary mentions `--target
/// keep-size`.
const LARGE_CHANGE: f64 = 1.25;
/// If f by imr is below this value before the run, the sizes of elements are likely to be intended.
const SOUND: f64 = 2.0;
/// Relative difference between f over all triangles and f over those that can move from which the summary states both.
const SEEN: f64 = 0.01;
/// `Outcome::remaining` is relative to f, or to this value where f is smaller.
const LEAST_SCALE: f64 = 1e-6;

impl Report {
    /// Returns the base metric, the first of the scheme, which judges convergence.
    pub(crate) fn base(&self) -> &str {
        self.scheme.split('+').next().unwrap_or("imr")
    }

    /// Returns the summary for the terminal: subject, table of values before and after, result and times.
    pub(crate) fn summary(&self) -> String {
        let mut text = self.subject() + "\n\n";
        let _ = writeln!(text, "{:<14}{:>12}{:>12}", "", "before", "after");
        for [name, before, after] in self.rows() {
            let _ = writeln!(text, "{name:<14}{before:>12}{after:>12}");
        }
        let _ = writeln!(text, "\n{}", self.ending());
        for sentence in self.sentences() {
            let _ = writeln!(text, "{sentence}");
        }
        if let Some(warning) = self.warning() {
            let _ = writeln!(text, "{warning}");
        }
        let Seconds { read, prepare, smooth, write, pictures, total } = self.seconds;
        let _ = write!(
            text,
            "read {read:.3} s, prepare {prepare:.3} s, smooth {smooth:.3} s, write {write:.3} s"
        );
        if pictures > 0.0 {
            let _ = write!(text, ", pictures {pictures:.3} s");
        }
        let _ = write!(text, "; total {total:.3} s");
        if let Some(profile) = &self.profile {
            let _ = write!(text, "\n\n{}", profile.table());
        }
        text
    }

    /// Returns the sentences of the summary after its ending: how vertices moved and slid, and how the worst triangles and the
    /// distances from walls changed.
    pub(crate) fn sentences(&self) -> Vec<String> {
        let mut sentences = vec![self.moves()];
        sentences.extend(spacing_sentences(&self.spacing));
        sentences.extend(self.slides());
        sentences.extend(self.floored.as_ref().map(|floored| floored.sentence()));
        sentences.extend(self.large_angles.as_ref().map(|angles| angles.sentence()));
        let is_canceled = matches!(self.stop, "canceled" | "time-limit");
        sentences.extend(self.improved.as_ref().map(|improved| improved.sentence(is_canceled)));
        sentences
    }

    /// Describes the size of the mesh, the engine, the scheme and the untangling.
    pub(crate) fn subject(&self) -> String {
        let mut text = String::new();
        let MeshReport { vertices, triangles, quadrilaterals, free, colors, .. } = self.mesh;
        let elements = elements(triangles, quadrilaterals);
        if let Some(output_format) = &self.mesh.output_format {
            let _ = writeln!(text, "{} to {output_format}", self.mesh.format);
        }
        let s = if colors == 1 { "" } else { "s" };
        let _ = writeln!(text, "{vertices} vertices ({free} free, {colors} color{s}), {elements}");
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
                match quadrilaterals {
                    0 =>
                        count(bad_before, "inverted or flat triangle", "inverted or flat triangles"),
                    _ => count(bad_before, "inverted or flat corner", "inverted or flat corners"),
                },
                count(sweeps as usize, "sweep", "sweeps"),
                count(moved, "vertex", "vertices"),
            );
        }
        text.trim_end().to_owned()
    }

    /// Returns the rows of the table of quality: the row's name, the value before, the value after.
    pub(crate) fn rows(&self) -> Vec<[String; 3]> {
        let base = self.base();
        let mut rows = Vec::new();
        let mut row = |name: &str, before, after| rows.push([name.to_owned(), before, after]);
        let mut metrics = vec![base];
        let is_ratio = |metric: Metric| metric.properties().is_inverse_mean_ratio;
        if !base.parse().is_ok_and(is_ratio) {
            metrics.push("imr");
        }
        let mut judges = |name: &str, before: f64, after: f64| {
            row(name, sig6(before), sig6(after));
            let [movable, now] = self.movable_f;
            if (movable - before).abs() > SEEN * before || (now - after).abs() > SEEN * after {
                row("  of movable", sig6(movable), sig6(now));
            }
        };
        if let Some(TargetReport { f: [before, after], .. }) = self.target {
            judges("f of targets", before, after);
            metrics = vec!["imr"];
        } else {
            judges(&format!("f {base}"), self.before.f[base], self.after.f[base]);
            metrics.remove(0);
        }
        for metric in metrics {
            row(&format!("f {metric}"), sig6(self.before.f[metric]), sig6(self.after.f[metric]));
        }
        let angle = |a: f64| format!("{a:.2}°");
        row("min angle", angle(self.before.min_angle), angle(self.after.min_angle));
        row("max angle", angle(self.before.max_angle), angle(self.after.max_angle));
        row("worst imr", sig6(self.before.worst_imr), sig6(self.after.worst_imr));
        // The value is 0 if no triangle has a free vertex.
        if self.has_worse_fixed() {
            let (before, after) = (self.before.worst_movable_imr, self.after.worst_movable_imr);
            row("  of movable", sig6(before), sig6(after));
        }
        let [before, after] = self.change.least_altitude;
        row("min altitude", sig6(before), sig6(after));
        row("inverted", self.before.inverted.to_string(), self.after.inverted.to_string());
        rows
    }

    /// Returns whether a triangle without a free vertex has the worst imr, before or after the run, so that the worst imr of
    /// movable triangles is another value. False if no triangle has a free vertex, as the value is then 0.
    fn has_worse_fixed(&self) -> bool {
        let is_worse = |quality: &QualityReport| quality.worst_movable_imr < quality.worst_imr;
        self.after.worst_movable_imr > 0.0 && (is_worse(&self.before) || is_worse(&self.after))
    }

    /// Returns a warning if the worst movable element became worse by more than 1 %; `None` otherwise.
    pub(crate) fn warning(&self) -> Option<String> {
        let worst = [self.before.worst_movable_imr, self.after.worst_movable_imr];
        let guard = if self.guards_worst { Guard::Worst } else { Guard::ByMetric };
        let rise = WorstRise::of(worst, &self.scheme.parse().ok()?, guard, self.target.is_some())?;
        let base = self.base();
        let mean = "f is a mean, which may fall as one element gets worse; --guard worst";
        let remedy = match rise.reason {
            RiseReason::JudgesNoShape => {
                format!("{base} does not judge shapes; --scheme imr or {base}+imr does")
            }
            RiseReason::GuardsTargets => {
                format!("{mean} bounds triangles as the target transforms them")
            }
            RiseReason::GuardsUnrounded => format!(
                "{mean} bounds triangles before their coordinates are rounded to the digits of the file"
            ),
            _ => format!("{mean} does not let it"),
        };
        let [before, after] = worst.map(sig6);
        let of = if self.has_worse_fixed() { " of movable triangles" } else { "" };
        Some(format!("worst imr{of} rose from {before} to {after}: {remedy}"))
    }

    /// Describes in one sentence how far vertices moved and how much sizes changed.
    pub(crate) fn moves(&self) -> String {
        let ChangeReport { moved, size, .. } = &self.change;
        if moved.most == 0.0 {
            return "no vertex moved".to_owned();
        }
        // Sizes in a mesh of bad elements are hardly intended.
        let is_sound = self.before.f["imr"] < SOUND;
        let has_large_change = size.p95 > LARGE_CHANGE;
        let keeps = match self.target.as_ref().map(|target| target.kind.as_str()) {
            None if is_sound && has_large_change => "; --target keep-size keeps sizes",
            Some("keep-size") if has_large_change && self.base() != Metric::Tmop80.name() => {
                "; --scheme tmop-80 keeps sizes closer, and --target keep-shape keeps the stretching of triangles"
            }
            _ => "",
        };
        format!(
            "vertices moved {:.2} edges (median), {:.2} (95 %), {:.2} (most); sizes around them changed by {}, {}, {}{keeps}",
            moved.median,
            moved.p95,
            moved.most,
            change_of(size.median),
            change_of(size.p95),
            change_of(size.most),
        )
    }

    /// Describes in one sentence how many vertices slid, and how lines and area changed; `None` without
    /// `--slide`.
    pub(crate) fn slides(&self) -> Option<String> {
        let slid = self.slid.as_ref()?;
        let SlideReport { vertices, moved, pairs, coincident, off, off_share, area_change, .. } =
            slid;
        let ends = stay_as_ends(slid.ends);
        let ends = ends.map(|clause| format!("; {clause}")).unwrap_or_default();
        let pairs = match (pairs, slid.has_weirs) {
            (0, _) => "",
            (1, false) => ", a periodic pair together",
            (n, false) => &format!(", {n} periodic pairs together"),
            (1, true) => ", a pair across a weir together",
            (n, true) => &format!(", {n} pairs across weirs together"),
        };
        let coincident = match coincident {
            0 => "",
            1 => ", a pair at the same place together",
            n => &format!(", {n} pairs at the same place together"),
        };
        let frozen = match slid.frozen {
            0 => "",
            1 => "; the bound on their distance from the lines of IN stopped one",
            n => &format!("; the bound on their distance from the lines of IN stopped {n}"),
        };
        let area = match 100.0 * area_change {
            change if change.abs() < 1e-9 => "stayed the same".to_owned(),
            change if change.abs() >= 0.005 => format!("changed by {change:+.2} %"),
            change if change.abs() >= 0.0005 => format!("changed by {change:+.3} %"),
            _ => "changed by less than 0.001 %".to_owned(),
        };
        let lines = match 100.0 * off_share {
            share if share < 1e-7 => "the lines stayed the same".to_owned(),
            share => format!(
                "the vertices stay on curves through the vertices of IN, and the edges between them are at most {} from \
                 the edges of IN ({} % of the length of an edge)",
                rough(*off),
                rough(share),
            ),
        };
        Some(format!(
            "{moved} of {vertices} vertices on lines slid along them{pairs}{coincident}{ends}{frozen}; {lines}; the area of the mesh {area}"
        ))
    }

    /// Returns a clause on the estimated distance of f from its limit, for the end of a sentence.
    fn left(&self) -> String {
        let f = self.movable_f[1];
        match self.remaining {
            // An estimate of 0.5 or more comes from a decay that has just begun.
            None | Some(0.5..) => "; more sweeps may gain more".into(),
            Some(left) if f < LEAST_SCALE => {
                format!("; f is estimated to be {:.1e} above its limit", left * LEAST_SCALE)
            }
            Some(left) => format!("; f is estimated to be {left:.1e} of itself above its limit"),
        }
    }

    /// Returns the reason why the run ended, if the run neither converged nor reached its goal; `None`
    /// otherwise.
    pub(crate) fn fell_short(&self) -> Option<String> {
        let is_done = match &self.goal {
            Some(goal) => goal.reached,
            None => self.stop == "converged" || self.nothing_to_do.is_some(),
        };
        (!is_done).then(|| self.ending())
    }

    /// Describes in one sentence why the run ended.
    pub(crate) fn ending(&self) -> String {
        if let Some(reason) = &self.nothing_to_do {
            return format!("nothing to do: {reason}; the mesh is written as it was");
        }
        let sweeps = match self.sweeps {
            1 => "1 sweep".to_owned(),
            n => format!("{n} sweeps"),
        };
        let newton = match self.newton_steps {
            0 => None,
            n => Some(format!("{n} with a Newton step")),
        };
        let corrected = match self.corrections {
            0 => None,
            n => Some(format!("{n} corrected from coarser levels")),
        };
        let with: Vec<String> = newton.into_iter().chain(corrected).collect();
        let sweeps = match with.is_empty() {
            true => sweeps,
            false => format!("{sweeps} ({})", with.join(", ")),
        };
        let held = match self.held_back {
            1 => "1 vertex".to_owned(),
            n => format!("{n} vertices"),
        };
        // The worst triangles may be improved without a sweep.
        let is_unchanged = self.change.moved.most == 0.0;
        let mut text = match (self.stop, &self.goal) {
            (stop, Some(goal)) => {
                let desired = sig6(goal.desired);
                let went = match goal.best_fraction {
                    beyond if beyond > 1.0 => format!("beyond f = {desired}"),
                    share => format!("{} % of the way to f = {desired}", percent(share)),
                };
                match (goal.reached, stop) {
                    (true, _) if self.sweeps == 0 => {
                        let low = format!("f is as low as the desired {desired} already");
                        let what = if is_unchanged { "nothing to do" } else { "no sweep" };
                        format!("{what}: {low}")
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
                    (false, "canceled") => format!("interrupted after {sweeps}, {went}"),
                    (false, _) => format!("not reached after {sweeps} (the most): {went}"),
                }
            }
            ("converged", None) if self.held_back > 0 => {
                format!("converged after {sweeps}; --guard worst keeps {held} from moving on")
            }
            ("converged", None) if self.imprecise => format!(
                "converged after {sweeps}, as far as single precision tells{}; --engine cpu has double precision",
                self.left()
            ),
            ("converged", None) => match self.projection_error {
                None => format!("converged after {sweeps}"),
                Some(error) => format!(
                    "converged after {sweeps} in the projection; on the sphere, f may be {error:.1e} of itself above its \
                     limit, as edges are long"
                ),
            },
            ("stalled", None) => format!("no more progress after {sweeps}{}", self.left()),
            ("held-back", None) => {
                format!("held back by the shape guard at {held} after {sweeps}")
            }
            ("time-limit", None) => format!("ended by --time-limit after {sweeps}{}", self.left()),
            ("not-finite", None) => format!("{NOT_FINITE}, after {sweeps}"),
            ("canceled", None) => format!("interrupted after {sweeps}; more may gain more"),
            (_, None) => {
                let left = self.left();
                let text = format!("stopped after {sweeps}, the most allowed (--max-sweeps){left}");
                match self.held_back {
                    0 => text,
                    _ => format!("{text}; the shape guard holds back {held}"),
                }
            }
        };
        if self.sweeps > 0 && self.best_sweep == 0 && is_unchanged {
            let but = if self.floored.is_some() { " without a worse triangle" } else { "" };
            let _ = write!(text, "; no gain{but}, so the mesh is written unchanged");
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
                "; the first {n} on the CPU, as triangles were too flat, small or stretched, or bounds in degrees too fine, for the GPU"
            );
        }
        if self.closing_sweeps > 0 {
            let n = self.closing_sweeps;
            let _ = write!(text, "; the last {n} on the CPU, in double precision");
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

/// Describes a factor of sizes: a change in percent, or a number of times.
pub(crate) fn change_of(factor: f64) -> String {
    match 100.0 * (factor - 1.0) {
        change if change < 99.5 => format!("{change:.0} %"),
        _ if factor < 1e5 => format!("{factor:.1} times"),
        // A mesh with a nearly flat triangle has factors of many digits.
        _ => format!("{factor:.0e} times"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_of_sizes_are_short() {
        let cases = [
            (1.25, "25 %"),
            (2.0, "2.0 times"),
            (8.47e4, "84700.0 times"),
            (1.236e67, "1e67 times"),
        ];
        for (factor, text) in cases {
            assert_eq!(change_of(factor), text);
        }
    }

    #[test]
    fn one_element_is_singular() {
        assert_eq!(elements(1, 2), "1 triangle, 2 quadrilaterals");
        assert_eq!([elements(2, 0), elements(0, 1)], ["2 triangles", "1 quadrilateral"]);
    }
}
