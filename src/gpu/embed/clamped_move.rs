//! Moves vertices of an application as far as the triangles allow.

use wgpu::BufferUsages as Usage;

use crate::error::GpuError;
use crate::gpu::device::Gpu;
use crate::gpu::device::buffers::filled;
use crate::gpu::device::size::{check_limit, moved_triangle_bytes};
use crate::gpu::embed::vertex_buffer::{Coordinates, VertexBuffer};
use crate::gpu::embed::window::Window;
use crate::gpu::encode::Encoder;
use crate::gpu::kernels::dispatch::dispatch;
use crate::gpu::kernels::layouts::MoveBindings;
use crate::gpu::kernels::pipelines::Pipeline;
use crate::gpu::kernels::table::Kernel;
use crate::gpu::kernels::uniforms::{Movement, pair};
use crate::gpu::mesh::MeshBuffers;
use crate::gpu::scope::scoped_to_buffer;
use crate::layout::{CornerPart, OPPOSITE, Problem};
use crate::run::multilevel::NONE;

/// Largest bound on the inverse mean ratio; higher bounds are lowered to this value. Up to this ratio, single precision
/// reliably distinguishes a triangle from a flat one.
const LARGEST_BOUND: f64 = 1e5;

/// The vertices to be moved, and the bound on triangles.
pub(crate) struct Moves {
    /// Pairs of a vertex's device number and the index of the vertex's target. If a vertex is listed twice, the last
    /// target counts.
    pub(crate) ways: Vec<[u32; 2]>,
    /// Number of targets in the application's buffer, including unused targets.
    pub(crate) listed: usize,
    /// The bound on the inverse mean ratio of triangles.
    pub(crate) worst_imr: f64,
}

impl Moves {
    /// Returns the triangles, and the corners of quadrilaterals, with a moving vertex: the three vertices of each, then each
    /// vertex's index in `ways`, or [`NONE`]. The first vertex of a corner of a quadrilateral is marked by [`OPPOSITE`].
    /// Reduces `ways` to the last target of each vertex.
    fn corners(&mut self, problem: &Problem) -> Vec<[u32; 6]> {
        // The last target of each vertex counts.
        self.ways.reverse();
        self.ways.sort_by_key(|&[vertex, _]| vertex);
        self.ways.dedup_by_key(|&mut [vertex, _]| vertex);
        let mut way_of = vec![NONE; problem.positions().len()];
        for (way, &[vertex, _]) in (0..).zip(&self.ways) {
            way_of[vertex as usize] = way;
        }
        let of_part = |CornerPart { corners, is_right }| {
            let mark = if is_right { OPPOSITE } else { 0 };
            corners.iter().map(move |&[p, q, r]| (mark, [p, q, r]))
        };
        let corners = problem.corner_parts().into_iter().flat_map(of_part).map(|(mark, corner)| {
            let ([p, q, r], [a, b, c]) = (corner, corner.map(|v| way_of[v as usize]));
            [p | mark, q, r, a, b, c]
        });
        corners.filter(|corners| corners[3..].iter().any(|&way| way != NONE)).collect()
    }
}

/// Vertices that an application moves, bound to a buffer of targets and to a word that receives the share of their
/// ways. Created by [`DeviceMesh::bind_move`](crate::gpu::DeviceMesh::bind_move), and usable after the mesh is dropped.
///
/// ```no_run
/// # use gpu_smooth::{*, gpu::*};
/// # fn f(
/// #     mesh: &DeviceMesh, hole: &[u32], targets: &wgpu::Buffer, numbers: &wgpu::Buffer, queue: &wgpu::Queue,
/// #     sweeps: &mut Sweeps, vertices: &BoundVertices, encoder: &mut wgpu::CommandEncoder, where_to: &[[f32; 2]],
/// # ) -> Result<(), SmoothError> {
/// // When the user takes hold of a hole; a target is two floats.
/// let drag = mesh.bind_move(hole, &VertexBuffer::new(targets.slice(..), 8), 8.0, numbers.slice(..))?;
/// // In each frame.
/// queue.write_buffer(targets, 0, bytemuck::cast_slice(where_to));
/// drag.encode_move(encoder);
/// sweeps.encode_sweeps(encoder, 3);
/// vertices.encode_export(encoder);
/// # Ok(())
/// # }
/// ```
pub struct BoundMove {
    find_share: Pipeline,
    move_vertices: Pipeline,
    bind_group: wgpu::BindGroup,
    count: u32,
}

