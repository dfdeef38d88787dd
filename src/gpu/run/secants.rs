//! Secant pairs on the device; see [`crate::run::secant`].

use wgpu::BufferUsages as Usage;

use crate::error::GpuError;
use crate::gpu::device::Gpu;
use crate::gpu::device::buffers::{filled, uniform, write_by_pieces, zeroed};
use crate::gpu::device::pending::Waiting;
use crate::gpu::device::readback;
use crate::gpu::device::size::{objective_invocations, span_count};
use crate::gpu::encode::Passes;
use crate::gpu::kernels::dispatch::dispatch;
use crate::gpu::kernels::layouts::SecantsBindings;
use crate::gpu::kernels::pipelines::Pipeline;
use crate::gpu::kernels::table::Kernel;
use crate::gpu::kernels::uniforms::{SecantOp, WORKGROUP};
use crate::gpu::mesh::MeshBuffers;
use crate::gpu::run::levels::Levels;
use crate::gpu::scope::scoped;
use crate::parallel::pace::pause;
use crate::run::EngineState;

/// Number of scalars in front of the partial sums in the buffer of sums, as in shaders/secants/common.wgsl.
const SCALARS: u32 = 4;

/// Names of the data of the pairs in a saved state of the engine.
const STEPS: &str = "steps";
const OP: &str = "secants";

/// Two secant pairs bound to a mesh and its levels. The methods encode dispatches and submit nothing.
pub(crate) struct Secants {
    bind_group: wgpu::BindGroup,
    ops: wgpu::Buffer,
    /// Steps, changes, low starts and sums.
    buffers: [wgpu::Buffer; 4],
    /// Distance between the two uniforms, in bytes.
    stride: u32,
    close: Pipeline,
    /// The pipeline that adds up partial sums over spans. `None` if one workgroup adds up all.
    add_up: Option<Pipeline>,
    sum: Pipeline,
    bend: Pipeline,
    multiply: Pipeline,
    open: Pipeline,
    op: SecantOp,
}

impl Secants {
    /// Creates an empty set of pairs; `None` if the vectors of two pairs exceed a binding of the device.
    pub(crate) async fn new(
        gpu: &Gpu,
        mesh: &MeshBuffers,
        params: &wgpu::Buffer,
        levels: &Levels,
        free: u32,
    ) -> Result<Option<Self>, GpuError> {
        let limits = gpu.device.limits();
        let vector = u64::from(free) * size_of::<[f32; 2]>() as u64;
        if 2 * vector > limits.max_storage_buffer_binding_size.min(limits.max_buffer_size) {
            return Ok(None);
        }
        let positions = mesh.parts.form();
        let pipeline = |kernel| gpu.pipelines.get(&gpu.device, &kernel, positions);
        let close = pipeline(Kernel::CompletePair)?;
        pause().await;
        let partials = objective_invocations(free as usize);
        let spans = span_count(partials);
        let add_up = (spans > 0).then(|| pipeline(Kernel::AddUpSecants)).transpose()?;
        let sum = pipeline(Kernel::SumSecants)?;
        pause().await;
        let bend = pipeline(Kernel::BendGradient)?;
        pause().await;
        let multiply = pipeline(Kernel::MultiplyCorrection)?;
        pause().await;
        let open = pipeline(Kernel::BeginPair)?;
        pause().await;
        // The first pair opens in the slot of the older pair.
        let op = SecantOp {
            free,
            newer: free,
            older: 0,
            pairs: 0,
            partials,
            is_after: 0,
            padding: [0; 2],
        };
        let alignment = limits.min_uniform_buffer_offset_alignment;
        let stride = (size_of::<SecantOp>() as u32).next_multiple_of(alignment);
        let (bind_group, ops, buffers) = scoped(&gpu.device, || {
            let zeros = vec![0_u8; 2 * stride as usize];
            let ops = filled(gpu, "secant steps", &zeros, Usage::UNIFORM | Usage::COPY_DST);
            let sums = u64::from(SCALARS + 4 * (partials + spans)) * size_of::<[f32; 2]>() as u64;
            let [steps, changes, low_starts, sums] = [
                ("secant steps", 2 * vector),
                ("secant changes", 2 * vector),
                ("secant starts", vector),
                ("secant sums", sums),
            ]
            .map(|(label, size)| {
                zeroed(gpu, label, size, Usage::STORAGE | Usage::COPY_SRC | Usage::COPY_DST)
            });
            let buffers = [steps, changes, low_starts, sums];
            let bind_group = bound(gpu, mesh, params, levels, &ops, &buffers);
            (bind_group, ops, buffers)
        })?;
        Ok(Some(Self {
            bind_group,
            ops,
            buffers,
            stride,
            close,
            add_up,
            sum,
            bend,
            multiply,
            open,
            op,
        }))
    }

    /// Binds the pairs to other levels of the same mesh.
    pub(crate) fn bind_to(
        &mut self,
        gpu: &Gpu,
        mesh: &MeshBuffers,
        params: &wgpu::Buffer,
        levels: &Levels,
    ) -> Result<(), GpuError> {
        let Self { ops, buffers, .. } = self;
        self.bind_group = scoped(&gpu.device, || bound(gpu, mesh, params, levels, ops, buffers))?;
        Ok(())
    }

