//! A run of a prepared mesh, from the check of its options to the end of its last stage.

use std::ops::ControlFlow;
use std::time::Duration;

use web_time::Instant;

use crate::cpu::objective;
use crate::error::{MeshError, SmoothError};
use crate::layout::Problem;
use crate::metric::Metric;
use crate::options::{Feature, Options};
use crate::outcome::{GoalOutcome, Outcome};
use crate::quality::Quality;
use crate::resume;
use crate::run::{
    Checkpoint, CheckpointPolicy, Checkpointer, Objectives, Observer, Phase, Plan, Progress,
    RunFingerprint, Stop, set_guards,
};
use crate::slide::Slide;
use crate::targets::TargetField;
use crate::whole::{Device, Place, Session, Spec, TargetFieldStage, bounded, drive};

use super::judging::JudgedBy;
use super::over_all::OverAll;
use super::prepared::Smoother;

/// Returns whether a run by the metric can begin at the mesh, where f is `objective`.
async fn is_usable(problem: &Problem, metric: Metric, objective: f64) -> bool {
    objective.is_finite() && !is_beyond_precision(problem, metric, objective).await
}

/// Returns whether a triangle that can move is so flat, or so small beside others, that the metric cannot judge it in
/// double precision. `objective` is f by the metric.
async fn is_beyond_precision(problem: &Problem, metric: Metric, objective: f64) -> bool {
    // Rounded areas have errors of some 1e-16 of the squared edges, so q² of such a triangle far exceeds this sum.
    const LEAST: f64 = 1e13;
    let beyond = problem.beyond_precision(problem.positions());
    if metric.properties().barrier {
        // Some metrics are negative where the rounded area is negative.
        let sum = objective.abs() * problem.judged_count() as f64;
        return sum > LEAST && !beyond.await.is_empty();
    }
    // The shape guard of EDGE would hold the vertices of such triangles.
    let can_move = |&t: &u32| problem.can_move(&problem.corners().all()[t as usize]);
    !metric.is_smooth() && beyond.await.iter().any(can_move)
}

/// Returns the objective at which a run reaches its goal, for a run that begins at the objective `initial`.
fn target_of(goal: &GoalOutcome, initial: f64) -> f64 {
    match goal.desired < initial {
        true => initial - goal.fraction * (initial - goal.desired),
        // The goal is reached from the start. The target is above f by a margin, as f on a device may be a little above
        // `initial`.
        false => 2.0 * initial + 1.0,
    }
}

