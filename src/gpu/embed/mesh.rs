//! A mesh that stays on an application's device.

use std::borrow::Cow;

use glam::DVec2;
use wgpu::BufferUsages as Usage;

use crate::error::GpuError;
use crate::error::{MeshError, SmoothError};
use crate::gpu::device::Gpu;
use crate::gpu::device::blocking::blocking;
use crate::gpu::device::buffers::filled;
use crate::gpu::device::readback::Waiting;
use crate::gpu::embed::clamped_move::Moves;
use crate::gpu::embed::objective::Run;
use crate::gpu::embed::pins::{Change, Pins};
use crate::gpu::embed::window::Window;
use crate::gpu::embed::{
    BoundMask, BoundMove, BoundObjective, BoundVertices, LastValid, VertexBuffer,
};
use crate::gpu::kernels::uniforms::join;
use crate::gpu::mesh::MeshBuffers;
use crate::gpu::scope::scoped;
use crate::layout::Problem;
use crate::layout::prepare;
use crate::mesh::{Mesh, MeshSize};
use crate::options::{Feature, Options};
use crate::run::Plan;
use crate::run::multilevel::NONE;
use crate::targets::Targets;

/// A mesh on the device. Its triangles stay the same; its vertices are moved by [`Sweeps`](crate::gpu::Sweeps), or by the
/// application through [`BoundVertices::encode_import`]. Several meshes can be on a device at once.
///
/// AREA, RMS and SHAPE-SIZE measure by the mean area of the triangles as they were uploaded. Where the application makes
/// the whole mesh larger or smaller, IMR, AR and EDGE suit better.
pub struct DeviceMesh {
    pub(crate) gpu: Gpu,
    pub(crate) problem: Problem,
    pub(crate) buffers: MeshBuffers,
    /// The application's number of each vertex.
    numbers: wgpu::Buffer,
    vertex_count: usize,
    /// The number on the device of each vertex of the application, or [`NONE`].
    places: Vec<u32>,
    pins: Pins,
    /// The vertices that no triangle uses: they are not on the device.
    unused: Vec<(u32, [f64; 2])>,
}

impl DeviceMesh {
    /// Prepares a mesh and uploads it. Blocks while it colors the vertices.
    ///
    /// The vertices of [`Mesh::fixed`] always stay, as those of the boundary do. [`pin`](Self::pin) holds others for a while.
    ///
    /// # Errors
    /// [`SmoothError::Mesh`] if the mesh cannot be smoothed, [`SmoothError::Gpu`] with
    /// [`GpuError::Limit`] if it is too large for the device.
    pub fn new(gpu: &Gpu, mesh: &Mesh) -> Result<Self, SmoothError> {
        Self::made(gpu, mesh, None)
    }

    /// Does what [`Self::new`] does, for a mesh whose elements are to look like `targets`, which has one for each vertex. Takes
    /// 16 bytes more on the device for each vertex. f, and the worst inverse mean ratio, are those of the triangles as
    /// targets show them.
    ///
    /// # Errors
    /// Those of [`Self::new`], and [`MeshError::ValueCount`] if there is not one target for each vertex.
    pub fn with_targets(gpu: &Gpu, mesh: &Mesh, targets: &Targets) -> Result<Self, SmoothError> {
        Self::made(gpu, mesh, Some(targets))
    }

    /// Does what [`Self::with_targets`] does, with the layout and the targets of a problem of the same mesh. Only a mesh with fixed vertices
    /// is laid out again.
    pub(crate) fn of(gpu: &Gpu, mesh: &Mesh, prepared: &Problem) -> Result<Self, SmoothError> {
        if mesh.fixed.is_empty() && prepared.free_count() > 0 {
            return Self::uploaded(gpu, mesh, prepared.clone());
        }
        let unconstrained = unconstrained(mesh);
        let (_, mut problem) = prepare(&unconstrained)?;
        if prepared.targets().is_some() {
            problem.take_targets(prepared, &places(mesh, prepared));
        }
        Self::uploaded(gpu, mesh, problem)
    }

    fn made(gpu: &Gpu, mesh: &Mesh, targets: Option<&Targets>) -> Result<Self, SmoothError> {
        let unconstrained = unconstrained(mesh);
        let (_, mut problem) = prepare(&unconstrained)?;
        if let Some(targets) = targets {
            targets.check_count(mesh.points.len())?;
            problem.set_targets(targets.maps());
        }
        Self::uploaded(gpu, mesh, problem)
    }