    /// Returns each buffer's name in a saved state of the engine, and its saved length in pairs of floats.
    fn parts(&self) -> [(&'static str, usize); 4] {
        let free = self.op.free as usize;
        // Of the sums, only the scalars are needed after a correction.
        [(STEPS, 2 * free), ("changes", 2 * free), ("starts", free), ("sums", SCALARS as usize)]
    }

    /// Adds the pairs to a saved state of the engine.
    pub(crate) async fn save(
        &self,
        gpu: &Gpu,
        state: &mut EngineState,
        waiting: Waiting,
    ) -> Result<(), GpuError> {
        state.own.add(OP, self.op);
        for ((name, count), buffer) in self.parts().into_iter().zip(&self.buffers) {
            let values: Vec<[f32; 2]> = readback::read(gpu, buffer, count, waiting).await?;
            state.own.add_list(name, &values);
        }
        Ok(())
    }

    /// Returns whether a saved state of the engine holds secant pairs.
    pub(crate) fn are_in(state: &EngineState) -> bool {
        state.own.list::<[f32; 2]>(STEPS).is_some()
    }

    /// Restores the pairs from a saved state of the engine. Returns false if the state has no pairs for this number of
    /// free vertices.
    pub(crate) fn restore(&mut self, gpu: &Gpu, state: &EngineState) -> Result<bool, GpuError> {
        let Some(op) = state.own.one::<SecantOp>(OP) else { return Ok(false) };
        let slots = [(op.newer, op.older), (op.older, op.newer)];
        let is_known = op.free == self.op.free
            && op.partials == self.op.partials
            && op.pairs <= 2
            && slots.contains(&(0, self.op.free));
        if !is_known {
            return Ok(false);
        }
        for ((name, count), buffer) in self.parts().into_iter().zip(&self.buffers) {
            let Some(values) = state.own.list_of::<[f32; 2]>(name, count) else { return Ok(false) };
            let write = || write_by_pieces(gpu, buffer, 0, bytemuck::cast_slice(&values));
            scoped(&gpu.device, write)?;
        }
        self.op = op;
        Ok(true)
    }

    /// Encodes a correction by the levels and the pairs. Closes the open pair, and opens the next one.
    pub(crate) fn encode_correction(
        &mut self,
        gpu: &Gpu,
        levels: &Levels,
        passes: &mut Passes<'_>,
    ) {
        for is_after in 0..2 {
            let op = SecantOp { is_after, ..self.op };
            let at = u64::from(is_after * self.stride);
            gpu.queue.write_buffer(&self.ops, at, bytemuck::bytes_of(&op));
        }
        levels.encode_gradient(passes);
        let groups = self.op.partials / WORKGROUP;
        let free = self.op.free;
        if self.op.pairs > 0 {
            self.run(passes, &self.close, 0, |pass| pass.dispatch_workgroups(groups, 1, 1));
            self.add_up(passes, 0);
            self.run(passes, &self.bend, 0, |pass| dispatch(pass, free));
        }
        levels.encode_cycle(passes);
        if self.op.pairs > 0 {
            self.run(passes, &self.multiply, 1, |pass| pass.dispatch_workgroups(groups, 1, 1));
            self.add_up(passes, 1);
        }
        self.run(passes, &self.open, 0, |pass| dispatch(pass, free));
        let SecantOp { newer, older, pairs, .. } = self.op;
        self.op = SecantOp { newer: older, older: newer, pairs: (pairs + 1).min(2), ..self.op };
    }

    /// Encodes the end of the sums of products.
    fn add_up(&self, passes: &mut Passes<'_>, op: u32) {
        if let Some(add_up) = &self.add_up {
            let spans = span_count(self.op.partials);
            self.run(passes, add_up, op, |pass| pass.dispatch_workgroups(spans, 1, 1));
        }
        self.run(passes, &self.sum, op, |pass| pass.dispatch_workgroups(1, 1, 1));
    }

    fn run(
        &self,
        passes: &mut Passes<'_>,
        pipeline: &Pipeline,
        op: u32,
        dispatch: impl FnOnce(&mut wgpu::ComputePass<'_>),
    ) {
        passes.run(pipeline, None, |pass| {
            pass.set_bind_group(0, &self.bind_group, &[op * self.stride]);
            dispatch(pass);
        });
    }
}

/// Creates the bind group of pairs. `buffers` are the steps, changes, low starts and sums.
fn bound(
    gpu: &Gpu,
    mesh: &MeshBuffers,
    params: &wgpu::Buffer,
    levels: &Levels,
    ops: &wgpu::Buffer,
    buffers: &[wgpu::Buffer; 4],
) -> wgpu::BindGroup {
    let [steps, changes, low_starts, sums] = buffers;
    let bindings = SecantsBindings {
        params: params.as_entire_binding(),
        op: uniform::<SecantOp>(ops),
        positions: mesh.bind_positions(),
        gradient: levels.gradient.as_entire_binding(),
        direction: levels.direction.as_entire_binding(),
        steps: steps.as_entire_binding(),
        changes: changes.as_entire_binding(),
        low_starts: low_starts.as_entire_binding(),
        sums: sums.as_entire_binding(),
    };
    gpu.pipelines.bind(&gpu.device, mesh.parts.form(), bindings)
}
