//! A mesh that stays on an application's device.

use std::borrow::Cow;
use std::sync::Arc;

use glam::DVec2;
use wgpu::BufferUsages as Usage;

use crate::error::GpuError;
use crate::error::{MeshError, SmoothError};
use crate::gpu::device::Gpu;
use crate::gpu::device::buffers::filled;
use crate::gpu::device::pending::{Pending, Waiting};
use crate::gpu::embed::clamped_move::Moves;
use crate::gpu::embed::objective::Run;
use crate::gpu::embed::pins::{Change, Pins, SlidingPins};
use crate::gpu::embed::window::Window;
use crate::gpu::embed::{
    BoundMask, BoundMove, BoundObjective, BoundVertices, LastValid, VertexBuffer,
};
use crate::gpu::kernels::uniforms::join;
use crate::gpu::mesh::{Curves, MeshBuffers};
use crate::gpu::scope::scoped;
use crate::layout::Problem;
use crate::layout::{prepare, prepare_like, prepare_to_untangle};
use crate::mesh::{Mesh, MeshSize};
use crate::options::{Feature, Options};
use crate::parallel::pace::now;
use crate::run::Plan;
use crate::run::multilevel::NONE;
use crate::slide::{OnCurves, Sliding};
use crate::targets::Targets;

/// A mesh on an application's device. The elements never change. [`Sweeps`](crate::gpu::Sweeps) move the vertices, and
/// so does the application through [`BoundVertices::encode_import`] and [`BoundMove::encode_move`]. A device may hold
/// several meshes.
///
/// Positions are stored with 48 bits per coordinate. Except in a browser, any thread may call the methods, and objects
/// that are bound to the mesh may outlive the `DeviceMesh`.
///
/// Metrics of size compare triangles with their mean area at upload. If the application scales the whole mesh, take a
/// metric that is independent of size ([`Metric::is_scale_invariant`](crate::Metric::is_scale_invariant)), such as the
/// default.
pub struct DeviceMesh {
    pub(crate) gpu: Gpu,
    pub(crate) problem: Problem,
    pub(crate) buffers: MeshBuffers,
    /// Map from device numbers to the application's vertex indices.
    numbers: wgpu::Buffer,
    vertex_count: usize,
    /// Map from the application's vertex indices to device numbers; [`NONE`] for a vertex of no triangle.
    places: Vec<u32>,
    pins: Pins,
    sliding_pins: SlidingPins,
    /// Vertices that no triangle uses, with their points. The device does not store these vertices.
    unused: Vec<(u32, [f64; 2])>,
}

impl DeviceMesh {
    /// Prepares a mesh and uploads it. Blocks the thread for about half a microsecond per vertex (on two cores), mostly
    /// to color the vertices on the CPU.
    ///
    /// Sweeps never move the vertices of [`Mesh::fixed`] and of the boundary. [`pin`](Self::pin) holds further vertices
    /// for a while. Boundary layers are not looked for: of a mesh with layers,
    /// [`Smoother::to_device`](crate::Smoother::to_device) makes a mesh that holds them.
    ///
    /// # Errors
    /// [`SmoothError::Mesh`] if the mesh cannot be smoothed. [`SmoothError::Gpu`] with [`GpuError::Limit`] or
    /// [`GpuError::TooLarge`] if the mesh is too large for the device, or with another [`GpuError`] if the device
    /// fails.
    pub fn new(gpu: &Gpu, mesh: &Mesh) -> Result<Self, SmoothError> {
        Self::made(gpu, mesh, None)
    }

    /// Prepares and uploads a mesh like [`new`](Self::new), but accepts inverted and flat triangles, for
    /// [`UntanglingSweeps`](crate::gpu::UntanglingSweeps). Lengths are scaled by the area within the boundary. If the
    /// mesh stays tangled, [`LastValid`] returns it to the tangled state of the upload.
    ///
    /// # Errors
    /// The errors of [`new`](Self::new), except for inverted, flat and overlapping triangles.
    pub fn tangled(gpu: &Gpu, mesh: &Mesh) -> Result<Self, SmoothError> {
        let unconstrained = unconstrained(mesh);
        let (_, problem) = prepare_to_untangle(&unconstrained)?;
        Self::uploaded(gpu, mesh, problem)
    }

    /// Prepares and uploads a mesh like [`new`](Self::new), with a target shape and size for each vertex. Targets take
    /// 16 more bytes on the device per vertex. f and the worst inverse mean ratio are measured on triangles transformed
    /// by their target maps.
    ///
    /// # Errors
    /// The errors of [`new`](Self::new), and [`MeshError::ValueCount`] if the numbers of targets and vertices differ.
    pub fn with_targets(gpu: &Gpu, mesh: &Mesh, targets: &Targets) -> Result<Self, SmoothError> {
        Self::made(gpu, mesh, Some(targets))
    }

