//! The wgpu engine: several sweeps to a submission, judged on the device.

use glam::DVec2;

use super::buffers::{Buffers, join, split};
use super::device::{Gpu, GpuError, scoped};
use super::layout::{Control, HISTORY, WORKGROUP, unpair};
use super::readback;
use super::shaders::Kernel;
use crate::engine::{Engine, EngineError, Objectives};
use crate::metric::Metric;
use crate::plan::{Plan, Stop};
use crate::problem::Problem;

/// Workgroups along x of a dispatch too long for one dimension.
const FOLD: u32 = 32768;

/// A run on a device.
pub struct GpuEngine<'a> {
    gpu: &'a Gpu,
    problem: &'a Problem,
    start: &'a [DVec2],
    plan: Plan,
    buffers: Buffers,
    sweeps: Vec<(Metric, wgpu::ComputePipeline)>,
    objective: wgpu::ComputePipeline,
    finish: wgpu::ComputePipeline,
    keep_best: Option<wgpu::ComputePipeline>,
    /// Evaluations read back so far.
    evaluated: u32,
    stop: Option<Stop>,
}

impl<'a> GpuEngine<'a> {
    /// Uploads the problem with its vertices at `start` (normalized and in the problem's order)
    /// and makes the pipelines the plan needs.
    ///
    /// # Errors
    /// [`GpuError::Limit`] if the mesh is too large for the device, or what the device refuses.
    pub fn new(
        gpu: &'a Gpu,
        problem: &'a Problem,
        start: &'a [DVec2],
        plan: Plan,
    ) -> Result<Self, GpuError> {
        gpu.check()?;
        let buffers = Buffers::new(gpu, problem, start, &plan)?;
        let pipeline = |kernel| gpu.pipelines.get(&gpu.device, &kernel);
        let mut sweeps: Vec<(Metric, wgpu::ComputePipeline)> = Vec::new();
        for &metric in plan.scheme.metrics() {
            if sweeps.iter().all(|&(known, _)| known != metric) {
                sweeps.push((metric, pipeline(Kernel::Sweep(metric, plan.derivatives))?));
            }
        }
        let objective = pipeline(Kernel::Objective(plan.tracked()))?;
        let finish = pipeline(Kernel::Finish(plan.tracked()))?;
        let keep_best = match plan.is_monotone() {
            true => None,
            false => Some(pipeline(Kernel::KeepBest)?),
        };
        Ok(Self {
            gpu,
            problem,
            start,
            plan,
            buffers,
            sweeps,
            objective,
            finish,
            keep_best,
            evaluated: 0,
            stop: None,
        })
    }

    /// Submits `sweeps` sweeps, the first evaluation in front if there was none yet.
    fn submit(&self, sweeps: u32) -> Result<(), GpuError> {
        scoped(&self.gpu.device, || {
            let mut encoder =
                self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor {
                    label: Some("gpu-smooth sweeps"),
                });
            {
                let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                    label: Some("gpu-smooth sweeps"),
                    timestamp_writes: None,
                });
                if self.evaluated == 0 {
                    self.encode_evaluation(&mut pass);
                }
                let first = self.evaluated.max(1);
                for sweep in first..first + sweeps {
                    self.encode_sweep(&mut pass, sweep);
                    self.encode_evaluation(&mut pass);
                }
            }
            self.gpu.queue.submit([encoder.finish()]);
        })
    }

    fn encode_sweep(&self, pass: &mut wgpu::ComputePass<'_>, sweep: u32) {
        let metric = self.plan.scheme.metric(sweep);
        if let Some((_, pipeline)) = self.sweeps.iter().find(|&&(known, _)| known == metric) {
            pass.set_pipeline(pipeline);
        }
        for (color, range) in (0..).zip(self.problem.colors()) {
            pass.set_bind_group(0, &self.buffers.bind_group, &[color * self.buffers.color_stride]);
            dispatch(pass, range.end - range.start);
        }
    }

    /// Evaluates the objectives, judges, and keeps the positions if they are the best.
    fn encode_evaluation(&self, pass: &mut wgpu::ComputePass<'_>) {
        pass.set_bind_group(0, &self.buffers.bind_group, &[0]);
        pass.set_pipeline(&self.objective);
        pass.dispatch_workgroups(self.buffers.objective_groups, 1, 1);
        pass.set_pipeline(&self.finish);
        pass.dispatch_workgroups(1, 1, 1);
        if let Some(keep_best) = &self.keep_best {
            pass.set_pipeline(keep_best);
            dispatch(pass, self.problem.free_count() as u32);
        }
    }

    /// Reads what the device has done since the last call.
    fn collect(&mut self, log: &mut Vec<Objectives>) -> Result<(), GpuError> {
        let control: Vec<Control> = readback::read(self.gpu, &self.buffers.control, 1)?;
        let Some(control) = control.first() else { return Ok(()) };
        let triangles = self.problem.triangles().len() as f64;
        for evaluation in self.evaluated..control.evaluated {
            let sums = control.history[(evaluation % HISTORY) as usize];
            let mut values = Objectives::untracked();
            for metric in self.plan.tracked() {
                let excess = unpair(sums[metric as usize]) / triangles;
                values.set(metric, metric.ideal_squared() + excess);
            }
            log.push(values);
        }
        self.evaluated = control.evaluated;
        self.stop = Stop::from_code(control.done);
        Ok(())
    }
}

impl Engine for GpuEngine<'_> {
    fn advance(&mut self, sweeps: u32) -> Result<Vec<Objectives>, EngineError> {
        let mut log = Vec::new();
        let mut left = sweeps;
        while self.stop.is_none() && (left > 0 || self.evaluated == 0) {
            // The device's history must be read before it wraps.
            let batch = left.min(HISTORY / 2);
            self.submit(batch)?;
            self.collect(&mut log)?;
            left -= batch;
        }
        Ok(log)
    }

    fn stop(&self) -> Option<Stop> {
        self.stop
    }

    fn best_positions(&mut self) -> Result<Vec<DVec2>, EngineError> {
        let buffer = match self.keep_best {
            Some(_) => &self.buffers.best,
            None => &self.buffers.positions,
        };
        // Fixed vertices have not moved, and a free one that has not keeps all its bits, which the
        // device's pairs of floats do not hold.
        let free = self.problem.free_count();
        let moved: Vec<[f32; 4]> = readback::read(self.gpu, buffer, free)?;
        let mut positions = self.start.to_vec();
        for (position, now) in positions.iter_mut().zip(moved) {
            if now != split(*position) {
                *position = join(now);
            }
        }
        Ok(positions)
    }
}

/// Dispatches enough workgroups for `invocations`, folded where one dimension is too short.
fn dispatch(pass: &mut wgpu::ComputePass<'_>, invocations: u32) {
    let groups = invocations.div_ceil(WORKGROUP);
    if groups <= FOLD {
        pass.dispatch_workgroups(groups, 1, 1);
    } else {
        pass.dispatch_workgroups(FOLD, groups.div_ceil(FOLD), 1);
    }
}
