//! Newton steps on a device with vertices that slide along curves. The bounds of a curve join many vertices, so the host finds the
//! tangents before a step, and places the sliding vertices before each trial.

use glam::DVec2;

use super::buffers::PAIR;
use super::list::Prepared;
use super::{OnDevice, Truncated, begin, gain_of, taken};
use crate::error::GpuError;
use crate::gpu::device::readback;
use crate::gpu::encode::sealed::Target;
use crate::gpu::kernels::uniforms::{CurvePlace, StepLine, StepOp, StepState, split};
use crate::gpu::scope::scoped;
use crate::run::multilevel::NONE;
use crate::run::truncated::{NewtonStep, StepRequest};
use crate::run::{GoesOn, SweepParams};
use crate::slide::{OnCurves, Params, Tangents};

/// The sliding vertices in a step.
struct Sliding {
    curves: OnCurves,
    tangents: Tangents,
}

impl Truncated {
    /// Sweeps by `sweep`, and takes a Newton step from there. The host waits for the gradient at the sliding vertices, for the
    /// solution at these vertices, and for each trial of a length.
    pub(crate) async fn sweep_and_slide(
        &mut self,
        on: &mut OnDevice<'_>,
        sweep: &SweepParams,
        request: &StepRequest,
        goes_on: &mut GoesOn<'_>,
    ) -> Result<NewtonStep, GpuError> {
        let mut sliding = self.slides(on, Some(sweep)).await?;
        let is_exact = sliding.tangents.restrict(request.is_exact);
        let count = on.count();
        let (mut state, solution) =
            self.solve_with(on, &sliding.tangents, &begin(request, count, true), goes_on).await?;
        let mut to = None;
        while state.is_searched == 0 {
            let placed = self.place(on, &sliding, &solution, state.next_length)?;
            let encode = |encoder: &mut wgpu::CommandEncoder| {
                self.encode(&mut encoder.passes("gpu-smooth run"), &self.prepared.trials);
            };
            let copied = readback::submit_and_copy(on.gpu, encode, &self.prepared.state, 1)?;
            state = copied.first(on.waiting).await?;
            to = Some(placed);
        }
        if let (true, Some(to)) = (state.length > 0.0, to) {
            sliding.curves.set_params(&to);
            self.write_positions(on, &sliding.curves)?;
        }
        sliding.curves.record_step(state.length.into());
        if let Some(curves) = &mut on.mesh.curves {
            curves.write(on.gpu, on.problem, &sliding.curves, None)?;
        }
        let held = sliding.tangents.vertices.iter().filter(|vertex| vertex.is_held).count();
        Ok(NewtonStep { held, is_exact, ..taken(&state, count) })
    }

    /// Measures as [`remaining`](Self::remaining) does, with vertices that slide.
    pub(crate) async fn remaining_with_slides(
        &mut self,
        on: &OnDevice<'_>,
        request: &StepRequest,
        goes_on: &mut GoesOn<'_>,
    ) -> Result<Option<f64>, GpuError> {
        let mut sliding = self.slides(on, None).await?;
        sliding.tangents.restrict(request.is_exact);
        let count = on.count();
        let begin = begin(request, count, true);
        let (state, _) = self.solve_with(on, &sliding.tangents, &begin, goes_on).await?;
        Ok(gain_of(&state, count))
    }

    /// Returns the sliding vertices with their tangents, after a sweep if given.
    async fn slides(
        &self,
        on: &OnDevice<'_>,
        sweep: Option<&SweepParams>,
    ) -> Result<Sliding, GpuError> {
        let Prepared { gradient, fine, .. } = &self.prepared;
        let lost = || GpuError::Lost("no vertex slides".into());
        let curves = on.mesh.curves.as_ref().ok_or_else(lost)?;
        let encode = |encoder: &mut wgpu::CommandEncoder| {
            let mut passes = encoder.passes("gpu-smooth run");
            sweep.into_iter().for_each(|sweep| on.dispatches.encode_sweep(&mut passes, sweep));
            self.encode(&mut passes, gradient);
        };
        let residual = self.of_boundary(0);
        let pairs = (residual.end - residual.start) / PAIR;
        let places = (curves.count * size_of::<CurvePlace>()) as u64;
        let sources = [(fine, residual), (&curves.places, 0..places)];
        let copied = readback::submit_and_copy_ranges::<u32>(on.gpu, encode, &sources)?;
        let words = copied.values(on.waiting).await?;
        let (residual, places) = words.split_at(2 * pairs as usize);
        let mut curves = curves.at(on.problem, bytemuck::cast_slice(places));
        let residual: &[[f32; 2]] = bytemuck::cast_slice(residual);
        let free = on.problem.free_count();
        let tangents = curves.tangents(on.problem, |fan| {
            let [x, y] = residual[fan.own() as usize - free];
            -DVec2::new(x.into(), y.into())
        });
        Ok(Sliding { curves, tangents })
    }