    /// Uploads a mesh with the layout, the projection and the targets of `prepared`, a problem of the same mesh. Only
    /// meshes with fixed vertices or without free vertices are laid out again. The vertices of `sliding` slide, which are
    /// numbered as in the mesh.
    pub(crate) fn of(
        gpu: &Gpu,
        mesh: &Mesh,
        prepared: &Problem,
        sliding: Option<Sliding>,
    ) -> Result<Self, SmoothError> {
        let mut uploaded = match mesh.fixed.is_empty() && prepared.free_count() > 0 {
            true => Self::uploaded(gpu, mesh, prepared.clone())?,
            false => {
                let mut problem = prepare_like(&unconstrained(mesh), prepared)?;
                if prepared.targets().is_some() {
                    problem.take_targets(prepared, &places(mesh, prepared));
                }
                Self::uploaded(gpu, mesh, problem)?
            }
        };
        let Some(sliding) = sliding else { return Ok(uploaded) };
        let sliding = sliding.numbered(&uploaded.problem, mesh.points.len());
        let on_curves = OnCurves::new(Arc::new(sliding), None, 0.0);
        uploaded.buffers.curves = Some(Curves::of_application(gpu, &uploaded.problem, &on_curves)?);
        Ok(uploaded)
    }

    fn made(gpu: &Gpu, mesh: &Mesh, targets: Option<&Targets>) -> Result<Self, SmoothError> {
        let unconstrained = unconstrained(mesh);
        let (_, mut problem) = prepare(&unconstrained)?;
        if let Some(targets) = targets {
            targets.check_count(mesh.points.len())?;
            problem.set_targets(targets);
        }
        Self::uploaded(gpu, mesh, problem)
    }

