//! The wgpu engine. One submission holds several sweeps, and the device itself applies the stop rule between them.

use std::borrow::Cow;

use bytemuck::Pod;
use glam::DVec2;

use crate::error::GpuError;
use crate::gpu::device::Gpu;
use crate::gpu::device::buffers::write_by_pieces;
use crate::gpu::device::pending::Waiting;
use crate::gpu::device::readback::{self, Copied};
use crate::gpu::encode::{Passes, Span, Timestamps, sealed::Target};
use crate::gpu::kernels::uniforms::{Control, HISTORY, SLOTS, join, split, unpair};
use crate::gpu::mesh::{Curves, MeshBuffers};
use crate::gpu::run::ahead;
use crate::gpu::run::dispatches::Dispatches;
use crate::gpu::run::levels::{Fitting, Levels};
use crate::gpu::run::secants::Secants;
use crate::gpu::run::stiffness;
use crate::gpu::run::truncated::{self, OnDevice, Truncated};
use crate::gpu::scope::scoped;
use crate::layout::Problem;
use crate::metric::Smoothing;
use crate::parallel::paced;
use crate::run::multilevel::Hierarchy;
use crate::run::truncated::{NewtonStep, StepRequest};
use crate::run::{
    Engine, EngineState, GoesOn, History, Objectives, Plan, Proposal, Stop, SweepParams, Work,
};
use crate::slide::OnCurves;

/// Relative error of f that the device sums from terms in single precision. Repeated evaluations on lavapipe differ by
/// 3e-8.
const NOISE_OF_F: f64 = 2e-7;
/// Number of positions that are computed between two pauses.
const CHUNK: usize = 1 << 14;
/// Least sum of q² - ideal² over a mesh with a triangle whose edges are not finite.
const MIN_NOT_FINITE: f64 = 1e38;
/// Number of totals along a correction: objective before and after the step, broken triangles, and slope.
const TOTALS: usize = 4;

/// Names of the data in a saved state of this engine: the free vertices' positions as pairs of floats, the positions of
/// the best state, and the control block.
const POSITIONS: &str = "positions";
const BEST: &str = "best positions";
const CONTROL: &str = "control";

/// A run on a device: mesh, dispatches, and the coarser levels of corrections.
pub(crate) struct GpuEngine<'a> {
    gpu: &'a Gpu,
    problem: Problem,
    /// Positions of all vertices in double precision, as the host last set them.
    start: Vec<DVec2>,
    mesh: MeshBuffers,
    dispatches: Dispatches,
    levels: Option<Levels>,
    secants: Option<Secants>,
    /// Source of `levels`: the hierarchy on the host.
    hierarchy: Option<Hierarchy>,
    /// The mesh prepared for Newton steps of all vertices. `None` before the first step.
    truncated: Option<Truncated>,
    waiting: Waiting,
    /// Number of evaluations read back so far.
    evaluated: u32,
}

impl<'a> GpuEngine<'a> {
    /// Uploads the problem with its vertices at the normalized positions `start`, in the problem's order, and with the
    /// sliding vertices `curves` at these positions. Compiles the kernels for the work of a run by the plan. The device
    /// ends [`Engine::sweeps`] by the plan's stop rule.
    ///
    /// # Errors
    /// [`GpuError::Limit`] if the mesh is too large for the device, or another [`GpuError`] if the device fails.
    pub(crate) async fn new(
        gpu: &'a Gpu,
        problem: &Problem,
        start: &[DVec2],
        curves: Option<&OnCurves>,
        plan: Plan,
        work: Work,
        waiting: Waiting,
    ) -> Result<Self, GpuError> {
        gpu.device.check()?;
        let mut mesh = MeshBuffers::new(gpu, problem, start).await?;
        let keep_best = !plan.is_monotone();
        if let Some(curves) = curves {
            mesh.curves = Some(Curves::new(gpu, problem, curves, keep_best)?);
        }
        gpu.compile(&ahead::kernels(&plan, &work, problem, &mesh)).await?;
        let dispatches = Dispatches::new(gpu, problem, &mesh, plan, work.steps, keep_best).await?;
        let start = paced::copied(start).await;
        let (levels, secants, hierarchy) = (None, None, None);
        let evaluated = 0;
        Ok(Self {
            gpu,
            problem: problem.clone(),
            start,
            mesh,
            dispatches,
            levels,
            secants,
            hierarchy,
            truncated: None,
            waiting,
            evaluated,
        })
    }

