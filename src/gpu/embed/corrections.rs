//! Corrections from coarser levels, for sweeps that an application encodes. The line search along a correction runs on
//! the device.

use crate::error::GpuError;
use crate::gpu::device::pending::Waiting;
use crate::gpu::embed::DeviceMesh;
use crate::gpu::encode::Passes;
use crate::gpu::encode::sealed::Target;
use crate::gpu::kernels::form::Positions;
use crate::gpu::kernels::layouts::SearchBindings;
use crate::gpu::kernels::pipelines::Pipeline;
use crate::gpu::kernels::table::Kernel;
use crate::gpu::kernels::uniforms::SEARCH_TRIALS;
use crate::gpu::mesh::MeshBuffers;
use crate::gpu::run::{Dispatches, Fitting, Levels, stiffness};
use crate::gpu::scope::scoped;
use crate::metric::Smoothing;
use crate::parallel::pace::now;
use crate::run::multilevel::Hierarchy;
use crate::run::{Plan, SweepParams};

/// Number of sweeps before the levels are built. In a mesh of poor triangles, a few vertices are far stiffer than all
/// others. Aggregates by this stiffness do not fit the smoothed mesh.
const SWEEPS: u32 = 10;

/// Coarser levels of a mesh on the device, and a line search along their corrections that reads nothing back. The
/// search encodes a fixed number of trials; surplus trials do nothing.
pub(crate) struct EncodedCorrections {
    levels: Levels,
    begin: Pipeline,
    judge: Pipeline,
    bind_group: wgpu::BindGroup,
}

/// A copy of a mesh on the device, after some sweeps.
struct Swept {
    buffers: MeshBuffers,
    dispatches: Dispatches,
}

impl EncodedCorrections {
    /// Builds the levels for the mesh as it would be after [`SWEEPS`] sweeps by `step`, and after all submitted work, for
    /// which the function waits.
    ///
    /// # Errors
    /// [`GpuError::Limit`] if the levels are too large for the device, or another [`GpuError`] if the device fails.
    pub(crate) async fn new(
        mesh: &DeviceMesh,
        dispatches: &Dispatches,
        step: &SweepParams,
        waiting: Waiting,
    ) -> Result<Self, GpuError> {
        let DeviceMesh { gpu, problem, buffers, .. } = mesh;
        let (free, smoothing) = (problem.free_count() as u32, Smoothing::of(0));
        let Swept { buffers: copy, dispatches: of_copy } = swept(mesh, &dispatches.plan, step)?;
        let roots = stiffness::roots(gpu, &copy, &of_copy, free, smoothing, waiting).await?;
        drop((copy, of_copy));
        let hierarchy = Hierarchy::new(problem, roots).await;
        let levels =
            Levels::new(gpu, problem, buffers, dispatches, &hierarchy, Fitting::EachTime).await?;
        let whole = Positions::Whole;
        let pipeline = |kernel| gpu.pipelines.get(&gpu.device, &kernel, whole);
        let (begin, judge) = (pipeline(Kernel::BeginSearch)?, pipeline(Kernel::JudgeTrial)?);
        let bind_group = scoped(&gpu.device, || {
            let bindings = SearchBindings {
                params: dispatches.params.as_entire_binding(),
                control: dispatches.control.as_entire_binding(),
                vectors: levels.vectors.as_entire_binding(),
            };
            gpu.pipelines.bind(&gpu.device, whole, bindings)
        })?;
        Ok(Self { levels, begin, judge, bind_group })
    }

    /// Encodes one correction, which does nothing if the sweeps have ended by the stop rule.
    pub(crate) fn encode(&self, passes: &mut Passes<'_>) {
        self.run(passes, &self.begin);
        self.levels.encode_gradient(passes);
        self.levels.encode_cycle(passes);
        for _ in 0..SEARCH_TRIALS {
            self.levels.encode_objective(passes);
            self.run(passes, &self.judge);
        }
        self.levels.encode_movement(passes);
    }

    fn run(&self, passes: &mut Passes<'_>, pipeline: &Pipeline) {
        passes.run(pipeline, None, |pass| {
            pass.set_bind_group(0, &self.bind_group, &[]);
            pass.dispatch_workgroups(1, 1, 1);
        });
    }
}

/// Returns a copy of the mesh after [`SWEEPS`] sweeps by the step of a plan, with the dispatches of the copy. Frames
/// that other threads submit meanwhile do not see the sweeps.
fn swept(mesh: &DeviceMesh, plan: &Plan, step: &SweepParams) -> Result<Swept, GpuError> {
    let DeviceMesh { gpu, problem, buffers, .. } = mesh;
    let copy = buffers.copied(gpu)?;
    let plan = plan.clone().endless();
    let dispatches = now(Dispatches::new(gpu, problem, &copy, plan, vec![*step], false))?;
    scoped(&gpu.device, || {
        let label = "gpu-smooth sweeps before levels";
        let descriptor = wgpu::CommandEncoderDescriptor { label: Some(label) };
        let mut encoder = gpu.device.create_command_encoder(&descriptor);
        let mut passes = encoder.passes(label);
        for _ in 0..SWEEPS {
            dispatches.encode_sweep(&mut passes, step);
        }
        drop(passes);
        gpu.queue.submit([encoder.finish()]);
    })?;
    Ok(Swept { buffers: copy, dispatches })
}