impl BoundMove {
    pub(crate) fn new(
        gpu: &Gpu,
        problem: &Problem,
        mesh: &MeshBuffers,
        mut moves: Moves,
        targets: &VertexBuffer<'_>,
        share: wgpu::BufferSlice<'_>,
    ) -> Result<Self, GpuError> {
        if targets.slice.buffer() == share.buffer() {
            let problem = "targets and share are in one buffer, and a kernel that writes a buffer \
                           cannot read another part of it: use two buffers";
            return Err(GpuError::Buffer(problem.into()));
        }
        let stride = targets.words()?;
        let window = targets.window(gpu, moves.listed.max(1))?;
        let share = Window::new(gpu, share, size_of::<f32>() as u64)?;
        let Coordinates { center, scale } = targets.unjudged_coordinates(problem)?;
        let ([x, x_low], [y, y_low]) = (pair(center.x), pair(center.y));
        let mut corners = moves.corners(problem);
        let count = moves.ways.len() as u32;
        let most = gpu.device.limits().max_storage_buffer_binding_size;
        let what =
            || format!("the buffer of the {} triangles around moved vertices", corners.len());
        let bytes = moved_triangle_bytes(corners.len());
        check_limit("max_storage_buffer_binding_size", most, &what, bytes)?;
        let movement = Movement {
            zero: 0,
            vertices: count,
            triangles: corners.len() as u32,
            worst_imr: moves.worst_imr.min(LARGEST_BOUND) as f32,
            offset: window.offset,
            stride,
            share: share.offset,
            scale: scale as f32,
            center: [x, y, x_low, y_low],
        };
        // An empty buffer cannot be bound.
        corners.resize(corners.len().max(1), [NONE; 6]);
        moves.ways.resize(moves.ways.len().max(1), [NONE; 2]);
        let form = mesh.parts.form();
        let bind_group = scoped_to_buffer(&gpu.device, || {
            let movement = filled(gpu, "movement", &[movement], Usage::UNIFORM);
            let corners = filled(gpu, "corners of moved vertices", &corners, Usage::STORAGE);
            let ways = filled(gpu, "ways of moved vertices", &moves.ways, Usage::STORAGE);
            let bindings = MoveBindings {
                movement: movement.as_entire_binding(),
                positions: mesh.bind_positions(),
                corners: corners.as_entire_binding(),
                ways: ways.as_entire_binding(),
                targets: window.binding(),
                shares: share.binding(),
                changes: mesh.changes.buffer.as_entire_binding(),
            };
            gpu.pipelines.bind(&gpu.device, form, bindings)
        })?;
        let pipeline = |kernel| gpu.pipelines.get(&gpu.device, &kernel, form);
        let find_share = pipeline(Kernel::FindShare)?;
        let move_vertices = pipeline(Kernel::MoveVertices)?;
        Ok(Self { find_share, move_vertices, bind_group, count })
    }

    /// Encodes the move. When the command buffer runs, the vertices go straight toward the targets then in the buffer,
    /// all by an equal share of their ways, as far as the triangles allow. The share, an f32 from 0 to 1, is written to
    /// the bound word; 1 means that the vertices reached their targets.
    ///
    /// The move follows the rules of [`Topology::move_clamped`](crate::Topology::move_clamped), with the positions on
    /// the device. No triangle inverts or becomes flat, neither on the way nor at the end. No triangle gets an inverse
    /// mean ratio above the bound, except for rounding (a relative error of 5e-7 times the ratio). Triangles already
    /// beyond the bound never deteriorate. Triangles that are inverted beforehand, or have an inverse mean ratio above
    /// 500,000, do not limit the move. If a target is not finite, its vertex stays.
    pub fn encode_move(&self, encoder: &mut impl Encoder) {
        let mut passes = encoder.passes("gpu-smooth move");
        passes.run(&self.find_share, None, |pass| {
            pass.set_bind_group(0, &self.bind_group, &[]);
            pass.dispatch_workgroups(1, 1, 1);
        });
        if self.count > 0 {
            passes.run(&self.move_vertices, None, |pass| {
                pass.set_bind_group(0, &self.bind_group, &[]);
                dispatch(pass, self.count);
            });
        }
    }
}