    /// Solves for a step in which the tangents are unknowns too. Returns the state, and the solution at all vertices that are
    /// not free.
    async fn solve_with(
        &mut self,
        on: &OnDevice<'_>,
        tangents: &Tangents,
        begin: &StepState,
        goes_on: &mut GoesOn<'_>,
    ) -> Result<(StepState, Vec<[f32; 2]>), GpuError> {
        let Prepared { lines, slides, step, .. } = &self.prepared;
        let vertices = slides.as_ref().map_or(&[][..], |slides| &slides.vertices);
        let unknowns = lines_of(tangents, vertices);
        scoped(&on.gpu.device, || {
            on.gpu.queue.write_buffer(lines, 0, bytemuck::cast_slice(&unknowns));
        })?;
        let solution = self.of_boundary(step.vector);
        self.solve(on, begin, Some(solution), goes_on).await
    }

    /// Moves the sliding vertices by a length along the solution, and writes their ways to the device. Returns their parameters.
    fn place(
        &self,
        on: &OnDevice<'_>,
        sliding: &Sliding,
        solution: &[[f32; 2]],
        length: f32,
    ) -> Result<Params, GpuError> {
        let Prepared { slides, fine, step, .. } = &self.prepared;
        let Sliding { curves, tangents } = sliding;
        let vertices = slides.as_ref().map_or(&[][..], |slides| &slides.vertices);
        let (free, by) = (on.problem.free_count(), f64::from(length));
        let to = curves.along(tangents, |k| {
            let [x, y] = solution[vertices[k] as usize - free];
            by * tangents.vertices[k].along.dot(DVec2::new(x.into(), y.into()))
        });
        let mut ways = vec![[0.0; 2]; solution.len()];
        let from = curves.placed(on.problem, curves.params());
        for ((vertex, from), (_, to)) in from.zip(curves.placed(on.problem, &to)) {
            ways[vertex as usize - free] = ((to - from) / by).as_vec2().to_array();
        }
        scoped(&on.gpu.device, || {
            let at = self.of_boundary(step.vector).start;
            on.gpu.queue.write_buffer(fine, at, bytemuck::cast_slice(&ways));
        })?;
        Ok(to)
    }

    /// Writes the positions of all vertices that are not free, with those of the sliding vertices on their curves.
    fn write_positions(&self, on: &OnDevice<'_>, curves: &OnCurves) -> Result<(), GpuError> {
        let free = on.problem.free_count();
        let mut positions: Vec<[f32; 4]> = on.start[free..].iter().map(|&at| split(at)).collect();
        for (vertex, at) in curves.placed(on.problem, curves.params()) {
            positions[vertex as usize - free] = split(at);
        }
        on.mesh.write_positions_from(on.gpu, free, &positions)
    }

    /// Returns the bytes in `fine` of a vector at all vertices that are not free.
    fn of_boundary(&self, vector: u32) -> std::ops::Range<u64> {
        let StepOp { vertices, movers, .. } = self.prepared.step;
        u64::from(vector + vertices) * PAIR..u64::from(vector + movers) * PAIR
    }
}

/// Returns the sliding vertices as unknowns, given the vertices in the order of the tangents.
fn lines_of(tangents: &Tangents, vertices: &[u32]) -> Vec<StepLine> {
    let mut next = vec![NONE; tangents.curvatures.len()];
    let mut lines: Vec<StepLine> = Vec::with_capacity(vertices.len());
    for (k, (tangent, &vertex)) in tangents.vertices.iter().zip(vertices).enumerate().rev() {
        let unknown = tangent.unknown as usize;
        let later = std::mem::replace(&mut next[unknown], k as u32);
        lines.push(StepLine {
            along: tangent.along.as_vec2().to_array(),
            curvature: tangent.curvature as f32,
            share: tangent.share as f32,
            of_bounds: tangents.curvatures[unknown] as f32,
            vertex,
            next: later,
            is_first: 0,
        });
    }
    lines.reverse();
    next.into_iter().filter(|&first| first != NONE).for_each(|first| {
        lines[first as usize].is_first = 1;
    });
    lines
}