impl Smoother<'_> {
    pub(super) async fn run_at(
        &self,
        options: &Options,
        device: Option<Device<'_>>,
        from: Option<&Checkpoint>,
        policy: &mut dyn CheckpointPolicy,
        observe: &mut dyn Observer,
    ) -> Result<Outcome, SmoothError> {
        let began = Instant::now();
        options.check_with(&self.features())?;
        self.check_movable()?;
        let is_for_device = self.problem.free_count() > 0 && !self.stays_on_cpu();
        let place = Place::given(device, is_for_device, self.size(), from, policy).await?;
        let problem = &bounded(
            self.judged_problem(),
            &self.mesh,
            &self.topology,
            options,
            self.storage(options),
        );
        let about = self.about(problem, options).await;
        let resumed =
            from.map(|from| resume::check(&about, from, problem).map(|()| from)).transpose()?;
        let base = options.scheme.base();
        let initial = objective(base, problem, problem.positions()).await;
        if !is_usable(problem, base, initial).await {
            return Err(self.refusal(problem, base).await?.into());
        }
        let over_all = OverAll::new(problem, &Plan::new(options).tracked()).await;
        let mut observe = |now: &Progress| match now.phase {
            // A search run may have another base metric.
            Phase::Reference => observe(now),
            _ => observe(&Progress { f: over_all.f(base, now.f), ..*now }),
        };
        let known = resumed.and_then(|resumed| resumed.about.goal.clone());
        let found = self.resolve_goal(&over_all, options, known, &place, policy, &mut observe);
        let ControlFlow::Continue(goal) = found.await? else {
            return Ok(self.unchanged(base, over_all.f(base, initial), began));
        };
        let aimed = goal.as_ref().map(|goal| (goal.desired, goal.origin.clone()));
        let about = Some(RunFingerprint { goal: aimed, ..about });
        let target = goal.as_ref().map(|goal| target_of(goal, initial));
        let mut plan = Plan::toward(options, target);
        let from = problem.positions();
        set_guards(&mut plan, options.guard, problem, from).await;
        let tolerance = options.stopping.tolerance();
        let stage = |field| TargetFieldStage::new(&self.mesh, field, tolerance);
        let field = self.field.as_ref().map(stage);
        if field.is_none() && resumed.is_some_and(|resumed| resumed.period.is_some()) {
            return Err(resume::foreign());
        }
        let curves = self.on_curves(options);
        let (phase, curves) = (Phase::Smoothing, curves.as_ref());
        let spec = Spec { problem, options, phase, from, curves, resumed };
        let checkpointer = Checkpointer::new(policy, about);
        let run = Session::new(spec, plan, place, field, checkpointer).await?;
        let ended = drive(run, &mut observe).await?;
        let judged = JudgedBy { over_all: &over_all, initial };
        let outcome = self.judged(options, judged, goal, ended, &mut observe).await?;
        Ok(Outcome { smooth: began.elapsed(), ..outcome })
    }

    /// Returns the error of a run by a metric that cannot judge the mesh, with the metrics that can.
    async fn refusal(&self, problem: &Problem, metric: Metric) -> Result<MeshError, MeshError> {
        let element = Quality::of(&self.mesh.points, &self.topology)?.worst;
        let mut usable = Vec::new();
        for &metric in Metric::ALL.iter() {
            let f = objective(metric, problem, problem.positions()).await;
            if is_usable(problem, metric, f).await {
                usable.push(metric.name());
            }
        }
        Ok(MeshError::BeyondPrecision { element, metric: metric.name(), usable })
    }

    /// Returns the description of a run with these options that its checkpoints carry.
    async fn about(&self, problem: &Problem, options: &Options) -> RunFingerprint {
        let of_slide = self.slide.as_ref().map(Slide::words);
        let of_field = self.field.as_ref().map(TargetField::words);
        let of_projection = self.problem.is_projected().then(|| vec![1]);
        let size_weight = self.problem.ideal().size_weight;
        let of_sizes = (size_weight != 1.0).then(|| vec![size_weight.to_bits()]);
        // Objectives in the checkpoints of earlier versions are means over all triangles.
        let judged = problem.judged_count();
        let of_judged = (judged < problem.corners().element_count()).then(|| vec![judged as u64]);
        let words = of_slide.into_iter().chain(of_field).chain(of_projection).chain(of_sizes);
        let words = words.chain(of_judged);
        let more: Vec<u64> = words.flatten().collect();
        resume::about(&self.mesh, self.problem.targets(), &more, options).await
    }

    /// Returns the features that the mesh, targets and curves of this smoother give to a run.
    fn features(&self) -> Vec<Feature> {
        Feature::present([
            (Feature::Slide, self.sliding.is_some()),
            (Feature::Targets, self.problem.targets().is_some()),
            (Feature::TargetField, self.field.is_some()),
        ])
    }

    /// Returns the outcome of a run that was canceled before its first sweep.
    fn unchanged(&self, base: Metric, f: f64, start: Instant) -> Outcome {
        let mut objectives = Objectives::empty();
        objectives.set(base, f);
        Outcome {
            points: self.mesh.points.clone(),
            stop: Stop::Canceled,
            sweeps: 0,
            alternated: 0,
            corrections: 0,
            newton_steps: 0,
            newton_iterations: 0,
            opening_sweeps: 0,
            closing_sweeps: 0,
            levels_left_out: false,
            levels: Duration::ZERO,
            best_sweep: 0,
            remaining: None,
            projection_error: 0.0,
            held_back: 0,
            lost: 0.0,
            history: vec![objectives],
            movable_f: [f; 2],
            goal: None,
            returned: 0,
            slid: None,
            floored: None,
            large_angles: None,
            improved: None,
            device_fault: None,
            smooth: start.elapsed(),
        }
    }
}
