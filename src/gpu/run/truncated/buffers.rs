//! The buffers of Newton steps, and their bind groups.

use crate::gpu::device::Gpu;
use crate::gpu::device::buffers::{bytes, uniform};
use crate::gpu::kernels::form::MeshForm;
use crate::gpu::kernels::layouts::{
    Bindings, CoarseBindings, FineBindings, HessianBindings, LatticeBindings, SlideHessianBindings,
    SlideSolutionBindings, SolutionBindings, TrialsBindings,
};
use crate::gpu::kernels::uniforms::{CoarseOp, FineOp, LatticeOp, StepOp};
use crate::gpu::mesh::MeshBuffers;

/// Bytes of a pair of floats.
pub(super) const PAIR: u64 = size_of::<[f32; 2]>() as u64;

/// The bind groups of the dispatches, one of each layout.
#[derive(Clone, Copy)]
pub(super) enum Bound {
    Hessian,
    Solution,
    Lattice,
    Trials,
    Fine,
    Coarse,
    SlideHessian,
    SlideSolution,
    /// [`Self::Fine`] with the quadrilaterals of a mesh that has triangles too.
    FineOfQuadrilaterals,
}

/// The buffers of Newton steps.
pub(super) struct Buffers {
    pub(super) params: wgpu::Buffer,
    pub(super) ops: wgpu::Buffer,
    pub(super) structure: wgpu::Buffer,
    pub(super) entries: wgpu::Buffer,
    pub(super) fine: wgpu::Buffer,
    pub(super) rows: wgpu::Buffer,
    /// The totals of a trial, the state of the search, and the partial sums.
    pub(super) vectors: wgpu::Buffer,
    pub(super) state: wgpu::Buffer,
    pub(super) lines: wgpu::Buffer,
    /// Stands for values that no kernel reads.
    pub(super) nothing: wgpu::Buffer,
}

impl Buffers {
    /// Returns the bind groups in the order of [`Bound`]. To be called in an error scope.
    pub(super) fn bind_groups(
        &self,
        gpu: &Gpu,
        form: MeshForm,
        mesh: &MeshBuffers,
        step: &StepOp,
    ) -> Vec<wgpu::BindGroup> {
        let trials = TrialsBindings {
            params: self.params.as_entire_binding(),
            vectors: self.vectors.as_entire_binding(),
            state: self.state.as_entire_binding(),
        };
        let coarse = CoarseBindings {
            params: self.params.as_entire_binding(),
            op: uniform::<CoarseOp>(&self.ops),
            structure: self.structure.as_entire_binding(),
            values: self.nothing.as_entire_binding(),
            vectors: self.vectors.as_entire_binding(),
        };
        vec![
            bind(gpu, form, self.hessian(mesh)),
            bind(gpu, form, self.solution(mesh)),
            bind(gpu, form, self.lattice()),
            bind(gpu, form, trials),
            bind(gpu, form, self.along_solution(mesh, step, 0)),
            bind(gpu, form, coarse),
            bind(gpu, form, self.slide_hessian(mesh)),
            bind(gpu, form, self.slide_solution()),
            bind(gpu, form, self.along_solution(mesh, step, 1)),
        ]
    }

    fn hessian<'b>(&'b self, mesh: &'b MeshBuffers) -> HessianBindings<'b> {
        HessianBindings {
            params: self.params.as_entire_binding(),
            op: uniform::<StepOp>(&self.ops),
            positions: mesh.bind_positions(),
            ring_start: mesh.ring_start.as_entire_binding(),
            ring: mesh.bind_ring(0),
            structure: self.structure.as_entire_binding(),
            entries: self.entries.as_entire_binding(),
            fine: self.fine.as_entire_binding(),
            rows: self.rows.as_entire_binding(),
        }
    }

    fn solution<'b>(&'b self, mesh: &'b MeshBuffers) -> SolutionBindings<'b> {
        SolutionBindings {
            params: self.params.as_entire_binding(),
            op: uniform::<StepOp>(&self.ops),
            ring_start: mesh.ring_start.as_entire_binding(),
            ring: mesh.bind_ring(0),
            structure: self.structure.as_entire_binding(),
            entries: self.entries.as_entire_binding(),
            fine: self.fine.as_entire_binding(),
            rows: self.rows.as_entire_binding(),
            state: self.state.as_entire_binding(),
        }
    }

    fn lattice(&self) -> LatticeBindings<'_> {
        LatticeBindings {
            params: self.params.as_entire_binding(),
            op: uniform::<LatticeOp>(&self.ops),
            structure: self.structure.as_entire_binding(),
            rows: self.rows.as_entire_binding(),
            state: self.state.as_entire_binding(),
        }
    }

    fn slide_hessian<'b>(&'b self, mesh: &'b MeshBuffers) -> SlideHessianBindings<'b> {
        SlideHessianBindings {
            params: self.params.as_entire_binding(),
            op: uniform::<StepOp>(&self.ops),
            positions: mesh.bind_positions(),
            structure: self.structure.as_entire_binding(),
            entries: self.entries.as_entire_binding(),
            fine: self.fine.as_entire_binding(),
            lines: self.lines.as_entire_binding(),
        }
    }

    fn slide_solution(&self) -> SlideSolutionBindings<'_> {
        SlideSolutionBindings {
            params: self.params.as_entire_binding(),
            op: uniform::<StepOp>(&self.ops),
            structure: self.structure.as_entire_binding(),
            entries: self.entries.as_entire_binding(),
            fine: self.fine.as_entire_binding(),
            rows: self.rows.as_entire_binding(),
            lines: self.lines.as_entire_binding(),
            state: self.state.as_entire_binding(),
        }
    }

    /// Returns the bindings of the kernels that also serve corrections, for a part of the elements. Here the solution stands for
    /// the correction.
    fn along_solution<'b>(
        &'b self,
        mesh: &'b MeshBuffers,
        step: &StepOp,
        part: usize,
    ) -> FineBindings<'b> {
        let (vector, length) = (u64::from(step.vector) * PAIR, u64::from(step.movers) * PAIR);
        FineBindings {
            params: self.params.as_entire_binding(),
            op: uniform::<FineOp>(&self.ops),
            positions: mesh.bind_positions(),
            ring_start: mesh.ring_start.as_entire_binding(),
            ring: mesh.bind_ring(0),
            triangles: mesh.bind_elements(part),
            gradient: bytes(&self.fine, 0..length),
            direction: bytes(&self.fine, vector..vector + length),
            vectors: self.vectors.as_entire_binding(),
        }
    }
}

/// Binds resources for a mesh of the given form.
fn bind<'b>(gpu: &Gpu, form: MeshForm, bindings: impl Bindings<'b>) -> wgpu::BindGroup {
    gpu.pipelines.bind(&gpu.device, form, bindings)
}
