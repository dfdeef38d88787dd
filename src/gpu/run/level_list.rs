//! The list of the dispatches of a correction from coarser levels.

use crate::error::GpuError;
use crate::gpu::kernels::table::Kernel;
use crate::gpu::kernels::uniforms::{FineOp, TransferOp, WORKGROUP};
use crate::gpu::mesh::{ElementPart, MeshBuffers, RingPart};
use crate::gpu::run::listing::{Bound, Dispatch, Groups, Listing, Op, SUMS, along_sums};
use crate::metric::Metric;
use crate::run::multilevel::{Hierarchy, NONE};

/// The listing of a hierarchy, with the operations on the free vertices.
pub(super) struct LevelList<'g> {
    pub(super) listing: Listing<'g>,
    mesh: &'g MeshBuffers,
    hierarchy: &'g Hierarchy,
    /// The operation on all free vertices.
    pub(super) fine: FineOp,
    transfer: TransferOp,
    /// Pages of the aggregates of the vertices, of the members of the aggregates, and of the values at the vertices.
    pages: [usize; 3],
}

impl<'g> LevelList<'g> {
    /// Places the first level of a hierarchy. `is_fitted_each_time` tells whether each correction fits the levels by a factor at
    /// each free vertex.
    pub(super) fn new(
        mut listing: Listing<'g>,
        mesh: &'g MeshBuffers,
        hierarchy: &'g Hierarchy,
        is_fitted_each_time: bool,
        free: u32,
        partials: u32,
    ) -> Result<Self, GpuError> {
        let partial_sums = listing.vector(along_sums(partials) as usize);
        let (values, [roots, diagonal]) =
            listing.values.place([hierarchy.roots(), hierarchy.inverse_diagonal()])?;
        let (of_page, [aggregate_of]) = listing.structure.place([hierarchy.aggregate_of()])?;
        let (members_page, [member_starts, members]) =
            listing.structure.place([hierarchy.member_starts(), hierarchy.members()])?;
        let aggregates = hierarchy.member_starts().len() - 1;
        let right = listing.vector(aggregates);
        let present_roots = match is_fitted_each_time {
            true => listing.vector(free as usize),
            false => NONE,
        };
        let fine = FineOp {
            rows: free,
            first: 0,
            free,
            ring_base: 0,
            present_roots,
            unbroken: SUMS,
            partial_sums,
            length: 0.0,
            shape_guard: 0.0,
            sharpness: 0,
            inverse_penalty_guard: 0.0,
            padding: 0,
        };
        let transfer = TransferOp {
            rows: free,
            first: 0,
            free,
            ring_base: 0,
            aggregate_of,
            member_starts,
            members,
            roots,
            diagonal,
            present_roots,
            right,
            solution: NONE,
        };
        let pages = [of_page, members_page, values];
        Ok(Self { listing, mesh, hierarchy, fine, transfer, pages })
    }

    /// Lists the dispatches that compute the gradient from the positions.
    pub(super) fn gradient(&mut self, metric: Metric) -> Result<Vec<Dispatch>, GpuError> {
        self.fine_by_rings(&Kernel::Gradient(metric))
    }

    /// Lists the dispatches that compute the correction from the gradient.
    pub(super) fn correction(&mut self) -> Result<Vec<Dispatch>, GpuError> {
        let mut list = self.transfer_by_rings(&Kernel::SmoothGradient, self.transfer)?;
        let [_, members_page, values] = self.pages;
        let rows = self.hierarchy.member_starts().len() as u32 - 1;
        let op = Op::Transfer(TransferOp { rows, ..self.transfer });
        let bound = Bound::Transfer { part: 0, structure: members_page, values };
        list.push(self.listing.step(Kernel::Restrict, bound, Groups::ForRows, op)?);
        let levels = self.hierarchy.levels();
        let solution = self.listing.solve(levels, self.transfer.right, &mut list)?;
        let op = TransferOp { solution, ..self.transfer };
        list.extend(self.transfer_by_rings(&Kernel::Prolong, op)?);
        Ok(list)
    }

    /// Lists the dispatches that exclude vertices of broken triangles from the correction, once.
    pub(super) fn left_out(&mut self) -> Result<Vec<Dispatch>, GpuError> {
        // Between V-cycles, `vectors` from SUMS on holds nothing that is still needed.
        self.listing.vectors = self.listing.vectors.max(SUMS + self.fine.free);
        let mut list = self.fine_by_rings(&Kernel::FindBroken)?;
        let (whole, op) = (Bound::Fine { part: 0 }, Op::Fine(self.fine));
        list.push(self.listing.step(Kernel::ExcludeBroken, whole, Groups::ForRows, op)?);
        Ok(list)
    }

    /// Lists the evaluation of the objective along the correction, part by part of the elements, by `partials` invocations.
    pub(super) fn objective(
        &mut self,
        metric: Metric,
        partials: u32,
    ) -> Result<Vec<Dispatch>, GpuError> {
        let parts = self.mesh.parts.elements.iter().enumerate();
        let step = |(part, elements): (usize, &ElementPart)| {
            let (rows, first) = (elements.count(), elements.first);
            let (kernel, groups) =
                (Kernel::ObjectiveAlongCorrection(metric), Groups::Just(partials / WORKGROUP));
            let op = Op::Fine(FineOp { rows, first, ..self.fine });
            self.listing.step_on(elements, kernel, Bound::Fine { part }, groups, op)
        };
        parts.map(step).collect()
    }

    /// Lists an operation on the free vertices, with one dispatch for each part of the one-rings.
    fn fine_by_rings(&mut self, kernel: &Kernel) -> Result<Vec<Dispatch>, GpuError> {
        let parts = self.mesh.parts.rings.iter().enumerate();
        let step = |(part, ring): (usize, &RingPart)| {
            let RingPart { vertices, entries } = ring;
            let (rows, first) = (vertices.end - vertices.start, vertices.start);
            let op = Op::Fine(FineOp { rows, first, ring_base: entries.start, ..self.fine });
            self.listing.step(kernel.clone(), Bound::Fine { part }, Groups::ForRows, op)
        };
        parts.map(step).collect()
    }

    /// Lists a transfer between the free vertices and the first level. Each part of the one-rings has a dispatch.
    fn transfer_by_rings(
        &mut self,
        kernel: &Kernel,
        op: TransferOp,
    ) -> Result<Vec<Dispatch>, GpuError> {
        let [structure, _, values] = self.pages;
        let parts = self.mesh.parts.rings.iter().enumerate();
        let step = |(part, ring): (usize, &RingPart)| {
            let RingPart { vertices, entries } = ring;
            let (rows, first) = (vertices.end - vertices.start, vertices.start);
            let op = Op::Transfer(TransferOp { rows, first, ring_base: entries.start, ..op });
            let bound = Bound::Transfer { part, structure, values };
            self.listing.step(kernel.clone(), bound, Groups::ForRows, op)
        };
        parts.map(step).collect()
    }
}
