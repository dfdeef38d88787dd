//! Newton steps of all vertices on a device, by the rules of [`crate::run::truncated`].
//!
//! The Hessian is stored as a 2x2 block for each entry of the one-rings. Conjugate gradients and the line search are judged on
//! the device: a submission holds as many iterations as the step is expected to take, and the host waits for its end.

mod buffers;
mod list;
mod nest;
mod sliding;
#[cfg(test)]
mod tests;

use std::ops::Range;

use glam::DVec2;

use crate::error::GpuError;
use crate::gpu::device::Gpu;
use crate::gpu::device::pending::Waiting;
use crate::gpu::device::readback;
use crate::gpu::device::size::{objective_invocations, span_count};
use crate::gpu::encode::Passes;
use crate::gpu::encode::sealed::Target;
use crate::gpu::encode::{Span, Timestamps};
use crate::gpu::kernels::row::User;
use crate::gpu::kernels::table::Kernel;
use crate::gpu::kernels::uniforms::{StepState, unpair};
use crate::gpu::mesh::MeshBuffers;
use crate::gpu::run::Dispatches;
use crate::gpu::run::listing::{Dispatch, encode};
use crate::gpu::scope::scoped;
use crate::layout::Problem;
use crate::run::truncated::{ErrorBound, NewtonStep, StepRequest, could_gain};
use crate::run::{GoesOn, Plan, SweepParams};
use list::{List, Prepared};

/// Number of iterations in the first submission of a run. Later submissions have numbers between two limits.
const FIRST_ITERATIONS: u32 = 8;
const ITERATIONS: [u32; 2] = [4, 32];
/// Number of iterations that a submission adds to those of the last step. With four, a run on 20,000 vertices took a fifth more
/// dispatches and no fewer submissions. An iteration after the end of the step takes a twentieth of the time.
const MORE: u32 = 2;

/// Returns whether a device takes Newton steps on a mesh. In single precision, steps on strongly stretched triangles do not end a
/// run. The Hessian is not bound in parts.
pub(super) fn serves(problem: &Problem, mesh: &MeshBuffers) -> bool {
    !problem.has_local_maps() && mesh.parts.are_whole()
}

/// Returns the kernels of Newton steps in a run by a plan. `slides` is whether vertices slide.
pub(super) fn kernels(plan: &Plan, problem: &Problem, slides: bool) -> Vec<Kernel> {
    let along = Kernel::ObjectiveAlongCorrection(plan.scheme.base());
    let mut kernels = Kernel::needed_by(plan, User::Steps);
    if span_count(objective_invocations(problem.free_count())) == 0 {
        kernels.retain(|kernel| *kernel != Kernel::AddUpStep);
    }
    if slides {
        kernels.extend(Kernel::needed_by(plan, User::Slides));
    }
    kernels.extend([along, Kernel::SumAlongCorrection, Kernel::MoveAlongCorrection]);
    kernels
}

/// A mesh on a device, with the positions of its fixed vertices.
pub(crate) struct OnDevice<'d> {
    pub(crate) gpu: &'d Gpu,
    pub(crate) problem: &'d Problem,
    pub(crate) start: &'d [DVec2],
    pub(crate) mesh: &'d mut MeshBuffers,
    pub(crate) dispatches: &'d Dispatches,
    pub(crate) waiting: Waiting,
}

impl OnDevice<'_> {
    /// Returns the number of triangles by which a step is judged.
    fn count(&self) -> f64 {
        self.problem.judged_count() as f64
    }
}

/// A mesh on a device prepared for Newton steps.
pub(crate) struct Truncated {
    prepared: Prepared,
    /// Number of iterations that the next submission holds.
    expected: u32,
}

impl Truncated {
    /// Prepares a mesh for Newton steps by the base metric of a run.
    ///
    /// # Errors
    /// [`GpuError::Limit`] if the Hessian is too large for the device, or another [`GpuError`] if the device fails.
    pub(crate) async fn new(
        gpu: &Gpu,
        problem: &Problem,
        mesh: &MeshBuffers,
        dispatches: &Dispatches,
    ) -> Result<Self, GpuError> {
        let list = List::new(gpu, problem, mesh, dispatches).await?;
        let prepared = list.bound(gpu, problem, mesh, dispatches).await?;
        Ok(Self { prepared, expected: FIRST_ITERATIONS })
    }

