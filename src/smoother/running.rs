//! A run of a prepared mesh, from the check of its options to the end of its last stage.

use std::time::Duration;

use web_time::Instant;

use crate::error::{MeshError, SmoothError};
use crate::layout::Problem;
use crate::metric::Metric;
use crate::options::{Feature, Goal, Options};
use crate::outcome::{DeviceFault, GoalOutcome, Outcome};
use crate::quality::Quality;
use crate::resume;
use crate::run::{
    Checkpoint, CheckpointPolicy, Checkpointer, Objectives, Observer, Phase, Plan, Progress,
    RunFingerprint, Stop, set_guards,
};
use crate::slide::Slide;
use crate::targets::TargetField;
use crate::whole::{Device, Live, Spec, TargetFieldStage, bounded, drive};

use super::judging::JudgedBy;
use super::over_all::OverAll;
use super::prepared::{Smoother, objective};

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
        let sum = objective.abs() * problem.judged_triangles().len() as f64;
        return sum > LEAST && !beyond.await.is_empty();
    }
    // The shape guard of EDGE would hold the vertices of such triangles.
    let can_move = |&t: &u32| problem.can_move(&problem.triangles()[t as usize]);
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
        let device = device.filter(|_| self.problem.free_count() > 0);
        let device = device.filter(|_| !self.slides_on_cpu());
        let (device, fault) = self.checked(device, policy).await?;
        let problem = &bounded(self.judged_problem(), &self.mesh, &self.topology, options);
        let mut about = self.about(problem, options).await;
        let resumed =
            from.map(|from| resume::check(&about, from, problem).map(|()| from)).transpose()?;
        let base = options.scheme.base();
        let initial = objective(problem, base, problem.positions()).await;
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
        let goal = match (options.stopping.goal(), known) {
            (Some(Goal { fraction, .. }), Some((desired, origin))) => {
                Some(GoalOutcome { fraction, desired, origin, best_fraction: 0.0 })
            }
            (Some(goal), None) => {
                let found =
                    self.resolve_goal(&over_all, goal, options, device, policy, &mut observe);
                match found.await? {
                    Some(aimed) => Some(aimed),
                    None => return Ok(self.unchanged(base, over_all.f(base, initial), began)),
                }
            }
            (None, _) => None,
        };
        let target = goal.as_ref().map(|goal| target_of(goal, initial));
        about.goal = goal.as_ref().map(|goal| (goal.desired, goal.origin.clone()));
        let mut checkpointer = Checkpointer::new(policy);
        let mut plan = Plan::toward(options, target);
        let start = problem.positions();
        set_guards(&mut plan, options.guard, problem, start).await;
        let tolerance = options.stopping.tolerance();
        let stage = |field| TargetFieldStage::new(&self.mesh, field, tolerance);
        let mut stage = self.field.as_ref().map(stage);
        let curves = self.on_curves(options);
        checkpointer.about = Some(about);
        let (phase, has_field) = (Phase::Smoothing, stage.is_some());
        let spec = Spec { problem, device, options, phase, has_field, curves: curves.as_ref() };
        let period = resumed.and_then(|resumed| resumed.period.as_ref());
        if period.is_some() && !has_field {
            return Err(resume::foreign());
        }
        let live = Live::new(spec, plan, start, resumed, &mut checkpointer).await?;
        let ended = drive(live, stage.as_mut(), &mut checkpointer, &mut observe, period).await?;
        let judged = JudgedBy { over_all: &over_all, initial };
        let outcome = self.judged(options, judged, goal, ended, &mut observe).await?;
        let device_fault = fault.or(outcome.device_fault);
        Ok(Outcome { device_fault, smooth: began.elapsed(), ..outcome })
    }

    /// Returns the error of a run by a metric that cannot judge the mesh, with the metrics that can.
    async fn refusal(&self, problem: &Problem, metric: Metric) -> Result<MeshError, MeshError> {
        let triangle = Quality::of(&self.mesh.points, &self.topology)?.worst_triangle;
        let mut usable = Vec::new();
        for &metric in Metric::ALL.iter() {
            let f = objective(problem, metric, problem.positions()).await;
            if is_usable(problem, metric, f).await {
                usable.push(metric.name());
            }
        }
        Ok(MeshError::BeyondPrecision { triangle, metric: metric.name(), usable })
    }

    /// Returns the description of a run with these options that its checkpoints carry.
    async fn about(&self, problem: &Problem, options: &Options) -> RunFingerprint {
        let of_slide = self.slide.as_ref().map(Slide::words);
        let of_field = self.field.as_ref().map(TargetField::words);
        let of_projection = self.problem.is_projected().then(|| vec![1]);
        let size_weight = self.problem.ideal().size_weight;
        let of_sizes = (size_weight != 1.0).then(|| vec![size_weight.to_bits()]);
        // Objectives in the checkpoints of earlier versions are means over all triangles.
        let judged = problem.judged_triangles().len();
        let of_judged = (judged < problem.triangles().len()).then(|| vec![judged as u64]);
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

    /// Returns the device on which a run begins, after checks that the mesh fits the device and that its arithmetic
    /// keeps all digits. If the device drops digits, `policy` may let the run begin on the CPU.
    async fn checked<'g>(
        &self,
        device: Option<Device<'g>>,
        policy: &mut dyn CheckpointPolicy,
    ) -> Result<(Option<Device<'g>>, Option<DeviceFault>), SmoothError> {
        let Some(checked) = device else { return Ok((None, None)) };
        checked.check_size(self.size())?;
        match checked.check_arithmetic().await {
            Ok(()) => Ok((device, None)),
            Err(error) if policy.falls_back_to_cpu(&error, 0) => {
                Ok((None, Some(DeviceFault { sweep: 0, error })))
            }
            Err(error) => Err(error.into()),
        }
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
            improved: None,
            device_fault: None,
            smooth: start.elapsed(),
        }
    }
}
