//! The assessment of a run: its final positions as coordinates that can be stored, and the gain of the run there.

use std::mem::take;
use std::time::Duration;

use glam::DVec2;

use crate::cpu::objective;
use crate::error::{MeshError, SmoothError};
use crate::layout::Problem;
use crate::metric::{Corner, Ideal, Metric};
use crate::options::{Guard, Options};
use crate::outcome::{Floored, GoalOutcome, Improved, LargeAngles, Outcome, Slid};
use crate::parallel::paced;
use crate::quality::Quality;
use crate::run::{
    JITTER, MIN_SCALE, NOISE, Observer, Phase, Plan, Progress, ROUNDING, Stop, set_guards,
};
use crate::slide::{OnCurves, Sliding};
use crate::targets::Surface;
use crate::topology::predicates::orientation;
use crate::whole::altitude::{self, Limits};
use crate::whole::{Improvement, RunEnd};

use super::large_angles::RoundLimits;
use super::over_all::OverAll;
use super::prepared::Smoother;
use super::rounds::Present;

/// Number of points that one task rounds, and of triangles that one task measures.
const CHUNK: usize = 1 << 14;

/// What judges a run: its objective, and the objective before the first sweep.
#[derive(Clone, Copy)]
pub(super) struct JudgedBy<'r> {
    pub(super) over_all: &'r OverAll<'r>,
    /// Objective of the problem by the base metric before the first sweep.
    pub(super) initial: f64,
}

/// Returns f by a metric after a sweep of a run that has ended.
fn f_after(ended: &RunEnd, metric: Metric, sweep: usize) -> f64 {
    ended.history[sweep].of(metric).unwrap_or(f64::INFINITY)
}

/// Returns the sweep after which f was least.
fn best_sweep(ended: &RunEnd, options: &Options) -> usize {
    let f = |k: usize| f_after(ended, options.scheme.base(), k);
    let evaluations = ended.history.len();
    match Plan::new(options).is_monotone() {
        true => evaluations - 1,
        false => (0..evaluations).fold(0, |best, k| if f(k) < f(best) { k } else { best }),
    }
}

/// Returns how far a run has come toward its goal, from the objective `initial` to `best`.
fn came_to(
    goal: GoalOutcome,
    options: &Options,
    over_all: &OverAll<'_>,
    [initial, best]: [f64; 2],
) -> GoalOutcome {
    // The desired objective may be no lower than the initial one.
    let best_fraction = match goal.desired < initial {
        true => (initial - best) / (initial - goal.desired),
        false => 1.0,
    };
    let given = options.stopping.goal().and_then(|goal| goal.desired);
    let desired = given.unwrap_or_else(|| over_all.f(options.scheme.base(), goal.desired));
    GoalOutcome { best_fraction, desired, ..goal }
}

/// The result of a run as it is stored. Objectives are by the base metric of the run.
struct Stored {
    points: Vec<[f64; 2]>,
    /// Normalized positions of the points.
    at: Vec<DVec2>,
    /// Layout of the mesh, with the targets at the points.
    problem: Problem,
    curves: Option<OnCurves>,
    /// Number of vertices that were set back.
    returned: usize,
    improving: Option<Improvement>,
    floored: Option<Floored>,
    large_angles: Option<LargeAngles>,
    /// Number of vertices that moved, before the floor.
    moved: usize,
    /// f before rounding, as the engine of the last sweep computed it, and in double precision.
    swept: f64,
    exact: f64,
    /// f at the points before the floor, and at the points that the floor has raised.
    rounded: f64,
    written: f64,
}

impl Stored {
    /// Returns the share of the gain on `initial` that was lost because coordinates are rounded and vertices were set back.
    fn lost(&self, initial: f64) -> f64 {
        // In a smaller gain, the errors of f on a device would be a considerable share.
        match initial - self.swept > 100.0 * JITTER * initial {
            true => ((self.rounded - self.swept) / (initial - self.swept)).clamp(0.0, 1.0),
            false => 0.0,
        }
    }

