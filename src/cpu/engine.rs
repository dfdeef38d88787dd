//! The engine on the CPU, in double precision. Also the reference for tests.
//!
//! It uses the same colors, steps and stop rule as the GPU engine.

use std::borrow::Cow;

use glam::{DVec2, Vec2};

use crate::cpu::objective::{Along, mean_excess, mean_excess_along};
use crate::cpu::secants::{Secants, dot};
use crate::cpu::{sweep, vcycle};
use crate::error::GpuError;
use crate::layout::Problem;
use crate::metric::{Metric, TargetMap};
use crate::parallel::{collect, for_each_chunk};
use crate::run::multilevel::Hierarchy;
use crate::run::{CPU, Engine, EngineState, History, Objectives, Plan, Proposal, Step};

/// Number of vertices of one task.
const CHUNK: usize = 1 << 12;

/// The state of a run on the CPU.
pub(crate) struct CpuEngine<'a> {
    problem: &'a Problem,
    base: Metric,
    tracked: Vec<Metric>,
    /// The base metric's step. Corrections use its shape guard and its exponent.
    step: Step,
    positions: Vec<DVec2>,
    /// The positions of the best state; `None` if every sweep improves the mesh, so that the last state is the best.
    best: Option<Vec<DVec2>>,
    /// Scratch memory for sweeps.
    moved: Vec<DVec2>,
    hierarchy: Option<Hierarchy>,
    gradient: Vec<Vec2>,
    /// The last correction, at each free vertex.
    direction: Vec<Vec2>,
    secants: Option<Secants>,
}

impl<'a> CpuEngine<'a> {
    /// Starts at `positions`, which are normalized and in the problem's order.
    pub(crate) fn new(problem: &'a Problem, positions: Vec<DVec2>, plan: &Plan) -> Self {
        let best = (!plan.is_monotone()).then(|| positions.clone());
        Self {
            problem,
            base: plan.scheme.base(),
            tracked: plan.tracked(),
            step: plan.base_step(1.0),
            positions,
            best,
            moved: Vec::new(),
            hierarchy: None,
            gradient: Vec::new(),
            direction: Vec::new(),
            secants: None,
        }
    }

    fn sweep_now(&mut self, step: &Step) {
        sweep::sweep(self.problem, &mut self.positions, &mut self.moved, step);
    }

    fn objectives_now(&self) -> Objectives {
        let mut values = Objectives::untracked();
        for &metric in &self.tracked {
            let excess = mean_excess(metric, self.problem, &self.positions);
            values.set(metric, metric.ideal_squared() + excess);
        }
        values
    }

    /// Records the objectives, and keeps the positions if they are the best so far.
    fn record(&mut self, history: &mut History) {
        if history.record(self.objectives_now())
            && let Some(best) = &mut self.best
        {
            best.copy_from_slice(&self.positions);
        }
    }

    /// The mean excess at a length of the correction; see [`Engine::excess_along`].
    fn try_length(&self, length: f64) -> Option<f64> {
        let Self { positions, direction, .. } = self;
        let along = Along { positions, direction, length };
        mean_excess_along(self.base, self.problem, &along, self.step.shape_guard)
    }
}

/// Vectors at the free vertices, multiplied by the inverse shapes of their target maps. So the levels see moves and
/// gradients as targets show them, which makes neighbors in a layer of stretched triangles as near across as along it.
fn as_shown(problem: &Problem, vectors: &[Vec2]) -> Vec<Vec2> {
    let targets = problem.targets().unwrap_or_default();
    collect(vectors.len(), |v| {
        let map = TargetMap(targets[v].map(f64::from));
        let shown = map.inverse().shape().apply(vectors[v].as_dvec2().to_array());
        DVec2::from(shown).as_vec2()
    })
}