    #[cfg(test)]
    pub(super) fn truncated(&self) -> Option<&Truncated> {
        self.truncated.as_ref()
    }

    /// Prepares the mesh for Newton steps of all vertices. Returns false if the device takes no such steps.
    async fn prepare_steps(&mut self) -> Result<bool, GpuError> {
        let Self { gpu, problem, mesh, dispatches, truncated, .. } = self;
        if !truncated::serves(problem, mesh) {
            return Ok(false);
        }
        if truncated.is_none() {
            match Truncated::new(gpu, problem, mesh, dispatches).await {
                Ok(prepared) => *truncated = Some(prepared),
                Err(GpuError::Limit { .. } | GpuError::OutOfMemory { .. }) => return Ok(false),
                Err(error) => return Err(error),
            }
        }
        Ok(true)
    }

    /// Times the kernels of a Newton step of all vertices from the present positions, with a number of iterations. `None` if the
    /// device takes no such steps on the mesh.
    pub(crate) async fn timed_step(
        &mut self,
        request: &StepRequest,
        iterations: u32,
        timestamps: &mut Timestamps,
    ) -> Result<Option<Vec<Span>>, GpuError> {
        if !self.prepare_steps().await? {
            return Ok(None);
        }
        let Self { gpu, problem, start, mesh, dispatches, truncated, waiting, .. } = self;
        let (waiting, Some(truncated)) = (*waiting, truncated) else { return Ok(None) };
        let on = OnDevice { gpu, problem, start, mesh, dispatches, waiting };
        truncated.timed(&on, request, iterations, timestamps).await.map(Some)
    }