    /// Sweeps by `sweep`, and takes a Newton step from there.
    pub(crate) async fn sweep_and_step(
        &mut self,
        on: &OnDevice<'_>,
        sweep: &SweepParams,
        request: &StepRequest,
        goes_on: &mut GoesOn<'_>,
    ) -> Result<NewtonStep, GpuError> {
        let Prepared { set_up, iteration, trials, state: buffer, .. } = &self.prepared;
        let mut state = begin(request, on.count(), false);
        self.write(on, &state)?;
        let mut set_up = Some(set_up);
        while state.is_searched == 0 {
            let iterations = if state.is_solved == 0 { self.expected } else { 0 };
            let encode = |encoder: &mut wgpu::CommandEncoder| {
                let mut passes = encoder.passes("gpu-smooth run");
                if let Some(set_up) = set_up.take() {
                    on.dispatches.encode_sweep(&mut passes, sweep);
                    self.encode(&mut passes, set_up);
                }
                (0..iterations).for_each(|_| self.encode(&mut passes, iteration));
                self.encode(&mut passes, trials);
            };
            let copied = readback::submit_and_copy::<StepState>(on.gpu, encode, buffer, 1)?;
            state = copied.first(on.waiting).await?;
            self.expected = expected_after(&state);
            if state.is_solved == 0 && !goes_on() {
                state = given_up(state);
                self.write(on, &state)?;
            }
        }
        Ok(taken(&state, on.count()))
    }

    /// Times the kernels of a step from the present positions, with a number of iterations of conjugate gradients.
    pub(crate) async fn timed(
        &self,
        on: &OnDevice<'_>,
        request: &StepRequest,
        iterations: u32,
        timestamps: &mut Timestamps,
    ) -> Result<Vec<Span>, GpuError> {
        let Prepared { set_up, iteration, trials, .. } = &self.prepared;
        self.write(on, &begin(request, on.count(), false))?;
        let device = &on.gpu.device;
        let mut encoder = scoped(device, || device.create_command_encoder(&Default::default()))?;
        let mut timed = timestamps.time(&mut encoder);
        let mut passes = timed.passes("gpu-smooth run");
        self.encode(&mut passes, set_up);
        (0..iterations).for_each(|_| self.encode(&mut passes, iteration));
        self.encode(&mut passes, trials);
        drop(passes);
        let spans = timed.resolve()?;
        scoped(device, || on.gpu.queue.submit([encoder.finish()]))?;
        spans.wait(on.waiting).await
    }

    /// Measures how far a step from the present positions could lower the mean excess. Moves no vertex. `None` if the model has
    /// negative curvature, or if the run does not go on.
    pub(crate) async fn remaining(
        &mut self,
        on: &OnDevice<'_>,
        request: &StepRequest,
        goes_on: &mut GoesOn<'_>,
    ) -> Result<Option<f64>, GpuError> {
        let begin = begin(request, on.count(), false);
        let (state, _) = self.solve(on, &begin, None, goes_on).await?;
        Ok(gain_of(&state, on.count()))
    }

    /// Solves for a step from the present positions. Returns the state, and the vectors in the given bytes of `fine`.
    async fn solve(
        &mut self,
        on: &OnDevice<'_>,
        begin: &StepState,
        vectors: Option<Range<u64>>,
        goes_on: &mut GoesOn<'_>,
    ) -> Result<(StepState, Vec<[f32; 2]>), GpuError> {
        self.write(on, begin)?;
        let Prepared { set_up, iteration, state: buffer, fine, .. } = &self.prepared;
        let whole = size_of::<StepState>();
        let vectors = vectors.map(|range| (fine, range));
        let sources: Vec<_> = [(buffer, 0..whole as u64)].into_iter().chain(vectors).collect();
        let mut set_up = Some(set_up);
        loop {
            let encode = |encoder: &mut wgpu::CommandEncoder| {
                let mut passes = encoder.passes("gpu-smooth run");
                set_up.take().into_iter().for_each(|set_up| self.encode(&mut passes, set_up));
                (0..self.expected).for_each(|_| self.encode(&mut passes, iteration));
            };
            let copied = readback::submit_and_copy_ranges::<u32>(on.gpu, encode, &sources)?;
            let words = copied.values(on.waiting).await?;
            let (state, vectors) = words.split_at(whole / size_of::<u32>());
            let mut state: StepState = bytemuck::pod_read_unaligned(bytemuck::cast_slice(state));
            self.expected = expected_after(&state);
            if state.is_solved == 0 && !goes_on() {
                state = given_up(state);
                self.write(on, &state)?;
            }
            if state.is_solved != 0 {
                return Ok((state, bytemuck::cast_slice(vectors).to_vec()));
            }
        }
    }