    fn uploaded(gpu: &Gpu, mesh: &Mesh, problem: Problem) -> Result<Self, SmoothError> {
        let buffers = now(MeshBuffers::new(gpu, &problem, problem.positions()))?;
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
            let (element, vertices) = (None, vertex_count);
            let place = places.get(vertex as usize).copied();
            let place = place.ok_or(MeshError::IndexOutOfRange { element, vertex, vertices })?;
            fixed.extend(Some(place).filter(|&place| place < free));
        }
        let pins = Pins::new(gpu, &problem, &buffers, &fixed)?;
        let (gpu, sliding_pins) = (gpu.clone(), SlidingPins::default());
        Ok(Self {
            gpu,
            problem,
            buffers,
            numbers,
            vertex_count,
            places,
            pins,
            sliding_pins,
            unused,
        })
    }

    /// Pins vertices, given by zero-based index: sweeps leave pinned vertices in place, like the vertices of
    /// [`Mesh::fixed`] and of the boundary. Pins hold in submissions after the call. Only changed vertices are sent to
    /// the device.
    ///
    /// # Errors
    /// [`MeshError::IndexOutOfRange`] if the mesh lacks a listed vertex; then nothing is pinned. [`SmoothError::Gpu`]
    /// if the device fails.
    pub fn pin(&self, vertices: &[u32]) -> Result<(), SmoothError> {
        self.change_pins(Change::Pin(&self.all_places(vertices)?))
    }

    /// Unpins vertices in submissions after the call. Vertices of [`Mesh::fixed`] and of the boundary stay fixed. If a
    /// mask holds an unpinned vertex, encode [`BoundMask::encode_mask`] again.
    ///
    /// # Errors
    /// [`MeshError::IndexOutOfRange`] if the mesh lacks a listed vertex; then nothing is unpinned. [`SmoothError::Gpu`]
    /// if the device fails.
    pub fn unpin(&self, vertices: &[u32]) -> Result<(), SmoothError> {
        self.change_pins(Change::Unpin(&self.all_places(vertices)?))
    }

    /// Pins exactly the given vertices and unpins all others, in later submissions.
    ///
    /// # Errors
    /// [`MeshError::IndexOutOfRange`] if the mesh lacks a listed vertex; then no pin changes. [`SmoothError::Gpu`] if
    /// the device fails.
    pub fn set_pinned(&self, vertices: &[u32]) -> Result<(), SmoothError> {
        self.change_pins(Change::PinThese(&self.all_places(vertices)?))
    }

    fn change_pins(&self, change: Change<'_>) -> Result<(), SmoothError> {
        let Self { gpu, problem, buffers, pins, sliding_pins, .. } = self;
        if let Some(curves) = &buffers.curves {
            sliding_pins.change(gpu, curves, &buffers.changes, &change)?;
        }
        Ok(pins.change(gpu, problem, buffers, &change)?)
    }

    /// Binds a mask in a buffer of the application: one u32 per vertex of the mesh from the start of the slice on, nonzero
    /// for a vertex that must stay in place. The slice starts at a multiple of 4 bytes. Kernels of the application may
    /// write the mask, and [`BoundMask::encode_mask`] applies it.
    ///
    /// # Errors
    /// [`GpuError::Buffer`] if the slice is too small or misaligned, or if its buffer was created without `STORAGE` or
    /// belongs to another device. [`GpuError::Limit`] if the mask exceeds the device's `max_storage_buffer_binding_size`.
    pub fn bind_mask(&self, mask: wgpu::BufferSlice<'_>) -> Result<BoundMask, GpuError> {
        let Self { gpu, problem, buffers, numbers, pins, vertex_count, .. } = self;
        let bytes = (*vertex_count as u64).saturating_mul(size_of::<u32>() as u64);
        let window = Window::new(gpu, mask, bytes)?;
        BoundMask::new(gpu, problem, buffers, numbers, pins, &window)
    }

    /// Creates a store for the last valid positions, to undo frames in which the application has inverted triangles.
    /// Takes 16 bytes on the device per vertex.
    ///
    /// # Errors
    /// [`GpuError::OutOfMemory`], or another [`GpuError`] if the device fails.
    pub fn keep_last_valid(&self) -> Result<LastValid, GpuError> {
        LastValid::new(&self.gpu, &self.problem, &self.buffers)
    }

    /// Returns the device numbers of the given vertices.
    fn all_places(&self, vertices: &[u32]) -> Result<Vec<u32>, MeshError> {
        vertices.iter().map(|&v| self.place_of(v)).collect()
    }

    /// Returns the numbers of vertices, including vertices of no element, and of triangles, with four triangles for each
    /// quadrilateral.
    pub fn size(&self) -> MeshSize {
        MeshSize { vertices: self.vertex_count, triangles: self.problem.corners().all().len() }
    }

    /// Binds an application's vertex buffer to the mesh, so that encoding a frame creates no resources. Several buffers
    /// can be bound, for frames that overlap.
    ///
    /// # Errors
    /// [`GpuError::Buffer`] if the buffer is too small, was created without `STORAGE`, or belongs to another device; if
    /// start, stride, origin or scale are out of range; if the mesh is on the sphere and the buffer is not declared
    /// [`in_mercator_projection`](VertexBuffer::in_mercator_projection), or the reverse; or if rounding to single
    /// precision would invert triangles of the uploaded mesh (the message names a remedy). [`GpuError::Limit`] if the vertices exceed the device's
    /// `max_storage_buffer_binding_size`.
    pub fn bind_vertices(&self, vertices: &VertexBuffer<'_>) -> Result<BoundVertices, GpuError> {
        let Self { gpu, problem, buffers, numbers, vertex_count, .. } = self;
        BoundVertices::new(gpu, problem, *vertex_count, buffers, numbers, vertices)
    }

    /// Binds the objectives of the vertices as drawn: of the floats in an application's vertex buffer, whose rounding
    /// may distort or invert triangles. Encode [`BoundObjective::encode_objective`] after the export. The objectives
    /// that `options` track are written as [`ObjectiveValues`](crate::gpu::ObjectiveValues) to the start of the slice
    /// `values`. No sweeps belong to these values, so [`stop`](crate::gpu::ObjectiveValues::stop) is 0.
    ///
    /// Takes 16 more bytes on the device per vertex, 32 with targets. If a vertex has floats that are not finite, its
    /// last finite floats are evaluated.
    ///
    /// # Errors
    /// [`SmoothError::Option`] if an option is out of its range, and the errors of
    /// [`bind_vertices`](Self::bind_vertices) and [`Sweeps::bind_objective`](crate::gpu::Sweeps::bind_objective).
    pub fn bind_drawn_objective(
        &self,
        vertices: &VertexBuffer<'_>,
        options: &Options,
        values: wgpu::BufferSlice<'_>,
    ) -> Result<BoundObjective, SmoothError> {
        let Self { gpu, problem, buffers, numbers, vertex_count, .. } = self;
        options.check_with(&self.features())?;
        // An import skips a vertex whose floats equal its exported position. No vertex is drawn at this point, so the
        // first import skips none.
        let nowhere = vec![DVec2::splat(1e30); problem.positions().len()];
        let drawn = buffers.with_positions(gpu, problem, &nowhere)?;
        let bound = BoundVertices::new(gpu, problem, *vertex_count, &drawn, numbers, vertices)?;
        let plan = Plan::new(options).endless();
        let run = Run::of_no_sweeps(gpu, problem, &drawn, plan)?;
        Ok(BoundObjective::new(gpu, &run, Some(bound), values)?)
    }

    /// Lists the features that the mesh adds to sweeps: targets, if present.
    pub(super) fn features(&self) -> Vec<Feature> {
        Feature::present([(Feature::Targets, self.problem.targets().is_some())])
    }

    /// Returns the application's vertex indices of a triangle or a quadrilateral, counter-clockwise, given the element's device
    /// number ([`ObjectiveValues::worst_element`](crate::gpu::ObjectiveValues::worst_element)). `None` for a number out of
    /// range.
    pub fn vertices_of(&self, element: u32) -> Option<Vec<u32>> {
        let corners = self.problem.corners();
        let element = element as usize;
        let vertices = match corners.triangles().get(element) {
            Some(triangle) => triangle.to_vec(),
            None if element < corners.element_count() => {
                corners.quadrilateral(element - corners.triangles().len()).to_vec()
            }
            None => return None,
        };
        Some(vertices.into_iter().map(|v| self.problem.vertices()[v as usize]).collect())
    }

    /// Binds vertices that the application moves toward targets, as far as the triangles allow: for handles, holes and
    /// boundaries that a user drags. The target of `vertices[i]` is vertex i of the buffer `targets`, in the
    /// coordinates of its origin and scale. When a frame's command buffer runs, the share of the ways that the vertices
    /// have gone is written to the start of the slice `share`, as an f32 from 0 to 1.
    ///
    /// Call this method when a drag begins. During the drag, the application writes targets and encodes
    /// [`BoundMove::encode_move`] in each frame. Fixed vertices and vertices of the boundary can be moved too. Unless a
    /// free vertex is [pinned](Self::pin), sweeps move it away from its target. If a vertex is listed twice, the last
    /// target counts. Vertices without triangles stay, as the device does not store them.
    ///
    /// No triangle gets an inverse mean ratio above `worst_imr`. A bound of about 8 leaves room for sweeps and for the
    /// rounding of vertex buffers. Bounds above 100,000 count as 100,000, up to which single precision reliably
    /// distinguishes a triangle from a flat one.
    ///
    /// # Errors
    /// [`MeshError::IndexOutOfRange`] if the mesh lacks a listed vertex. [`MeshError::BoundNotANumber`] if `worst_imr`
    /// is NaN. [`GpuError::Buffer`] if a buffer is too small, misaligned, was created without `STORAGE`, or belongs to
    /// another device; if targets and share use one buffer; if the origin or the scale is invalid; or if the mesh is on
    /// the sphere and the targets are not declared [`in_mercator_projection`](VertexBuffer::in_mercator_projection), or
    /// the reverse.
    /// [`GpuError::Limit`] if the triangles around the vertices, at 24 bytes each, exceed the device's
    /// `max_storage_buffer_binding_size`.
    pub fn bind_move(
        &self,
        vertices: &[u32],
        targets: &VertexBuffer<'_>,
        worst_imr: f64,
        share: wgpu::BufferSlice<'_>,
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
        Ok(BoundMove::new(gpu, problem, buffers, moves, targets, share)?)
    }

    /// Returns the device number of a vertex of the application; [`NONE`] for a vertex of no triangle.
    fn place_of(&self, vertex: u32) -> Result<u32, MeshError> {
        let vertices = self.vertex_count;
        let place = self.places.get(vertex as usize).copied();
        place.ok_or(MeshError::IndexOutOfRange { element: None, vertex, vertices })
    }

    /// Returns the positions in the order and unit of the mesh, once the device has finished all work submitted before. A
    /// vertex of no triangle has its position at upload. If the call is awaited, the copy is submitted when the future is
    /// first polled.
    ///
    /// # Errors
    /// [`GpuError::Lost`] if the device is lost.
    pub fn read_points(&self) -> Pending<'_, Vec<[f64; 2]>> {
        Pending::new(|waiting| Box::pin(self.wait_for_points(waiting)))
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

/// Returns the mesh without fixed vertices, which a device lays out as free vertices and holds by pins.
fn unconstrained(mesh: &Mesh) -> Cow<'_, Mesh> {
    match mesh.fixed.is_empty() {
        true => Cow::Borrowed(mesh),
        false => Cow::Owned(Mesh {
            points: mesh.points.clone(),
            triangles: mesh.triangles.clone(),
            quadrilaterals: mesh.quadrilaterals.clone(),
            ..Mesh::default()
        }),
    }
}

/// Returns the number of each mesh vertex in the problem; [`NONE`] for a vertex of no triangle.
fn places(mesh: &Mesh, problem: &Problem) -> Vec<u32> {
    let mut places = vec![NONE; mesh.points.len()];
    for (place, &v) in (0..).zip(problem.vertices()) {
        places[v as usize] = place;
    }
    places
}