    fn submit(&self, encode: impl FnOnce(&mut Passes<'_>)) -> Result<(), GpuError> {
        let label = "gpu-smooth run";
        let descriptor = wgpu::CommandEncoderDescriptor { label: Some(label) };
        scoped(&self.gpu.device, || {
            let mut encoder = self.gpu.device.create_command_encoder(&descriptor);
            encode(&mut encoder.passes(label));
            self.gpu.queue.submit([encoder.finish()]);
        })
    }

    /// Submits what `encode` encodes, and in the same submission a copy of the first `count` values of `source`.
    fn submit_and_copy<T: Pod>(
        &self,
        encode: impl FnOnce(&mut Passes<'_>),
        source: &wgpu::Buffer,
        count: usize,
    ) -> Result<Copied<'a, T>, GpuError> {
        let encode =
            |encoder: &mut wgpu::CommandEncoder| encode(&mut encoder.passes("gpu-smooth run"));
        readback::submit_and_copy(self.gpu, encode, source, count)
    }

    /// Submits what `encode` encodes, and returns the control block after it.
    async fn control_after(
        &self,
        encode: impl FnOnce(&mut Passes<'_>) + Send,
    ) -> Result<Control, GpuError> {
        let copied = self.submit_and_copy(encode, &self.dispatches.control, 1)?;
        copied.first(self.waiting).await
    }

    /// Submits what `encode` encodes and an evaluation, and returns the evaluated objectives.
    async fn objectives_after(
        &self,
        encode: impl FnOnce(&mut Passes<'_>) + Send,
    ) -> Result<Objectives, GpuError> {
        let evaluated = |passes: &mut Passes<'_>| {
            encode(passes);
            self.dispatches.encode_evaluation(passes);
        };
        let control = self.control_after(evaluated).await?;
        let last = control.evaluated.saturating_sub(1) % HISTORY;
        Ok(self.objectives_of(&control.history[last as usize]))
    }

    /// Submits sweeps, preceded by an evaluation if the history is empty, and records the device's results.
    async fn batch(
        &mut self,
        steps: &[SweepParams],
        history: &mut History,
    ) -> Result<(), GpuError> {
        let sweeps = |passes: &mut Passes<'_>| {
            if self.evaluated == 0 {
                self.dispatches.encode_evaluation(passes);
            }
            for step in steps {
                self.dispatches.encode_sweep(passes, step);
                self.dispatches.encode_evaluation(passes);
            }
        };
        let control = self.control_after(sweeps).await?;
        for evaluation in self.evaluated..control.evaluated {
            let sums = control.history[(evaluation % HISTORY) as usize];
            history.record(self.objectives_of(&sums));
        }
        self.evaluated = control.evaluated;
        history.end(Stop::from_code(control.done), history.remaining());
        Ok(())
    }

    /// Returns the objectives of an evaluation, given its sums.
    fn objectives_of(&self, sums: &[[f32; 2]; SLOTS]) -> Objectives {
        let mut values = Objectives::empty();
        for metric in self.dispatches.plan.tracked() {
            let sum = unpair(sums[metric as usize]);
            // A larger sum holds `NOT_FINITE` of objective.wgsl for at least one triangle. Sums of finite triangles on
            // a device are far smaller.
            let sum = if sum < MIN_NOT_FINITE { sum } else { f64::NAN };
            let excess = sum / self.problem.judged_count() as f64;
            values.set(metric, metric.ideal_squared() + excess);
        }
        values
    }

    /// Returns the positions of all vertices, given the free vertices' positions on the device. A vertex that has not
    /// moved keeps the bits of `start`, as the device's pairs of floats hold only 48 bits.
    async fn moved(&self, free: Vec<[f32; 4]>) -> Vec<DVec2> {
        let mut positions = Vec::with_capacity(self.start.len());
        paced::in_order(self.start.len(), CHUNK, |range| {
            let start = &self.start[range.clone()];
            let now = free.get(range.start..range.end.min(free.len())).unwrap_or_default();
            let moved = start.iter().zip(now).map(|(&start, &now)| match now == split(start) {
                true => start,
                false => join(now),
            });
            positions.extend(moved.chain(start[now.len()..].iter().copied()));
        })
        .await;
        positions
    }

    /// Returns the sliding vertices in the state whose positions [`Engine::best_positions`] returns. `None` if no vertex
    /// slides.
    pub(crate) async fn best_curves(&self) -> Result<Option<OnCurves>, GpuError> {
        let Some(curves) = &self.mesh.curves else { return Ok(None) };
        let is_last = self.dispatches.plan.is_monotone();
        self.read_curves(if is_last { &curves.places } else { &curves.best }).await
    }

    /// Returns the sliding vertices in the present state. `None` if no vertex slides.
    async fn present_curves(&self) -> Result<Option<OnCurves>, GpuError> {
        let Some(curves) = &self.mesh.curves else { return Ok(None) };
        self.read_curves(&curves.places).await
    }

    async fn read_curves(&self, state: &wgpu::Buffer) -> Result<Option<OnCurves>, GpuError> {
        let Some(curves) = &self.mesh.curves else { return Ok(None) };
        Ok(Some(curves.read(self.gpu, &self.problem, state, self.waiting).await?))
    }

    /// Returns the sliding vertices to a saved state. Returns false if the state belongs to other curves.
    fn restore_curves(&mut self, state: &EngineState) -> Result<bool, GpuError> {
        let Some(curves) = &mut self.mesh.curves else { return Ok(true) };
        let mut restored = curves.set().clone();
        let Some(best_params) = restored.restore(state) else { return Ok(false) };
        let best = best_params.map(|params| {
            let mut best = restored.clone();
            best.set_params(&params);
            best
        });
        if best.is_none() && !self.dispatches.plan.is_monotone() {
            return Ok(false);
        }
        let best = best.filter(|_| !self.dispatches.plan.is_monotone());
        curves.write(self.gpu, &self.problem, &restored, best.as_ref())?;
        Ok(true)
    }

    /// Returns the number of leading vertices whose positions a saved state has: the free vertices, or all vertices if
    /// vertices slide.
    fn saved_count(&self) -> usize {
        if self.mesh.curves.is_some() { self.start.len() } else { self.problem.free_count() }
    }

    /// Returns the proposal, given the four totals of the objective along the correction.
    async fn proposal(&self, totals: Copied<'_, [f32; 2]>) -> Result<Proposal, GpuError> {
        let totals = totals.values(self.waiting).await?;
        let total = |i: usize| totals.get(i).map_or(f64::NAN, |&sum| unpair(sum));
        let triangles = self.problem.judged_count() as f64;
        Ok(Proposal {
            here: total(0) / triangles,
            there: (total(2) == 0.0).then(|| total(1) / triangles),
            slope: total(3) / triangles,
        })
    }
}

impl Engine for GpuEngine<'_> {
    fn problem(&self) -> &Problem {
        &self.problem
    }

