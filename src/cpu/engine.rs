//! The CPU engine, in double precision. Tests compare the GPU engine with it.
//!
//! Colors, steps and the stop rule are those of the GPU engine.

use std::borrow::Cow;

use glam::{DVec2, Vec2};

use crate::cpu::along::{Along, broken, nearest};
use crate::cpu::disc_tangents::DiscTangents;
use crate::cpu::objective::{mean_excess_along, mean_model, objective, objectives};
use crate::cpu::secants::{Levels, Secants, dot};
use crate::cpu::truncated::Truncated;
use crate::cpu::{sweep, vcycle};
use crate::error::GpuError;
use crate::layout::Problem;
use crate::metric::{Metric, Smoothing, TargetMap};
use crate::parallel::paced;
use crate::run::multilevel::Hierarchy;
use crate::run::truncated::{NewtonStep, StepRequest};
use crate::run::{
    CPU, EXCLUSION_PASSES, Engine, EngineState, GoesOn, History, NOISE, Objectives, Plan, Proposal,
    SweepParams,
};
use crate::slide::{OnCurves, Params};

/// Number of vertices that one task handles.
const CHUNK: usize = 1 << 12;

/// State of a run on the CPU.
pub(crate) struct CpuEngine {
    problem: Problem,
    base: Metric,
    tracked: Vec<Metric>,
    /// The step of the base metric. Corrections use its shape guard, and its exponent and penalty, which
    /// [`Engine::sweep_and_propose`] updates for each correction.
    step: SweepParams,
    positions: Vec<DVec2>,
    /// The vertices that slide along curves. `None` if no vertex slides.
    curves: Option<OnCurves>,
    /// The best state so far. `None` if every sweep of the plan lowers f, so that the last state is the best.
    best: Option<Best>,
    /// Scratch memory: positions of vertices after a visit or a trial.
    moved: Vec<DVec2>,
    /// The mesh prepared for Newton steps of all vertices. `None` before the first step.
    truncated: Option<Truncated>,
    hierarchy: Option<Hierarchy>,
    gradient: Vec<Vec2>,
    /// Tangents of discs along which the last correction moves vertices.
    tangents: DiscTangents,
    /// The last correction: a displacement of each free vertex at step length 1.
    direction: Vec<Vec2>,
    secants: Option<Secants>,
}

/// The state with the lowest objective so far.
struct Best {
    positions: Vec<DVec2>,
    /// Parameters of the sliding vertices.
    params: Option<Params>,
    f: f64,
}

impl CpuEngine {
    /// Makes an engine for a run that starts at normalized `positions`, in the order of the problem, with the sliding vertices
    /// `curves` at these positions.
    pub(crate) fn new(
        problem: &Problem,
        positions: Vec<DVec2>,
        curves: Option<OnCurves>,
        plan: &Plan,
    ) -> Self {
        let best = (!plan.is_monotone()).then(|| Best {
            positions: positions.clone(),
            params: curves.as_ref().map(|curves| curves.params().clone()),
            f: f64::INFINITY,
        });
        Self {
            problem: problem.clone(),
            base: plan.scheme.base(),
            tracked: plan.tracked(),
            step: plan.base_step(1.0),
            positions,
            curves,
            best,
            moved: Vec::new(),
            truncated: None,
            hierarchy: None,
            gradient: Vec::new(),
            tangents: DiscTangents::default(),
            direction: Vec::new(),
            secants: None,
        }
    }

    async fn sweep_now(&mut self, step: &SweepParams) {
        let Self { problem, positions, curves, moved, .. } = self;
        sweep::sweep(problem, positions, moved, step).await;
        if let Some(curves) = curves {
            curves.sweep(problem, positions, step);
        }
    }

    /// Returns the sliding vertices of the state whose positions [`Engine::best_positions`] returns. `None` if no vertex
    /// slides.
    pub(crate) async fn best_curves(&self) -> Result<Option<OnCurves>, GpuError> {
        let mut curves = self.curves.clone();
        if let (Some(curves), Some(Best { params: Some(params), .. })) = (&mut curves, &self.best) {
            curves.set_params(params);
        }
        Ok(curves)
    }

