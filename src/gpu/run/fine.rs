//! The mesh itself in a multilevel run on a device.

use glam::DVec2;
use std::borrow::Cow;

use crate::error::GpuError;
use crate::gpu::device::Gpu;
use crate::gpu::device::readback::{self, Waiting};
use crate::gpu::encode::Passes;
use crate::gpu::encode::sealed::Target;
use crate::gpu::kernels::uniforms::{Control, HISTORY, unpair};
use crate::gpu::mesh::MeshBuffers;
use crate::gpu::run::Run;
use crate::gpu::run::engine::{moved_positions, objectives_of};
use crate::gpu::run::levels::Levels;
use crate::gpu::scope::scoped;
use crate::layout::Problem;
use crate::metric::Metric;
use crate::run::Objectives;
use crate::run::multilevel::{FineLevel, Hierarchy, Proposal};
use crate::run::{Plan, StopRule};

/// Positions on a device, and where the last correction leads. The host decides each step, from a few
/// numbers that it reads back.
pub(crate) struct GpuFine<'a> {
    gpu: &'a Gpu,
    problem: &'a Problem,
    start: &'a [DVec2],
    metric: Metric,
    mesh: MeshBuffers,
    run: Run,
    levels: Option<Levels>,
    /// What the levels were made from.
    hierarchy: Option<Hierarchy>,
    waiting: Waiting,
}

impl<'a> GpuFine<'a> {
    /// Uploads the problem with its vertices at `start` (normalized and in the problem's order).
    ///
    /// # Errors
    /// As [`GpuEngine::new`](crate::gpu::GpuEngine::new).
    pub(crate) fn new(
        gpu: &'a Gpu,
        problem: &'a Problem,
        start: &'a [DVec2],
        plan: &Plan,
        waiting: Waiting,
    ) -> Result<Self, GpuError> {
        gpu.check()?;
        let mesh = MeshBuffers::new(gpu, problem, start)?;
        // The host judges: on the device nothing ever ends.
        let stop = StopRule { target: None, tolerance: 0.0, max_sweeps: u32::MAX };
        let run = Run::new(gpu, problem, &mesh, Plan { stop, ..plan.clone() }, false)?;
        let metric = plan.scheme.base();
        let (levels, hierarchy) = (None, None);
        Ok(Self { gpu, problem, start, metric, mesh, run, levels, hierarchy, waiting })
    }

    fn submit(&self, encode: impl FnOnce(&mut Passes<'_>)) -> Result<(), GpuError> {
        let label = "gpu-smooth multilevel";
        let descriptor = wgpu::CommandEncoderDescriptor { label: Some(label) };
        scoped(&self.gpu.device, || {
            let mut encoder = self.gpu.device.create_command_encoder(&descriptor);
            encode(&mut encoder.passes(label));
            self.gpu.queue.submit([encoder.finish()]);
        })
    }

    /// The four totals of the objective along the correction.
    async fn totals(&self, levels: &Levels) -> Result<Proposal, GpuError> {
        let totals: Vec<[f32; 2]> =
            readback::read(self.gpu, &levels.vectors, 4, self.waiting).await?;
        let total = |i: usize| totals.get(i).map_or(f64::NAN, |&sum| unpair(sum));
        let triangles = self.problem.triangles().len() as f64;
        Ok(Proposal {
            here: total(0) / triangles,
            there: (total(2) == 0.0).then(|| total(1) / triangles),
            slope: total(3) / triangles,
        })
    }
}

impl FineLevel for GpuFine<'_> {
    async fn objectives(&mut self) -> Result<Objectives, GpuError> {
        self.submit(|passes| self.run.encode_evaluation(passes))?;
        let control: Vec<Control> =
            readback::read(self.gpu, &self.run.control, 1, self.waiting).await?;
        let last = control
            .first()
            .map(|control| control.history[((control.evaluated - 1) % HISTORY) as usize]);
        Ok(match last {
            Some(sums) => objectives_of(&self.run.plan, &sums, self.problem),
            None => Objectives::untracked(),
        })
    }

    async fn sweep(&mut self, omega: f64) -> Result<(), GpuError> {
        self.submit(|passes| self.run.encode_relaxed_sweep(passes, omega))
    }

    async fn positions(&mut self) -> Result<Cow<'_, [DVec2]>, GpuError> {
        let free = self.problem.free_count();
        let moved = self.mesh.read_positions(self.gpu, free, self.waiting).await?;
        Ok(Cow::Owned(moved_positions(moved, self.start)))
    }

    fn hierarchy(&mut self) -> Option<Hierarchy> {
        self.hierarchy.take()
    }

    fn set_hierarchy(&mut self, hierarchy: Hierarchy) -> Result<(), GpuError> {
        // Two at once would be more than the mesh itself.
        self.levels = None;
        self.levels = Some(Levels::new(
            self.gpu,
            self.problem,
            &self.mesh,
            &self.run.params,
            self.metric,
            &hierarchy,
        )?);
        self.hierarchy = Some(hierarchy);
        Ok(())
    }

    async fn propose(&mut self, omega: f64, length: f64) -> Result<Proposal, GpuError> {
        let Some(levels) = &self.levels else {
            return Ok(Proposal { here: f64::NAN, slope: 0.0, there: None });
        };
        levels.set_length(self.gpu, length as f32);
        self.submit(|passes| {
            self.run.encode_relaxed_sweep(passes, omega);
            levels.encode_correction(passes);
            levels.encode_along(passes);
        })?;
        self.totals(levels).await
    }

    async fn objective_along(&mut self, length: f64) -> Result<Option<f64>, GpuError> {
        let Some(levels) = &self.levels else { return Ok(None) };
        levels.set_length(self.gpu, length as f32);
        self.submit(|passes| levels.encode_along(passes))?;
        Ok(self.totals(levels).await?.there)
    }

    async fn take(&mut self, length: f64) -> Result<(), GpuError> {
        let Some(levels) = &self.levels else { return Ok(()) };
        levels.set_length(self.gpu, length as f32);
        self.submit(|passes| levels.encode_take(passes))
    }
}