    fn noise(&self) -> f64 {
        NOISE_OF_F
    }

    async fn sweep(&mut self, step: &SweepParams) -> Result<Objectives, GpuError> {
        self.objectives_after(|passes| self.dispatches.encode_sweep(passes, step)).await
    }

    async fn objectives(&mut self) -> Result<Objectives, GpuError> {
        self.objectives_after(|_| {}).await
    }

    async fn sweeps(
        &mut self,
        steps: &[SweepParams],
        history: &mut History,
    ) -> Result<(), GpuError> {
        if steps.is_empty() && self.evaluated == 0 {
            return self.batch(&[], history).await;
        }
        // The device's history must be read before it wraps.
        for steps in steps.chunks(HISTORY as usize / 2) {
            if history.stop().is_some() {
                break;
            }
            self.batch(steps, history).await?;
        }
        Ok(())
    }

    fn set_positions(&mut self, positions: &[DVec2]) -> Result<(), GpuError> {
        let free = self.problem.free_count();
        // Unless the host has moved a fixed vertex, only the positions of free vertices are written.
        let is_fixed = self.start[free..] == positions[free..];
        let count = if is_fixed { free } else { positions.len() };
        let written: Vec<[f32; 4]> = positions[..count].iter().map(|&p| split(p)).collect();
        self.mesh.write_positions(self.gpu, &written)?;
        self.start.copy_from_slice(positions);
        self.secants = None;
        Ok(())
    }

    fn set_maps(&mut self, problem: &Problem) -> Result<(), GpuError> {
        self.problem = problem.clone();
        self.truncated = None;
        self.mesh.write_maps(self.gpu, problem)?;
        if problem.has_local_maps() {
            // Secant pairs belong to levels in the coordinates of the earlier maps.
            self.secants = None;
        }
        self.dispatches.write_params(self.gpu, problem)
    }