    /// Evaluates the tracked objectives. Copies the positions if the objective of the base metric is the lowest so far.
    async fn objectives_now(&mut self) -> Objectives {
        let values = objectives(&self.tracked, &self.problem, &self.positions).await;
        if let Some(best) = &mut self.best
            && let Some(f) = values.of(self.base)
            && f < best.f
        {
            best.positions.copy_from_slice(&self.positions);
            best.params = self.curves.as_ref().map(|curves| curves.params().clone());
            best.f = f;
        }
        values
    }

    /// Evaluates the objective at step length 0, its slope along the correction, and, if the slope is negative, the
    /// objective at `length`.
    async fn proposal(&mut self, length: f64) -> Proposal {
        let Self { base, step, problem, positions, gradient, direction, .. } = &*self;
        let slope = dot(gradient, direction).await / problem.judged_count() as f64;
        let here = mean_model(*base, step.smoothing(), problem, positions).await;
        let there = if slope < 0.0 { self.try_length(length).await } else { None };
        Proposal { here, slope, there }
    }

    /// Zeroes the correction and the gradient at the vertices of triangles that a move by `length` times the correction
    /// would invert, or push over the shape guard.
    async fn leave_out_broken(&mut self, length: f64) {
        self.write_moved(length).await;
        let Self { problem, positions, moved, gradient, direction, .. } = self;
        let along = Along { positions, moved };
        let broken = broken(problem, &along, self.step.shape_guard).await;
        for ((direction, gradient), broken) in direction.iter_mut().zip(gradient).zip(broken) {
            if broken {
                (*direction, *gradient) = (Vec2::ZERO, Vec2::ZERO);
            }
        }
    }

    /// Returns the mean excess after a move by `length` times the correction; see [`Engine::excess_along`].
    async fn try_length(&mut self, length: f64) -> Option<f64> {
        self.write_moved(length).await;
        let along = Along { positions: &self.positions, moved: &self.moved };
        mean_excess_along(&self.step, &self.problem, &along).await
    }

    /// Writes the positions of the free vertices, moved by `length` times the correction within their discs, to the scratch
    /// memory.
    async fn write_moved(&mut self, length: f64) {
        let Self { problem, positions, direction, moved, .. } = self;
        moved.resize(direction.len(), DVec2::ZERO);
        paced::for_each_chunk(moved, CHUNK, |first, moved| {
            for (v, moved) in (first..).zip(moved) {
                let to = positions[v] + direction[v].as_dvec2() * length;
                *moved = nearest(problem, v, to);
            }
        })
        .await;
    }
}

/// Returns the remaining gain by the quadratic model of a Newton step; see [`Engine::remaining`].
pub(crate) async fn remaining(
    problem: &Problem,
    positions: &[DVec2],
    curves: Option<OnCurves>,
    step: &SweepParams,
    request: &StepRequest,
    goes_on: &mut GoesOn<'_>,
) -> Option<f64> {
    let mut truncated = Truncated::new(problem, curves.as_ref()).await;
    truncated.remaining(step, problem, positions, curves, request, goes_on).await
}

/// Computes the correction by the coarser levels from the gradient at the free vertices. The gradient must be projected
/// onto `tangents`; so is the correction.
async fn correction(
    hierarchy: Option<&Hierarchy>,
    problem: &Problem,
    tangents: &DiscTangents,
    gradient: &[Vec2],
) -> Vec<Vec2> {
    let mut correction = match hierarchy {
        Some(hierarchy) if problem.is_stretched() && !problem.are_levels_in_plane() => {
            let transformed = as_transformed(problem, gradient).await;
            let transformed = vcycle::correction(hierarchy, problem, &transformed).await;
            as_transformed(problem, &transformed).await
        }
        Some(hierarchy) => vcycle::correction(hierarchy, problem, gradient).await,
        None => vec![Vec2::ZERO; gradient.len()],
    };
    tangents.project(&mut correction);
    correction
}

/// The levels, mesh and tangents by which an engine corrects.
struct Corrector<'a> {
    hierarchy: Option<&'a Hierarchy>,
    problem: &'a Problem,
    tangents: &'a DiscTangents,
}

