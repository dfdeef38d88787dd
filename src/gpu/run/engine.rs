//! The wgpu engine: several sweeps to a submission, judged on the device.

use glam::DVec2;

use crate::error::GpuError;
use crate::gpu::device::Gpu;
use crate::gpu::device::readback::{self, Waiting};
use crate::gpu::encode::sealed::Target;
use crate::gpu::kernels::uniforms::{Control, HISTORY, SLOTS, join, split, unpair};
use crate::gpu::mesh::MeshBuffers;
use crate::gpu::run::Run;
use crate::gpu::scope::scoped;
use crate::layout::Problem;
use crate::run::Objectives;
use crate::run::{Plan, Stop};

/// A run on a device.
pub struct GpuEngine<'a> {
    gpu: &'a Gpu,
    problem: &'a Problem,
    start: &'a [DVec2],
    mesh: MeshBuffers,
    run: Run,
    waiting: Waiting,
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
        let mesh = MeshBuffers::new(gpu, problem, start)?;
        let keep_best = !plan.is_monotone();
        let run = Run::new(gpu, problem, &mesh, plan, keep_best)?;
        let waiting = Waiting::Block;
        Ok(Self { gpu, problem, start, mesh, run, waiting, evaluated: 0, stop: None })
    }

    /// Lets the asynchronous calls wait for somebody else to poll the device.
    #[must_use]
    pub(crate) fn waiting(mut self, waiting: Waiting) -> Self {
        self.waiting = waiting;
        self
    }

    /// Submits `sweeps` sweeps, the first evaluation in front if there was none yet.
    fn submit(&self, sweeps: u32) -> Result<(), GpuError> {
        let label = Some("gpu-smooth sweeps");
        scoped(&self.gpu.device, || {
            let mut encoder =
                self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label });
            {
                let mut passes = encoder.passes("gpu-smooth sweeps");
                if self.evaluated == 0 {
                    self.run.encode_evaluation(&mut passes);
                }
                let first = self.evaluated.max(1);
                for sweep in first..first + sweeps {
                    self.run.encode_sweep(&mut passes, sweep);
                    self.run.encode_evaluation(&mut passes);
                }
            }
            self.gpu.queue.submit([encoder.finish()]);
        })
    }

    /// Reads what the device has done since the last call.
    async fn collect(&mut self, log: &mut Vec<Objectives>) -> Result<(), GpuError> {
        let control: Vec<Control> =
            readback::read(self.gpu, &self.run.control, 1, self.waiting).await?;
        let Some(control) = control.first() else { return Ok(()) };
        for evaluation in self.evaluated..control.evaluated {
            let sums = control.history[(evaluation % HISTORY) as usize];
            log.push(objectives_of(&self.run.plan, &sums, self.problem));
        }
        self.evaluated = control.evaluated;
        self.stop = Stop::from_code(control.done);
        Ok(())
    }

    /// [`Engine::advance`](crate::Engine::advance), as a future.
    pub(crate) async fn advance(&mut self, sweeps: u32) -> Result<Vec<Objectives>, GpuError> {
        let mut log = Vec::new();
        let mut left = sweeps;
        while self.stop.is_none() && (left > 0 || self.evaluated == 0) {
            // The device's history must be read before it wraps.
            let batch = left.min(HISTORY / 2);
            self.submit(batch)?;
            self.collect(&mut log).await?;
            left -= batch;
        }
        Ok(log)
    }

    /// [`Engine::best_positions`](crate::Engine::best_positions), as a future.
    pub(crate) async fn best_positions(&mut self) -> Result<Vec<DVec2>, GpuError> {
        let free = self.problem.free_count();
        let moved = match self.run.plan.is_monotone() {
            true => self.mesh.read_positions(self.gpu, free, self.waiting).await?,
            false => readback::read(self.gpu, &self.run.best, free, self.waiting).await?,
        };
        Ok(moved_positions(moved, self.start))
    }
}

/// The positions that started at `start`, the first of them as the device has `moved` them. Fixed vertices have
/// not moved, and a free one that has not keeps all its bits, which the device's pairs of floats do not hold.
pub(crate) fn moved_positions(moved: Vec<[f32; 4]>, start: &[DVec2]) -> Vec<DVec2> {
    let mut positions = start.to_vec();
    for (position, now) in positions.iter_mut().zip(moved) {
        if now != split(*position) {
            *position = join(now);
        }
    }
    positions
}

/// The objectives from the sums of one evaluation.
pub(crate) fn objectives_of(
    plan: &Plan,
    sums: &[[f32; 2]; SLOTS],
    problem: &Problem,
) -> Objectives {
    let mut values = Objectives::untracked();
    for metric in plan.tracked() {
        let excess = unpair(sums[metric as usize]) / problem.triangles().len() as f64;
        values.set(metric, metric.ideal_squared() + excess);
    }
    values
}

impl crate::run::Engine for GpuEngine<'_> {
    fn advance(&mut self, sweeps: u32) -> Result<Vec<Objectives>, GpuError> {
        pollster::block_on(GpuEngine::advance(self, sweeps))
    }

    fn stop(&self) -> Option<Stop> {
        self.stop
    }

    fn best_positions(&mut self) -> Result<Vec<DVec2>, GpuError> {
        pollster::block_on(GpuEngine::best_positions(self))
    }
}