    fn uploaded(gpu: &Gpu, mesh: &Mesh, problem: Problem) -> Result<Self, SmoothError> {
        let buffers = MeshBuffers::new(gpu, &problem, problem.positions())?;
        let numbers = scoped(&gpu.device, || {
            filled(gpu, "vertex numbers", problem.vertices(), Usage::STORAGE)
        })?;
        let vertex_count = mesh.points.len();
        let places = places(mesh, &problem);
        let unused = (0..).zip(&mesh.points).filter(|&(v, _)| places[v as usize] == NONE);
        let unused = unused.map(|(v, &point)| (v, point)).collect();
        let free = problem.free_count() as u32;
        let mut fixed = Vec::new();
        for &vertex in &mesh.fixed {
            let (triangle, vertices) = (None, vertex_count);
            let place = places.get(vertex as usize).copied();
            let place = place.ok_or(MeshError::IndexOutOfRange { triangle, vertex, vertices })?;
            fixed.extend(Some(place).filter(|&place| place < free));
        }
        let pins = Pins::new(gpu, &problem, &buffers, &fixed)?;
        let gpu = gpu.clone();
        Ok(Self { gpu, problem, buffers, numbers, vertex_count, places, pins, unused })
    }

    /// Pins vertices (zero-based): sweeps leave them where they are, beside those of [`Mesh::fixed`] and of the boundary,
    /// which always stay. Takes effect in what is submitted after the call. Only what changes is sent to the device.
    ///
    /// # Errors
    /// [`MeshError::IndexOutOfRange`] for a vertex that the mesh does not have; nothing is pinned then.
    pub fn pin(&self, vertices: &[u32]) -> Result<(), SmoothError> {
        let places = self.free_places(vertices)?;
        self.change_pins(Change::Pin(&places))
    }

    /// Lets go of vertices that were pinned. Those of [`Mesh::fixed`] and of the boundary stay all the same. Takes effect in
    /// what is submitted after the call.
    ///
    /// # Errors
    /// [`MeshError::IndexOutOfRange`] for a vertex that the mesh does not have; nothing is let go then.
    pub fn unpin(&self, vertices: &[u32]) -> Result<(), SmoothError> {
        let places = self.free_places(vertices)?;
        self.change_pins(Change::Unpin(&places))
    }

    /// Pins these vertices and lets go of all others that were pinned. Takes effect in what is submitted after the call.
    ///
    /// # Errors
    /// [`MeshError::IndexOutOfRange`] for a vertex that the mesh does not have; nothing changes then.
    pub fn set_pinned(&self, vertices: &[u32]) -> Result<(), SmoothError> {
        let places = self.free_places(vertices)?;
        self.change_pins(Change::PinThese(&places))
    }

    fn change_pins(&self, change: Change<'_>) -> Result<(), SmoothError> {
        Ok(self.pins.change(&self.gpu, &self.problem, &self.buffers, change)?)
    }

    /// Binds a mask that holds vertices, in a buffer of the application: a u32 for each vertex of the mesh, from byte
    /// `offset` on, not 0 for a vertex that is to stay. Kernels of the application may write it.
    ///
    /// # Errors
    /// [`GpuError::Buffer`] if the buffer is too small, misaligned or was made without `STORAGE`, [`GpuError::Limit`] if the
    /// mask is larger than what the device binds at once.
    pub fn bind_mask(&self, buffer: &wgpu::Buffer, offset: u64) -> Result<BoundMask, GpuError> {
        let Self { gpu, problem, buffers, numbers, pins, vertex_count, .. } = self;
        let bytes = (*vertex_count as u64).saturating_mul(size_of::<u32>() as u64);
        let window = Window::new(gpu, buffer, offset, bytes)?;
        BoundMask::new(gpu, problem, buffers, numbers, pins, &window)
    }

    /// Keeps the positions of the mesh as long as it is valid, so that a frame in which the application has inverted
    /// triangles can be taken back. Takes 16 bytes on the device for each vertex.
    ///
    /// # Errors
    /// What the device refuses.
    pub fn keep_last_valid(&self) -> Result<LastValid, GpuError> {
        LastValid::new(&self.gpu, &self.problem, &self.buffers)
    }