impl Levels for Corrector<'_> {
    async fn correction(&self, vector: &[Vec2]) -> Vec<Vec2> {
        correction(self.hierarchy, self.problem, self.tangents, vector).await
    }
}

/// Returns vectors at the free vertices, transformed by the inverse shapes of the maps. The coarser levels work
/// in these coordinates: in a layer of stretched triangles, neighbors are then as near across the layer as along it.
async fn as_transformed(problem: &Problem, vectors: &[Vec2]) -> Vec<Vec2> {
    let maps = problem.maps().unwrap_or_default();
    paced::collect(vectors.len(), |v| {
        let map = TargetMap(maps[v].map(f64::from));
        let transformed = map.inverse().shape().apply(vectors[v].as_dvec2().to_array());
        DVec2::from(transformed).as_vec2()
    })
    .await
}

impl Engine for CpuEngine {
    fn problem(&self) -> &Problem {
        &self.problem
    }

    fn noise(&self) -> f64 {
        NOISE
    }

    async fn sweep(&mut self, step: &SweepParams) -> Result<Objectives, GpuError> {
        self.sweep_now(step).await;
        self.objectives().await
    }

    async fn objectives(&mut self) -> Result<Objectives, GpuError> {
        Ok(self.objectives_now().await)
    }

    async fn sweeps(
        &mut self,
        steps: &[SweepParams],
        history: &mut History,
    ) -> Result<(), GpuError> {
        if history.is_empty() {
            history.record(self.objectives_now().await);
        }
        for step in steps {
            if history.stop().is_some() {
                break;
            }
            self.sweep_now(step).await;
            history.record(self.objectives_now().await);
        }
        Ok(())
    }

    fn set_positions(&mut self, positions: &[DVec2]) -> Result<(), GpuError> {
        self.positions.copy_from_slice(positions);
        self.forget();
        Ok(())
    }

    fn set_maps(&mut self, problem: &Problem) -> Result<(), GpuError> {
        self.problem = problem.clone();
        if problem.has_local_maps() {
            // Secant pairs belong to levels in the coordinates of the earlier maps.
            self.secants = None;
        }
        Ok(())
    }

