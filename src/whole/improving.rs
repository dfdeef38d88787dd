//! Improves the worst triangles after the sweeps of a run, and evaluates the gain.

use glam::DVec2;

use crate::cpu::objective;
use crate::layout::Problem;
use crate::options::{Options, WorstBy};
use crate::outcome::Improved;
use crate::run::{NOISE, Observer, Phase, Plan, Progress, Stop};
use crate::whole::altitude;
use crate::whole::end::RunEnd;
use crate::worst::{Badness, MoveConstraints, Passes, stuck, worst_movable};

/// Share by which rounding may raise the worst inverse mean ratio.
const ROUNDING: f64 = 1e-9;
/// Share of the gain of the stage that later moves must leave. Rounding of stored coordinates takes a little, and limits on shapes
/// hold no angle exactly.
const KEPT: f64 = 0.9;

/// The result of the stage that improves the worst triangles, evaluated at the coordinates as they are written.
pub(crate) struct Improvement {
    badness: Badness,
    /// Number of vertices that the stage moved.
    vertices: usize,
    /// Largest badness of a movable triangle before the stage, at positions as they are stored. Infinite until
    /// [`holds_as_stored`](Self::holds_as_stored) evaluates it.
    worst: f64,
    /// The same after the stage.
    reached: f64,
    /// Largest inverse mean ratio of a movable triangle before the stage, which the stage allows.
    shape: f64,
    /// Objective by the base metric at the start and at the end of the stage.
    pub(crate) f: [f64; 2],
}

impl Improvement {
    /// Improves the worst triangles of a mesh after a run. `None` if [`Options::improve_worst`] is `None`, or if the
    /// run was canceled or failed. If the observer ends the stage, the run counts as
    /// canceled.
    pub(crate) async fn after(
        ended: &mut RunEnd,
        options: &Options,
        problem: &Problem,
        observe: &mut dyn Observer,
    ) -> Option<Self> {
        let badness = Badness(options.improve_worst?);
        if matches!(ended.stop, Stop::Canceled | Stop::NotFinite) {
            return None;
        }
        let base = options.scheme.base();
        let sweep = ended.history.len() as u32 - 1;
        let RunEnd { positions, stop, .. } = ended;
        let before = objective(base, problem, positions).await;
        let worst_shape = worst_movable(problem, Badness(WorstBy::Imr), positions).await;
        let rules = MoveConstraints {
            badness,
            step: Plan::new(options).base_step(1.0),
            shape: worst_shape.sqrt() * (1.0 + ROUNDING),
            least_altitude: if options.keep_altitude { altitude::least_of(problem) } else { 0.0 },
            bounds: problem.radii(),
            heavy: None,
        };
        let mut passes = Passes::new(problem, &rules, positions).await;
        let mut f = before;
        loop {
            if observe(&Progress { phase: Phase::Improving, sweep, f }).is_break() {
                *stop = Stop::Canceled;
                break;
            }
            let is_last = !passes.next(positions).await;
            f = objective(base, problem, positions).await;
            if is_last {
                break;
            }
        }
        let vertices = passes.moved();
        let [worst, reached] = [f64::INFINITY; 2];
        Some(Self { badness, vertices, worst, reached, shape: rules.shape, f: [before, f] })
    }

    /// Compares the worst triangle at positions as they are stored, without the stage and with it. If the stage has not made
    /// the worst triangle better, because rounding costs more than the stage gained, the stage counts as undone, and the result
    /// is false.
    pub(crate) async fn holds_as_stored(
        &mut self,
        problem: &Problem,
        without: &[DVec2],
        with: &[DVec2],
    ) -> bool {
        self.worst = worst_movable(problem, self.badness, without).await;
        self.reached = worst_movable(problem, self.badness, with).await;
        let holds = self.vertices > 0 && self.reached < self.worst;
        if !holds {
            (self.vertices, self.f[1], self.reached) = (0, self.f[0], self.worst);
        }
        holds
    }

    /// Returns whether [`KEPT`] of the gain of the worst triangle is left at positions to which vertices have gone since, and no
    /// inverse mean ratio exceeds the limit of the stage.
    pub(crate) async fn holds_at(&self, problem: &Problem, positions: &[DVec2]) -> bool {
        let now = worst_movable(problem, self.badness, positions).await;
        let shape = worst_movable(problem, Badness(WorstBy::Imr), positions).await;
        now <= self.worst - KEPT * (self.worst - self.reached) && shape.sqrt() <= self.shape
    }

    /// Returns the largest inverse mean ratio and the least altitude, in normalized units, of triangles that later moves may
    /// leave.
    pub(crate) fn limits(&self) -> [f64; 2] {
        match self.badness.0 {
            WorstBy::Imr => [self.reached.sqrt() * (1.0 + ROUNDING), 0.0],
            WorstBy::MinAngle => [self.shape, 0.0],
            WorstBy::Altitude => [self.shape, self.reached.sqrt().recip() * (1.0 - ROUNDING)],
        }
    }

    /// Returns whether the worst triangle is better than in the mesh before the run.
    pub(crate) async fn is_better(&self, problem: &Problem, positions: &[DVec2]) -> bool {
        if self.vertices == 0 {
            return false;
        }
        let now = worst_movable(problem, self.badness, positions).await;
        now < worst_movable(problem, self.badness, problem.positions()).await * (1.0 - NOISE)
    }

    /// Returns the outcome of the stage, with the vertices at `positions` as they are written, and `f` the objective
    /// there. If `is_written` is false, `positions` are those before the run, and the stage has changed nothing.
    /// `slides` are the sliding vertices as indices in the problem, in ascending order.
    pub(crate) async fn outcome(
        &self,
        problem: &Problem,
        positions: &[DVec2],
        f: f64,
        slides: &[u32],
        is_written: bool,
    ) -> Improved {
        let now = worst_movable(problem, self.badness, positions).await;
        let stuck = stuck(problem, self.badness, positions, slides).await;
        let [now, before] = [now, self.worst].map(|worst| self.badness.meaning(worst, problem));
        let by = self.badness.0;
        match is_written {
            true => {
                let Self { vertices, f: [start, _], .. } = *self;
                Improved { by, vertices, worst: [before, now], stuck, f: [start, f] }
            }
            false => Improved { by, vertices: 0, worst: [now; 2], stuck, f: [f; 2] },
        }
    }
}