    /// The numbers on the device of those of the vertices that could be moved by sweeps.
    fn free_places(&self, vertices: &[u32]) -> Result<Vec<u32>, MeshError> {
        let free = self.problem.free_count() as u32;
        let places: Result<Vec<u32>, _> = vertices.iter().map(|&v| self.place_of(v)).collect();
        Ok(places?.into_iter().filter(|&place| place < free).collect())
    }

    /// Number of vertices, those of no triangle too, and of triangles.
    pub fn size(&self) -> MeshSize {
        MeshSize { vertices: self.vertex_count, triangles: self.problem.triangles().len() }
    }

    /// Binds an application's vertex buffer to the mesh, so that encoding a frame makes no resources. Several buffers
    /// can be bound, for frames that overlap.
    ///
    /// # Errors
    /// [`GpuError::Buffer`] if the buffer is too small, misaligned or was made without `STORAGE`, or if rounding to single
    /// precision would invert triangles of the mesh as it was uploaded,
    /// [`GpuError::Limit`] if it is larger than what the device binds at once.
    pub fn bind_vertices(&self, vertices: &VertexBuffer<'_>) -> Result<BoundVertices, GpuError> {
        let Self { gpu, problem, buffers, numbers, vertex_count, .. } = self;
        BoundVertices::new(gpu, problem, *vertex_count, buffers, numbers, vertices)
    }

    /// Binds a place for the objectives of the vertices as they are drawn: of the floats in an application's vertex buffer, in its
    /// origin and scale, with all that their rounding does to triangles. [`BoundObjective::encode_objective`] is to be encoded
    /// behind the export, and writes [`ObjectiveValues`](crate::gpu::ObjectiveValues) to byte `values.1` of the buffer `values.0`, those
    /// that `options` track; of no sweeps, so that [`stop`](crate::gpu::ObjectiveValues::stop) is 0.
    ///
    /// Takes 16 bytes on the device for each vertex, 32 with targets. A vertex whose floats are not finite is judged as it was when they
    /// last were.
    ///
    /// # Errors
    /// [`SmoothError::Option`] for an option out of its range, and those of [`bind_vertices`](Self::bind_vertices) and
    /// [`Sweeps::bind_objective`](crate::gpu::Sweeps::bind_objective).
    pub fn bind_drawn_objective(
        &self,
        vertices: &VertexBuffer<'_>,
        options: &Options,
        values: (&wgpu::Buffer, u64),
    ) -> Result<BoundObjective, SmoothError> {
        let Self { gpu, problem, buffers, numbers, vertex_count, .. } = self;
        options.check_with(&self.features())?;
        // An import passes over a vertex whose floats are those that its position has in the buffer: no vertex is here.
        let nowhere = vec![DVec2::splat(1e30); problem.positions().len()];
        let drawn = buffers.with_positions(gpu, problem, &nowhere)?;
        let bound = BoundVertices::new(gpu, problem, *vertex_count, &drawn, numbers, vertices)?;
        let plan = Plan::new(options).endless();
        let run = Run::of_no_sweeps(gpu, problem, &drawn, plan)?;
        Ok(BoundObjective::new(gpu, &run, Some(bound), values.0, values.1)?)
    }

    /// Lists the features that sweeps have by this mesh.
    pub(super) fn features(&self) -> Vec<Feature> {
        Feature::present([(Feature::Targets, self.problem.targets().is_some())])
    }

    /// The vertices of a triangle, counter-clockwise, given its number on the device
    /// ([`ObjectiveValues::worst_triangle`](crate::gpu::ObjectiveValues::worst_triangle)). `None` if there is no such triangle.
    pub fn corners(&self, triangle: u32) -> Option<[u32; 3]> {
        let corners = self.problem.triangles().get(triangle as usize)?;
        Some(corners.map(|v| self.problem.vertices()[v as usize]))
    }