    /// Writes the state of a step to the device.
    fn write(&self, on: &OnDevice<'_>, state: &StepState) -> Result<(), GpuError> {
        scoped(&on.gpu.device, || {
            on.gpu.queue.write_buffer(&self.prepared.state, 0, bytemuck::bytes_of(state));
        })
    }

    fn encode(&self, passes: &mut Passes<'_>, list: &[Dispatch]) {
        let Prepared { bind_groups, stride, .. } = &self.prepared;
        list.iter().for_each(|step| encode(passes, bind_groups, *stride, step));
    }
}

#[cfg(test)]
impl Truncated {
    /// Returns the state after the last step, and the coefficients of its `count` iterations.
    async fn solved(
        &self,
        gpu: &Gpu,
        count: usize,
    ) -> Result<(StepState, Vec<[f32; 2]>), GpuError> {
        let state = readback::read(gpu, &self.prepared.state, 1, Waiting::Block).await?[0];
        let Prepared { fine, step, .. } = &self.prepared;
        let at = (step.tangents - StepRequest::MOST_ITERATIONS) as usize;
        let vectors = readback::read(gpu, fine, at + count, Waiting::Block).await?;
        Ok((state, vectors[at..].to_vec()))
    }
}

/// Returns the number of iterations that the submission after a state holds.
fn expected_after(state: &StepState) -> u32 {
    let [least, most] = ITERATIONS;
    let more = if state.is_solved == 0 { 0 } else { MORE };
    (state.iterations + more).clamp(least, most)
}

/// Returns the state at the begin of a step. `slides` tells whether vertices slide.
fn begin(request: &StepRequest, count: f64, slides: bool) -> StepState {
    let node = ErrorBound::BELOW * request.least_ritz;
    let rough = ErrorBound::BELOW * StepRequest::ROUGH_RITZ;
    StepState {
        is_solved: 0,
        iterations: 0,
        is_curved_down: 0,
        is_searched: 0,
        trials: 0,
        is_broken: 0,
        length: 0.0,
        next_length: 1.0,
        alpha: 0.0,
        beta: 0.0,
        rho: 0.0,
        model_gain: 0.0,
        descent: 0.0,
        bound: f32::MAX,
        least_ritz: f32::MAX,
        node: node as f32,
        gamma: node.recip() as f32,
        rough_node: rough as f32,
        rough_gamma: rough.recip() as f32,
        forcing: request.forcing as f32,
        least_gain: (request.least_gain * request.objective * count) as f32,
        slides: slides.into(),
        here: [0.0; 2],
        there: [0.0; 2],
    }
}

/// Returns the state of a step whose iterations end without a solution: the search then refuses all lengths.
fn given_up(state: StepState) -> StepState {
    StepState { is_solved: 1, model_gain: 0.0, descent: 0.0, bound: f32::MAX, ..state }
}

/// Returns the step in the form of all engines. `state` is the device's state after the step, and `count` the number of triangles.
fn taken(state: &StepState, count: f64) -> NewtonStep {
    let mean = |sum: f32| f64::from(sum) / count;
    let swept = unpair(state.here) / count;
    let is_moved = state.length > 0.0;
    let known = |x: f32| if x < f32::MAX * 0.5 { f64::from(x) } else { f64::INFINITY };
    NewtonStep {
        swept,
        excess: if is_moved { unpair(state.there) / count } else { swept },
        model_gain: mean(state.model_gain),
        bound: known(state.bound) / count,
        least_ritz: known(state.least_ritz),
        length: state.length.into(),
        is_curved_down: state.is_curved_down != 0,
        is_broken: state.is_broken != 0,
        is_exact: true,
        slides: state.slides != 0,
        held: 0,
        iterations: state.iterations,
    }
}

/// Returns how far the step of a state could lower the mean excess; see [`could_gain`].
fn gain_of(state: &StepState, count: f64) -> Option<f64> {
    let NewtonStep { model_gain, bound, is_curved_down, .. } = taken(state, count);
    could_gain(model_gain, bound, is_curved_down)
}