impl Engine for CpuEngine<'_> {
    async fn sweep(&mut self, step: &Step) -> Result<(), GpuError> {
        self.sweep_now(step);
        Ok(())
    }

    async fn objectives(&mut self) -> Result<Objectives, GpuError> {
        Ok(self.objectives_now())
    }

    async fn sweeps(&mut self, steps: &[Step], history: &mut History) -> Result<(), GpuError> {
        if history.is_empty() {
            self.record(history);
        }
        for step in steps {
            if history.stop().is_some() {
                break;
            }
            self.sweep_now(step);
            self.record(history);
        }
        Ok(())
    }

    async fn positions(&mut self) -> Result<Cow<'_, [DVec2]>, GpuError> {
        Ok(Cow::Borrowed(&self.positions))
    }

    async fn best_positions(&mut self) -> Result<Vec<DVec2>, GpuError> {
        Ok(self.best.as_ref().unwrap_or(&self.positions).clone())
    }

    fn take_hierarchy(&mut self) -> Option<Hierarchy> {
        self.hierarchy.take()
    }

    fn set_hierarchy(&mut self, hierarchy: Hierarchy) -> Result<(), GpuError> {
        self.hierarchy = Some(hierarchy);
        Ok(())
    }

    async fn stiffness_roots(&mut self) -> Result<Vec<f32>, GpuError> {
        let Self { base, problem, positions, step, .. } = self;
        Ok(sweep::stiffness_roots(*base, problem, positions, step.sharpness))
    }

    async fn propose(
        &mut self,
        step: &Step,
        length: f64,
        accelerated: bool,
    ) -> Result<Proposal, GpuError> {
        self.sweep_now(step);
        let Self { base, problem, positions, gradient, secants, .. } = self;
        sweep::gradient(*base, problem, positions, self.step.sharpness, gradient);
        // The correction allocates a new direction. The last one is freed before.
        self.direction = Vec::new();
        let levels = |vector: &[Vec2]| match &self.hierarchy {
            Some(hierarchy) if problem.is_stretched() => {
                let correction = vcycle::correction(hierarchy, problem, &as_shown(problem, vector));
                as_shown(problem, &correction)
            }
            Some(hierarchy) => vcycle::correction(hierarchy, problem, vector),
            None => vec![Vec2::ZERO; vector.len()],
        };
        self.direction = if accelerated {
            secants.get_or_insert_default().direction(positions, gradient, levels)
        } else {
            *secants = None;
            levels(gradient)
        };
        let slope = dot(gradient, &self.direction) / problem.triangles().len() as f64;
        let here = mean_excess(self.base, self.problem, &self.positions);
        let there = if slope < 0.0 { self.try_length(length) } else { None };
        Ok(Proposal { here, slope, there })
    }

    async fn excess_along(&mut self, length: f64) -> Result<Option<f64>, GpuError> {
        Ok(self.try_length(length))
    }

    async fn move_along(&mut self, length: f64) -> Result<(), GpuError> {
        let Self { positions, direction, .. } = self;
        let free = direction.len();
        for_each_chunk(&mut positions[..free], CHUNK, |first, positions| {
            for (position, along) in positions.iter_mut().zip(&direction[first..]) {
                *position += along.as_dvec2() * length;
            }
        });
        Ok(())
    }

    async fn save(&mut self, whole: bool) -> Result<EngineState, GpuError> {
        let mut state = EngineState {
            engine: CPU.to_owned(),
            positions: self.positions.clone(),
            best: self.best.clone(),
            ..EngineState::default()
        };
        if whole {
            state.roots = self.hierarchy.as_ref().map(Hierarchy::recipe).unwrap_or_default();
            if let Some(secants) = &self.secants {
                secants.save(&mut state);
            }
        }
        Ok(state)
    }

    fn restore(&mut self, state: &EngineState) -> Result<bool, GpuError> {
        let fits = |points: &Vec<DVec2>| {
            points.len() == self.positions.len() && points.iter().all(|p| p.is_finite())
        };
        let best = state.best.as_ref().unwrap_or(&state.positions);
        if !fits(&state.positions) || !fits(best) {
            return Ok(false);
        }
        self.positions.clone_from(&state.positions);
        if let Some(kept) = &mut self.best {
            kept.clone_from(best);
        }
        self.hierarchy = Hierarchy::of_recipe(self.problem, &state.roots);
        self.secants = Secants::saved_in(state, self.problem.free_count());
        Ok(self.hierarchy.is_some() || state.roots.is_empty())
    }
}