    /// Binds vertices that the application moves toward targets, as far as the triangles allow: for handles, holes and
    /// boundaries that a user drags. Target i, of `vertices[i]`, is vertex i of the buffer `targets`, in the coordinates
    /// that its origin and scale say. When the command buffer of a frame runs, the share of the ways that was gone is
    /// written to byte `share.1` of the buffer `share.0`, as an f32 from 0 to 1.
    ///
    /// To be called when a drag begins; as it goes on, the application writes the targets and encodes
    /// [`BoundMove::encode_move`]. Fixed vertices and those of the boundary can be moved too. Sweeps move a free
    /// vertex on from where it was dragged, unless it is [pinned](Self::pin). If a vertex is listed twice,
    /// its last target counts. A vertex of no triangle is not on the device, and no target moves it.
    ///
    /// No triangle gets an inverse mean ratio above `worst_imr`. One of about 8 leaves room for sweeps, and for the
    /// rounding of vertex buffers; above 100,000 it counts as 100,000, which single precision surely tells from flat.
    ///
    /// # Errors
    /// [`MeshError::IndexOutOfRange`] for a vertex that the mesh does not have, [`MeshError::BoundNotANumber`] if
    /// `worst_imr` is NaN, [`GpuError::Buffer`] if a buffer is too small, misaligned or was made without `STORAGE`, if both
    /// are the same, or if the origin or the scale is not usable; [`GpuError::Limit`] if the vertices have more triangles
    /// than the device binds at once, with 24 bytes for each.
    pub fn bind_move(
        &self,
        vertices: &[u32],
        targets: &VertexBuffer<'_>,
        worst_imr: f64,
        share: (&wgpu::Buffer, u64),
    ) -> Result<BoundMove, SmoothError> {
        if worst_imr.is_nan() {
            return Err(MeshError::BoundNotANumber.into());
        }
        let mut ways = Vec::with_capacity(vertices.len());
        for (target, &vertex) in (0..).zip(vertices) {
            match self.place_of(vertex)? {
                NONE => {}
                place => ways.push([place, target]),
            }
        }
        let Self { gpu, problem, buffers, .. } = self;
        let moves = Moves { ways, listed: vertices.len(), worst_imr };
        Ok(BoundMove::new(gpu, problem, buffers, moves, targets, share.0, share.1)?)
    }

    /// The number on the device of a vertex of the application, or [`NONE`].
    fn place_of(&self, vertex: u32) -> Result<u32, MeshError> {
        let vertices = self.vertex_count;
        let place = self.places.get(vertex as usize).copied();
        place.ok_or(MeshError::IndexOutOfRange { triangle: None, vertex, vertices })
    }

    /// Reads the positions back, in the order and unit of the mesh; blocks until the device has done all that was
    /// submitted. A vertex of no triangle is where the mesh had it.
    ///
    /// # Errors
    /// [`GpuError::Lost`] if the device is lost.
    pub fn read_points(&self) -> Result<Vec<[f64; 2]>, GpuError> {
        blocking(self.wait_for_points(Waiting::Block))
    }

    /// As [`read_points`](Self::read_points), without blocking: completes once the application has polled the device.
    /// The copy is submitted when the future is first polled.
    ///
    /// # Errors
    /// [`GpuError::Lost`] if the device is lost.
    pub async fn read_points_async(&self) -> Result<Vec<[f64; 2]>, GpuError> {
        self.wait_for_points(Waiting::Await).await
    }

    async fn wait_for_points(&self, waiting: Waiting) -> Result<Vec<[f64; 2]>, GpuError> {
        let Self { gpu, problem, buffers, unused, .. } = self;
        let count = problem.positions().len();
        let positions = buffers.read_positions(gpu, count, waiting).await?;
        let positions: Vec<_> = positions.into_iter().map(join).collect();
        let mut points = vec![[0.0; 2]; self.vertex_count];
        for (v, point) in problem.denormalized(&positions).chain(unused.iter().copied()) {
            points[v as usize] = point;
        }
        Ok(points)
    }
}

/// Returns the mesh without fixed vertices: on a device they are laid out as free ones, and held by pins.
fn unconstrained(mesh: &Mesh) -> Cow<'_, Mesh> {
    match mesh.fixed.is_empty() {
        true => Cow::Borrowed(mesh),
        false => Cow::Owned(Mesh {
            points: mesh.points.clone(),
            triangles: mesh.triangles.clone(),
            fixed: Vec::new(),
        }),
    }
}

/// Returns the number in the problem of each vertex of the mesh; [`NONE`] for one that no triangle uses.
fn places(mesh: &Mesh, problem: &Problem) -> Vec<u32> {
    let mut places = vec![NONE; mesh.points.len()];
    for (place, &v) in (0..).zip(problem.vertices()) {
        places[v as usize] = place;
    }
    places
}