    async fn positions(&mut self) -> Result<Cow<'_, [DVec2]>, GpuError> {
        let free = self.problem.free_count();
        let moved = self.mesh.read_positions(self.gpu, free, self.waiting).await?;
        let mut positions = self.moved(moved).await;
        if let Some(curves) = self.present_curves().await? {
            curves.write_positions(&self.problem, &mut positions);
        }
        Ok(Cow::Owned(positions))
    }

    async fn best_positions(&mut self) -> Result<Vec<DVec2>, GpuError> {
        let free = self.problem.free_count();
        let moved = match self.dispatches.plan.is_monotone() {
            true => self.mesh.read_positions(self.gpu, free, self.waiting).await?,
            false => readback::read(self.gpu, &self.dispatches.best, free, self.waiting).await?,
        };
        let mut positions = self.moved(moved).await;
        if let Some(curves) = self.best_curves().await? {
            curves.write_positions(&self.problem, &mut positions);
        }
        Ok(positions)
    }

    fn take_hierarchy(&mut self) -> Option<Hierarchy> {
        self.hierarchy.take()
    }

    async fn set_hierarchy(&mut self, hierarchy: Hierarchy) -> Result<(), GpuError> {
        // The old levels are dropped first, as both at once would take more memory than the mesh itself.
        (self.levels, self.truncated) = (None, None);
        let Self { gpu, problem, mesh, dispatches, secants, .. } = self;
        let levels =
            Levels::new(gpu, problem, mesh, dispatches, &hierarchy, Fitting::ByHost).await?;
        if let Some(secants) = secants {
            secants.bind_to(gpu, mesh, &dispatches.params, &levels)?;
        }
        self.levels = Some(levels);
        self.hierarchy = Some(hierarchy);
        Ok(())
    }

    async fn stiffness_roots(&mut self, smoothing: Smoothing) -> Result<Vec<f32>, GpuError> {
        let free = self.problem.free_count() as u32;
        stiffness::roots(self.gpu, &self.mesh, &self.dispatches, free, smoothing, self.waiting)
            .await
    }

    async fn sweep_and_propose(
        &mut self,
        step: &SweepParams,
        length: f64,
        accelerated: bool,
    ) -> Result<Proposal, GpuError> {
        if let Some(levels) = &mut self.levels {
            levels.set_step(self.gpu, length as f32, step.smoothing())?;
        }
        let Some(levels) = &self.levels else {
            return Ok(Proposal { here: f64::NAN, slope: 0.0, there: None });
        };
        let mut secants = self.secants.take().filter(|_| accelerated);
        if accelerated && secants.is_none() {
            let (params, free) = (&self.dispatches.params, self.problem.free_count() as u32);
            secants = Secants::new(self.gpu, &self.mesh, params, levels, free).await?;
        }
        let correction = |passes: &mut Passes<'_>| {
            self.dispatches.encode_sweep(passes, step);
            match &mut secants {
                Some(secants) => secants.encode_correction(self.gpu, levels, passes),
                None => {
                    levels.encode_gradient(passes);
                    levels.encode_cycle(passes);
                }
            }
            levels.encode_objective(passes);
        };
        let totals = self.submit_and_copy(correction, &levels.vectors, TOTALS)?;
        let proposal = self.proposal(totals).await;
        self.secants = secants;
        proposal
    }

    async fn sweep_and_step(
        &mut self,
        step: &SweepParams,
        request: &StepRequest,
        goes_on: &mut GoesOn<'_>,
    ) -> Result<Option<NewtonStep>, GpuError> {
        if !self.prepare_steps().await? {
            return Ok(None);
        }
        let Self { gpu, problem, start, mesh, dispatches, truncated, waiting, .. } = self;
        let (waiting, Some(truncated)) = (*waiting, truncated) else { return Ok(None) };
        if mesh.curves.is_some() {
            let mut on = OnDevice { gpu, problem, start, mesh, dispatches, waiting };
            return truncated.sweep_and_slide(&mut on, step, request, goes_on).await.map(Some);
        }
        let on = OnDevice { gpu, problem, start, mesh, dispatches, waiting };
        truncated.sweep_and_step(&on, step, request, goes_on).await.map(Some)
    }

    async fn remaining(
        &mut self,
        _: &SweepParams,
        request: &StepRequest,
        goes_on: &mut GoesOn<'_>,
    ) -> Result<Option<f64>, GpuError> {
        if !self.prepare_steps().await? {
            return Ok(None);
        }
        let Self { gpu, problem, start, mesh, dispatches, truncated, waiting, .. } = self;
        let (waiting, Some(mut truncated)) = (*waiting, truncated.take()) else { return Ok(None) };
        let slides = mesh.curves.is_some();
        let on = OnDevice { gpu, problem, start, mesh, dispatches, waiting };
        match slides {
            true => truncated.remaining_with_slides(&on, request, goes_on).await,
            false => truncated.remaining(&on, request, goes_on).await,
        }
    }

    fn go_on(&mut self, tolerance: f64) -> Result<(), GpuError> {
        self.dispatches.plan.stop.tolerance = tolerance;
        self.dispatches.write_params(self.gpu, &self.problem)?;
        scoped(&self.gpu.device, || {
            // `done` is the first word of the control block.
            self.gpu.queue.write_buffer(&self.dispatches.control, 0, &[0; 4]);
        })
    }

    fn forget(&mut self) {
        self.secants = None;
    }

    async fn exclude_broken(&mut self, length: f64, anew: bool) -> Result<Proposal, GpuError> {
        let Some(levels) = &self.levels else {
            return Ok(Proposal { here: f64::NAN, slope: 0.0, there: None });
        };
        levels.set_length(self.gpu, length as f32)?;
        let rest = |passes: &mut Passes<'_>| {
            levels.encode_left_out(passes, anew);
            levels.encode_objective(passes);
        };
        let totals = self.submit_and_copy(rest, &levels.vectors, TOTALS)?;
        self.proposal(totals).await
    }

    async fn excess_along(&mut self, length: f64) -> Result<Option<f64>, GpuError> {
        let Some(levels) = &self.levels else { return Ok(None) };
        levels.set_length(self.gpu, length as f32)?;
        let objective = |passes: &mut Passes<'_>| levels.encode_objective(passes);
        let totals = self.submit_and_copy(objective, &levels.vectors, TOTALS)?;
        Ok(self.proposal(totals).await?.there)
    }

    async fn move_along(&mut self, length: f64) -> Result<(), GpuError> {
        let Some(levels) = &self.levels else { return Ok(()) };
        levels.set_length(self.gpu, length as f32)?;
        self.submit(|passes| levels.encode_movement(passes))
    }

    async fn objectives_after_move(&mut self, length: f64) -> Result<Objectives, GpuError> {
        let Some(levels) = &self.levels else { return self.objectives().await };
        levels.set_length(self.gpu, length as f32)?;
        self.objectives_after(|passes| levels.encode_movement(passes)).await
    }

    async fn save(&mut self, whole: bool) -> Result<EngineState, GpuError> {
        let (gpu, waiting, free) = (self.gpu, self.waiting, self.problem.free_count());
        let positions = self.mesh.read_positions(gpu, self.saved_count(), waiting).await?;
        let curves = self.present_curves().await?;
        let mut state =
            EngineState { engine: gpu.adapter().name.clone(), ..EngineState::default() };
        let mut best_curves = None;
        if !self.dispatches.plan.is_monotone() {
            let best = readback::read(gpu, &self.dispatches.best, free, waiting).await?;
            if whole {
                state.own.add_list(BEST, &best);
            }
            let mut best = self.moved(best).await;
            best_curves = self.best_curves().await?;
            if let Some(curves) = &best_curves {
                curves.write_positions(&self.problem, &mut best);
            }
            state.best = Some(best);
        }
        state.add_maps(&self.problem, whole);
        if whole {
            state.own.add_list(POSITIONS, &positions);
            let control: Vec<Control> =
                readback::read(gpu, &self.dispatches.control, 1, waiting).await?;
            state.own.add_list(CONTROL, &control);
            state.roots = self.hierarchy.as_ref().map(Hierarchy::build_log).unwrap_or_default();
            if let Some(secants) = &self.secants {
                secants.save(gpu, &mut state, waiting).await?;
            }
        }
        state.positions = self.moved(positions).await;
        if let Some(curves) = curves {
            curves.write_positions(&self.problem, &mut state.positions);
            curves.save(best_curves.as_ref().map(OnCurves::params), &mut state);
        }
        Ok(state)
    }

    async fn restore(&mut self, state: &EngineState) -> Result<bool, GpuError> {
        let (gpu, free) = (self.gpu, self.problem.free_count());
        let saved = state.own.list_of::<[f32; 4]>(POSITIONS, self.saved_count());
        let Some(positions) = saved else { return Ok(false) };
        let Some(control) = state.own.one::<Control>(CONTROL) else { return Ok(false) };
        let is_finite =
            |positions: &[[f32; 4]]| positions.as_flattened().iter().all(|x| x.is_finite());
        if control.done != 0 || !is_finite(&positions) {
            return Ok(false);
        }
        if !self.restore_curves(state)? {
            return Ok(false);
        }
        self.mesh.write_positions(gpu, &positions)?;
        if state.restore_maps(&mut self.problem) {
            self.mesh.write_maps(gpu, &self.problem)?;
            self.dispatches.write_params(gpu, &self.problem)?;
        }
        self.evaluated = control.evaluated;
        let best = match self.dispatches.plan.is_monotone() {
            true => None,
            false => match state.own.list_of::<[f32; 4]>(BEST, free) {
                Some(best) if is_finite(&best) => Some(best),
                _ => return Ok(false),
            },
        };
        scoped(&gpu.device, || {
            gpu.queue.write_buffer(&self.dispatches.control, 0, bytemuck::bytes_of(&control));
            if let Some(best) = &best {
                write_by_pieces(gpu, &self.dispatches.best, 0, bytemuck::cast_slice(best));
            }
        })?;
        if state.roots.is_empty() {
            return Ok(true);
        }
        let Some(hierarchy) = Hierarchy::of_build_log(&self.problem, &state.roots).await else {
            return Ok(false);
        };
        self.set_hierarchy(hierarchy).await?;
        if let (Some(levels), true) = (&self.levels, Secants::are_in(state)) {
            let params = &self.dispatches.params;
            let secants = Secants::new(gpu, &self.mesh, params, levels, free as u32).await?;
            let Some(mut secants) = secants else { return Ok(false) };
            if !secants.restore(gpu, state)? {
                return Ok(false);
            }
            self.secants = Some(secants);
        }
        Ok(true)
    }
}