    async fn positions(&mut self) -> Result<Cow<'_, [DVec2]>, GpuError> {
        Ok(Cow::Borrowed(&self.positions))
    }

    async fn best_positions(&mut self) -> Result<Vec<DVec2>, GpuError> {
        let best = self.best.as_ref().map_or(&self.positions, |best| &best.positions);
        Ok(paced::copied(best).await)
    }

    fn take_hierarchy(&mut self) -> Option<Hierarchy> {
        self.hierarchy.take()
    }

    async fn set_hierarchy(&mut self, hierarchy: Hierarchy) -> Result<(), GpuError> {
        self.hierarchy = Some(hierarchy);
        self.truncated = None;
        Ok(())
    }

    async fn stiffness_roots(&mut self, smoothing: Smoothing) -> Result<Vec<f32>, GpuError> {
        Ok(sweep::stiffness_roots(self.base, &self.problem, &self.positions, smoothing).await)
    }

    async fn sweep_and_propose(
        &mut self,
        step: &SweepParams,
        length: f64,
        accelerated: bool,
    ) -> Result<Proposal, GpuError> {
        self.sweep_now(step).await;
        (self.step.sharpness, self.step.penalty_guard) = (step.sharpness, step.penalty_guard);
        let Self { base, problem, positions, gradient, tangents, secants, .. } = self;
        sweep::gradient(*base, problem, positions, step.smoothing(), gradient).await;
        *tangents = DiscTangents::at(problem, positions, gradient).await;
        tangents.project(gradient);
        // The new direction is allocated while the correction is computed, so the previous one is freed first.
        self.direction = Vec::new();
        let levels = Corrector { hierarchy: self.hierarchy.as_ref(), problem, tangents };
        self.direction = if accelerated {
            secants.get_or_insert_default().direction(positions, gradient, &levels).await
        } else {
            *secants = None;
            levels.correction(gradient).await
        };
        Ok(self.proposal(length).await)
    }

    fn forget(&mut self) {
        self.secants = None;
    }

    async fn exclude_broken(&mut self, length: f64, anew: bool) -> Result<Proposal, GpuError> {
        if anew {
            self.leave_out_broken(length).await;
            let Self { hierarchy, problem, tangents, gradient, .. } = self;
            self.direction = correction(hierarchy.as_ref(), problem, tangents, gradient).await;
        }
        for _ in 0..EXCLUSION_PASSES {
            self.leave_out_broken(length).await;
        }
        Ok(self.proposal(length).await)
    }

    async fn sweep_and_step(
        &mut self,
        step: &SweepParams,
        request: &StepRequest,
        goes_on: &mut GoesOn<'_>,
    ) -> Result<Option<NewtonStep>, GpuError> {
        self.sweep_now(step).await;
        // The step takes the room of the scratch memory.
        self.moved = Vec::new();
        let Self { problem, positions, curves, truncated, .. } = self;
        if truncated.is_none() {
            *truncated = Some(Truncated::new(problem, curves.as_ref()).await);
        }
        let Some(truncated) = truncated else { return Ok(None) };
        let curves = curves.as_mut();
        Ok(Some(truncated.step(step, problem, positions, curves, request, goes_on).await))
    }

    async fn remaining(
        &mut self,
        step: &SweepParams,
        request: &StepRequest,
        goes_on: &mut GoesOn<'_>,
    ) -> Result<Option<f64>, GpuError> {
        self.moved = Vec::new();
        let Self { problem, positions, curves, .. } = self;
        Ok(remaining(problem, positions, curves.clone(), step, request, goes_on).await)
    }

    fn go_on(&mut self, _tolerance: f64) -> Result<(), GpuError> {
        // The history judges the sweeps of this engine.
        Ok(())
    }

    async fn excess_along(&mut self, length: f64) -> Result<Option<f64>, GpuError> {
        Ok(self.try_length(length).await)
    }

    async fn move_along(&mut self, length: f64) -> Result<(), GpuError> {
        self.write_moved(length).await;
        let Self { positions, moved, .. } = self;
        positions[..moved.len()].copy_from_slice(moved);
        Ok(())
    }

    async fn objectives_after_move(&mut self, length: f64) -> Result<Objectives, GpuError> {
        self.move_along(length).await?;
        self.objectives().await
    }

    async fn save(&mut self, whole: bool) -> Result<EngineState, GpuError> {
        let mut state = EngineState {
            engine: CPU.to_owned(),
            positions: self.positions.clone(),
            best: self.best.as_ref().map(|best| best.positions.clone()),
            ..EngineState::default()
        };
        if let Some(curves) = &self.curves {
            curves.save(self.best.as_ref().and_then(|best| best.params.as_ref()), &mut state);
        }
        state.add_maps(&self.problem, whole);
        if whole {
            state.roots = self.hierarchy.as_ref().map(Hierarchy::build_log).unwrap_or_default();
            if let Some(secants) = &self.secants {
                secants.save(&mut state);
            }
        }
        Ok(state)
    }

    async fn restore(&mut self, state: &EngineState) -> Result<bool, GpuError> {
        let fits = |points: &Vec<DVec2>| {
            points.len() == self.positions.len() && points.iter().all(|p| p.is_finite())
        };
        let best = state.best.as_ref().unwrap_or(&state.positions);
        if !fits(&state.positions) || !fits(best) {
            return Ok(false);
        }
        let mut best_params = None;
        if let Some(curves) = &mut self.curves {
            let Some(params) = curves.restore(state) else { return Ok(false) };
            best_params = params;
        }
        self.positions.clone_from(&state.positions);
        state.restore_maps(&mut self.problem);
        if let Some(kept) = &mut self.best {
            kept.positions.clone_from(best);
            let f = objective(self.base, &self.problem, &kept.positions).await;
            (kept.params, kept.f) = (best_params, f);
        }
        self.hierarchy = Hierarchy::of_build_log(&self.problem, &state.roots).await;
        self.secants = Secants::saved_in(state, self.problem.free_count());
        Ok(self.hierarchy.is_some() || state.roots.is_empty())
    }
}