    /// Returns the error of the f that the engine computed, as a share of f. A device sums in single precision, and so
    /// cannot find a gain below this error.
    fn error(&self) -> f64 {
        match self.improving {
            None => (self.exact - self.swept).abs() / self.written.max(MIN_SCALE),
            Some(_) => 0.0,
        }
    }
}

impl Smoother<'_> {
    /// Converts the final positions of the sweeps to coordinates, and evaluates the result. Rounding, and vertices that
    /// were set back, may have cost more than the sweeps gained. A device also moves the vertices of an optimal mesh by
    /// its own rounding. If nothing was gained on `initial`, the mesh is returned unchanged.
    pub(super) async fn judged(
        &self,
        options: &Options,
        by: JudgedBy<'_>,
        goal: Option<GoalOutcome>,
        mut ended: RunEnd,
        observe: &mut dyn Observer,
    ) -> Result<Outcome, SmoothError> {
        let base = options.scheme.base();
        let best_sweep = best_sweep(&ended, options);
        let swept = f_after(&ended, base, best_sweep);
        let mut stored = self.stored(options, by, swept, &mut ended, observe).await?;
        let JudgedBy { over_all, initial } = by;
        let gains = self.gains(base, initial, &stored).await?;
        if !gains {
            stored.points.clone_from(&self.mesh.points);
            stored.returned = 0;
            let (moved, f) = (stored.moved, over_all.f(base, initial));
            stored.floored = stored.floored.map(|floored| floored.undone(moved, f));
            stored.large_angles = None;
        }
        let projection_error = self.projection_error(&stored.points).await;
        let best = if gains { stored.written } else { initial };
        let improved = self.improvement(&stored, over_all, base, best, gains).await;
        let least = base.least_objective(stored.problem.mean_varies());
        let possible = (best - least).max(0.0) / best.max(MIN_SCALE);
        let (lost, error) = (stored.lost(initial), stored.error());
        let Stored { points, curves, returned, floored, large_angles, .. } = stored;
        Ok(Outcome {
            stop: ended.stop,
            sweeps: ended.history.len() as u32 - 1,
            alternated: ended.counts.alternated,
            corrections: ended.counts.corrections,
            newton_steps: ended.counts.newton_steps,
            newton_iterations: ended.counts.newton_iterations,
            opening_sweeps: ended.opening_sweeps,
            closing_sweeps: ended.closing_sweeps,
            levels_left_out: ended.counts.levels_left_out,
            levels: ended.counts.levels,
            best_sweep: if gains { best_sweep as u32 } else { 0 },
            // A decay that has just begun may promise more than the distance between f and its lower limit.
            remaining: ended
                .remaining
                .map(|left| left.max(error).max(projection_error).min(possible)),
            projection_error,
            held_back: ended.held_back,
            lost,
            history: ended.history.iter().map(|now| over_all.objectives(*now)).collect(),
            movable_f: [initial, best],
            goal: goal.map(|goal| came_to(goal, options, over_all, [initial, best])),
            returned,
            slid: curves.as_ref().map(|curves| self.slid(curves, &points)),
            floored,
            large_angles,
            improved,
            device_fault: ended.fault,
            smooth: Duration::ZERO,
            points,
        })
    }

    /// Improves the worst triangles if the options ask for that, converts the positions to coordinates as they are stored,
    /// and raises the result to the floor. `swept` is f of the best sweep.
    async fn stored(
        &self,
        options: &Options,
        JudgedBy { over_all, initial }: JudgedBy<'_>,
        swept: f64,
        ended: &mut RunEnd,
        observe: &mut dyn Observer,
    ) -> Result<Stored, SmoothError> {
        let base = options.scheme.base();
        let mut problem = over_all.problem.clone();
        self.set_targets_at(&mut problem, &ended.positions)?;
        let (improving, points, returned) =
            self.improved(options, &problem, ended, observe).await?;
        let swept = improving.as_ref().map_or(swept, |improving| improving.f[1]);
        // Rounding for the file, and vertices that were set back, are no error of the f of the sweeps.
        let is_as_swept =
            returned == 0 && self.sliding.is_none() && self.storage(options).is_exact();
        let before = match is_as_swept {
            true => None,
            false => Some(objective(base, &problem, &ended.positions).await),
        };
        let at = self.problem.normalized(&points, take(&mut ended.positions)).await;
        self.set_targets_at(&mut problem, &at)?;
        let rounded = objective(base, &problem, &at).await;
        let moved = self.moved(&points);
        let mut stored = Stored {
            points,
            at,
            problem,
            curves: ended.curves.take(),
            returned,
            improving,
            floored: None,
            large_angles: None,
            moved,
            swept,
            exact: before.unwrap_or(rounded),
            rounded,
            written: rounded,
        };
        if self.finished(options, initial, &mut stored, ended, observe).await? {
            let f = [stored.rounded, stored.written].map(|f| over_all.f(base, f));
            stored.floored = stored.floored.map(|floored| Floored { f, ..floored });
            stored.large_angles = stored.large_angles.map(|large| LargeAngles { f, ..large });
        }
        Ok(stored)
    }

    /// Returns whether a run has gained on the mesh, where f is `initial`: in f, or in its worst triangle.
    async fn gains(&self, base: Metric, initial: f64, stored: &Stored) -> Result<bool, MeshError> {
        let Stored { points, at, problem, improving, written, .. } = stored;
        let is_lower = initial - written > NOISE * initial + ROUNDING;
        if is_lower && self.is_lower(base, points).await? {
            return Ok(true);
        }
        Ok(match improving {
            Some(improving) => improving.is_better(problem, at).await,
            None => false,
        })
    }

    /// Returns the result of the improvement of the worst triangles, if the options ask for that. `best` is f of the outcome,
    /// which has the stored points if the run `gains`.
    async fn improvement(
        &self,
        stored: &Stored,
        over_all: &OverAll<'_>,
        base: Metric,
        best: f64,
        gains: bool,
    ) -> Option<Improved> {
        let Stored { at, problem, improving, .. } = stored;
        let slides = self.sliding.as_deref().map(Sliding::vertices).unwrap_or_default();
        let positions = if gains { at } else { self.problem.positions() };
        let improved = improving.as_ref()?.outcome(problem, positions, best, &slides, gains).await;
        Some(Improved { f: improved.f.map(|f| over_all.f(base, f)), ..improved })
    }

    /// Improves the worst triangles if the options ask for that, and returns the improvement, the points as they are stored, and
    /// the number of vertices set back. An improvement that storing undoes is dropped.
    async fn improved(
        &self,
        options: &Options,
        problem: &Problem,
        ended: &mut RunEnd,
        observe: &mut dyn Observer,
    ) -> Result<(Option<Improvement>, Vec<[f64; 2]>, usize), SmoothError> {
        let before_stage = match options.improve_worst {
            Some(_) => paced::copied(&ended.positions).await,
            None => Vec::new(),
        };
        let mut improving = Improvement::after(ended, options, problem, observe).await;
        let curves = ended.curves.as_ref();
        let (points, returned) = self.as_stored(options, curves, &ended.positions).await?;
        let Some(stage) = &mut improving else { return Ok((None, points, returned)) };
        let without = self.as_stored(options, curves, &before_stage).await?;
        let old = self.problem.normalized(&without.0, Vec::new()).await;
        let new = self.problem.normalized(&points, Vec::new()).await;
        if stage.holds_as_stored(problem, &old, &new).await {
            return Ok((improving, points, returned));
        }
        ended.positions = before_stage;
        Ok((improving, without.0, without.1))
    }

    /// Raises the result to the floor if a measure has become worse, and lessens large angles after a run by ACUTE, but not
    /// beyond `initial`, f before the run. Returns whether either has been done.
    async fn finished(
        &self,
        options: &Options,
        initial: f64,
        stored: &mut Stored,
        ended: &mut RunEnd,
        observe: &mut dyn Observer,
    ) -> Result<bool, MeshError> {
        let Stored { points, at, problem, curves, improving, rounded, written, .. } = stored;
        let floor = self.lacking_floor(options, points).await;
        let (was_canceled, sweep) = (ended.stop == Stop::Canceled, ended.history.len() as u32 - 1);
        let now = Progress { phase: Phase::Improving, sweep, f: *rounded };
        // A canceled run ends soon, but not with a worse triangle than before.
        let goes_on = || {
            let goes_on = was_canceled || observe(&now).is_continue();
            if !goes_on {
                ended.stop = Stop::Canceled;
            }
            goes_on
        };
        match floor {
            Some(floor) => {
                let curves = curves.as_mut();
                let raised = floor.raise(options, problem, curves, at, points, goes_on).await?;
                stored.floored = Some(raised);
            }
            None if was_canceled => return Ok(false),
            None => {
                let present = Present { problem, curves: curves.as_mut(), positions: at, points };
                let limits = RoundLimits { most: initial, improving: improving.as_ref() };
                let lessened = self.lessen_large_angles(options, limits, present, goes_on);
                stored.large_angles = lessened.await?;
            }
        }
        if stored.floored.is_none() && stored.large_angles.is_none() {
            return Ok(false);
        }
        *at = self.problem.normalized(points, take(at)).await;
        *written = objective(options.scheme.base(), problem, at).await;
        Ok(true)
    }

    /// Returns the number of vertices whose points differ from the mesh.
    fn moved(&self, points: &[[f64; 2]]) -> usize {
        points.iter().zip(&self.mesh.points).filter(|(to, from)| to != from).count()
    }

    /// Returns the points of normalized positions as they are stored: in the unit of the mesh, rounded, and with vertices set
    /// back until no triangle is inverted or breaks the bound of altitudes. Returns the number of vertices set back too.
    async fn as_stored(
        &self,
        options: &Options,
        curves: Option<&OnCurves>,
        positions: &[DVec2],
    ) -> Result<(Vec<[f64; 2]>, usize), MeshError> {
        let mut points = self.problem.in_unit_of(&self.mesh, positions).await;
        // Normalized positions do not hold all digits of the points on curves.
        for (v, point) in curves.iter().flat_map(|curves| curves.moved()) {
            points[v as usize] = point;
        }
        let storage = self.storage(options);
        if !storage.is_exact() {
            paced::for_each_chunk(&mut points, CHUNK, |first, points| {
                for (v, point) in (first..).zip(points) {
                    *point = storage.rounded(v, *point);
                }
            })
            .await;
        }
        let stored = Some(storage);
        let mut returned = self.certified(&mut points, stored).await?;
        // If one vertex of a pair is set back, so is its partner, which may make another triangle too flat.
        let guards_all = options.guard == Guard::Worst;
        let mut restored = usize::from(options.keep_altitude || guards_all);
        let guard = if restored > 0 { self.final_guard(options).await } else { f64::INFINITY };
        let limits = Limits { keeps_altitude: options.keep_altitude, guard, guards_all };
        while restored > 0 {
            restored = altitude::restore(&self.topology, &self.mesh.points, &mut points, limits);
            returned += restored + self.certified(&mut points, stored).await?;
        }
        Ok((points, returned))
    }

    /// Returns the result of sliding in a run that ended at `points`.
    fn slid(&self, curves: &OnCurves, points: &[[f64; 2]]) -> Slid {
        let (before, free) = (&self.mesh.points, self.topology.free());
        let moved = (0..free.len()).filter(|&v| !free[v] && points[v] != before[v]).count();
        let area = |points: &[[f64; 2]]| {
            let of = |t: &[u32; 3]| orientation(points, t);
            let corners = self.topology.corner_list();
            let of_triangles = corners.triangles().iter().map(of).sum::<f64>();
            // The corners of a quadrilateral have twice its area.
            of_triangles + 0.5 * corners.of_quadrilaterals().iter().map(of).sum::<f64>()
        };
        let sliding = curves.sliding();
        let [off, off_share] = sliding.off(&sliding.with_returned(curves.params(), before, points));
        Slid {
            vertices: sliding.count(),
            moved,
            pairs: sliding.pairs()[0],
            coincident: sliding.coincident()[0],
            frozen: curves.frozen(),
            off,
            off_share,
            area: area(points) / area(before) - 1.0,
        }
    }

    /// Returns whether f by a metric, with the areas of the vertices at `points`, is lower than f of the mesh. A run
    /// divides areas by the mean area at its start, and sliding vertices change the mean area. Areas that are errors of
    /// rounding depend on the unit of positions too. With targets, sizes are absolute, and the result is true.
    async fn is_lower(&self, metric: Metric, points: &[[f64; 2]]) -> Result<bool, MeshError> {
        let is_exact = metric.properties().barrier && metric.is_scale_invariant();
        if is_exact || self.problem.targets().is_some() || self.field.is_some() {
            return Ok(true);
        }
        let f = async |points: &[[f64; 2]]| {
            let images = self.problem.images(points);
            let quality = Quality::with_pauses(Surface::Plane, &images, &self.topology);
            quality.await.map(|quality| quality.f(metric))
        };
        Ok(f(points).await? < f(&self.mesh.points).await?)
    }

    /// Returns an upper estimate, as a share of f, of the distance between the optimum in the projection of a sphere and
    /// the optimum on the sphere; 0 without a projection. With vertices at `points`, f by the inverse mean ratio in the
    /// projection differs from f on the sphere, where triangles are measured at their centers. At the other optimum, the
    /// difference is about as large, and the estimate is twice the difference. Only elements with a free vertex count.
    async fn projection_error(&self, points: &[[f64; 2]]) -> f64 {
        if !self.problem.is_projected() {
            return 0.0;
        }
        let images = self.problem.images(points);
        let square = |is_right: bool, points: &[[f64; 2]], t: &[u32; 3], lengths: [f64; 2]| {
            let [p, q, r] = t.map(|v| DVec2::from(points[v as usize]) * DVec2::from(lengths));
            let corner =
                Corner { a: (q - p).into(), b: (r - p).into(), ideal: Ideal::of_area(1.0) };
            match is_right {
                true => 0.25 * corner.of_right_angle().inverse_mean_ratio().powi(2),
                false => corner.inverse_mean_ratio().powi(2),
            }
        };
        let squares = |is_right: bool, corners: &[[u32; 3]]| {
            let movable =
                corners.iter().filter(|t| t.iter().any(|&v| self.topology.free()[v as usize]));
            movable.fold([0.0; 2], |[on_sphere, projected], t| {
                let lengths = Surface::Sphere.lengths_in(points, t);
                let s = square(is_right, points, t, lengths);
                let p = square(is_right, &images, t, [1.0; 2]);
                [on_sphere + s, projected + p]
            })
        };
        let corners = self.topology.corner_list();
        let triangles = corners.triangles().chunks(CHUNK).map(|part| (false, part));
        let right = corners.of_quadrilaterals().chunks(CHUNK).map(|part| (true, part));
        let parts: Vec<_> = triangles.chain(right).collect();
        let sums = paced::map_parts(parts, |_, (is_right, part)| squares(is_right, part)).await;
        let [on_sphere, projected] =
            [0, 1].map(|k| sums.iter().map(|part: &[f64; 2]| part[k]).sum::<f64>());
        let share = 2.0 * (on_sphere - projected).abs() / on_sphere;
        if share.is_finite() { share } else { 0.0 }
    }

    /// Returns the largest inverse mean ratio that the guard of a run allows; infinite without a guard. Also infinite
    /// with targets and in a projection, where the guard applies to transformed triangles.
    async fn final_guard(&self, options: &Options) -> f64 {
        if self.problem.targets().is_some() || self.problem.is_projected() {
            return f64::INFINITY;
        }
        let mut plan = Plan::new(options);
        set_guards(&mut plan, options.guard, &self.problem, self.problem.positions()).await;
        // The reserve of sweeps is for positions that are rounded afterwards.
        if options.guard == Guard::Worst {
            plan.worst_guard
        } else {
            plan.base_step(1.0).shape_guard
        }
    }
}
