//! Creates, binds, reads and writes the buffers of a mesh on a device.

use glam::DVec2;
use wgpu::BufferUsages as Usage;

use crate::error::GpuError;
use crate::gpu::device::Gpu;
use crate::gpu::device::buffers::{
    bytes, filled, filled_with_pauses, rows, write_by_pieces, zeroed,
};
use crate::gpu::device::pending::Waiting;
use crate::gpu::device::readback;
use crate::gpu::device::size::{NUMBER, POSITION, QUADRILATERAL, TRIANGLE};
use crate::gpu::kernels::layouts::BoundPositions;
use crate::gpu::kernels::uniforms::split;
use crate::gpu::mesh::{Changes, Curves, Parts, bounds, of_part};
use crate::gpu::scope::scoped;
use crate::layout::Problem;
use crate::parallel::pace::now;
use crate::parallel::paced;

/// The buffers that live as long as a mesh stays on the device.
pub(crate) struct MeshBuffers {
    pub(crate) positions: wgpu::Buffer,
    pub(crate) ring_start: wgpu::Buffer,
    pub(crate) ring: wgpu::Buffer,
    pub(crate) triangles: wgpu::Buffer,
    /// `None` for a mesh of triangles alone.
    pub(crate) quadrilaterals: Option<wgpu::Buffer>,
    /// The vertices that slide along curves. `None` if no vertex slides.
    pub(crate) curves: Option<Curves>,
    /// Counters of the application's changes to the mesh.
    pub(crate) changes: Changes,
    /// Ranges of the buffers that are bound at once.
    pub(crate) parts: Parts,
}

impl MeshBuffers {
    /// Uploads a problem with its vertices at `positions`.
    pub(crate) async fn new(
        gpu: &Gpu,
        problem: &Problem,
        positions: &[DVec2],
    ) -> Result<Self, GpuError> {
        let parts = Parts::new(problem, &gpu.device.limits())?;
        let positions =
            laid_out(positions, problem.maps(), &bounds::discs(problem), parts.low_positions).await;
        let usage = Usage::STORAGE | Usage::COPY_SRC | Usage::COPY_DST;
        let positions = filled_with_pauses(gpu, "positions", &[&positions], usage).await?;
        let (starts, usage) = (problem.ring_start(), Usage::STORAGE | Usage::COPY_DST);
        let ring_start = filled_with_pauses(gpu, "ring starts", &[starts], usage).await?;
        let (ring, triangles) = (problem.ring(), problem.judged_triangles());
        let ring = filled_with_pauses(gpu, "one-rings", &[ring], Usage::STORAGE).await?;
        let triangles = filled_with_pauses(gpu, "triangles", &[triangles], Usage::STORAGE).await?;
        let listed = problem.judged_quadrilaterals();
        let quadrilaterals = match &listed[..] {
            [] => None,
            listed => {
                let (label, usage) = ("quadrilaterals", Usage::STORAGE);
                Some(filled_with_pauses(gpu, label, &[listed], usage).await?)
            }
        };
        let changes = scoped(&gpu.device, || Changes::new(gpu))?;
        Ok(Self {
            positions,
            ring_start,
            ring,
            triangles,
            quadrilaterals,
            curves: None,
            changes,
            parts,
        })
    }

    /// Creates a mesh at other `positions`, with its own counters of changes. Both meshes share all other buffers.
    ///
    /// # Errors
    /// [`GpuError::OutOfMemory`], or another [`GpuError`] if the device fails.
    pub(crate) fn with_positions(
        &self,
        gpu: &Gpu,
        problem: &Problem,
        positions: &[DVec2],
    ) -> Result<Self, GpuError> {
        let positions = now(laid_out(
            positions,
            problem.maps(),
            &bounds::discs(problem),
            self.parts.low_positions,
        ));
        scoped(&gpu.device, || {
            self.at(gpu, filled(gpu, "further positions", &positions, Usage::STORAGE))
        })
    }

    /// Creates a mesh at the positions that this mesh has on the device after all submitted work.
    ///
    /// # Errors
    /// [`GpuError::OutOfMemory`], or another [`GpuError`] if the device fails.
    pub(crate) fn copied(&self, gpu: &Gpu) -> Result<Self, GpuError> {
        scoped(&gpu.device, || {
            let (bytes, usage) = (self.positions.size(), Usage::STORAGE | Usage::COPY_DST);
            let positions = zeroed(gpu, "copied positions", bytes, usage);
            let descriptor = wgpu::CommandEncoderDescriptor { label: Some("gpu-smooth copy") };
            let mut encoder = gpu.device.create_command_encoder(&descriptor);
            encoder.copy_buffer_to_buffer(&self.positions, 0, &positions, 0, bytes);
            gpu.queue.submit([encoder.finish()]);
            self.at(gpu, positions)
        })
    }

    /// Returns a mesh with its own positions and counters of changes, which shares all other buffers. No vertex of it slides.
    fn at(&self, gpu: &Gpu, positions: wgpu::Buffer) -> Self {
        Self {
            positions,
            ring_start: self.ring_start.clone(),
            ring: self.ring.clone(),
            triangles: self.triangles.clone(),
            quadrilaterals: self.quadrilaterals.clone(),
            curves: None,
            changes: Changes::new(gpu),
            parts: self.parts.clone(),
        }
    }

    /// Returns the binding of the positions, or both bindings if the positions take two.
    pub(crate) fn bind_positions(&self) -> BoundPositions<'_> {
        let whole = &self.positions;
        match self.parts.low_positions {
            None => BoundPositions { whole_or_high: whole.as_entire_binding(), low: None },
            Some(low) => BoundPositions {
                whole_or_high: bytes(whole, 0..low),
                low: Some(bytes(whole, low..whole.size())),
            },
        }
    }

    /// Reads back the first `count` positions after all work submitted so far: x and y, then the low parts of x and y.
    pub(crate) async fn read_positions(
        &self,
        gpu: &Gpu,
        count: usize,
        waiting: Waiting,
    ) -> Result<Vec<[f32; 4]>, GpuError> {
        let Some(low) = self.parts.low_positions else {
            return readback::read(gpu, &self.positions, count, waiting).await;
        };
        let low = (low / PART) as usize;
        let parts: Vec<[f32; 2]> =
            readback::read(gpu, &self.positions, low + count, waiting).await?;
        let joined = parts.iter().zip(&parts[low..]).map(|(&[x, y], &[a, b])| [x, y, a, b]);
        Ok(joined.collect())
    }

    /// Writes the positions of the first vertices, in the form that [`read_positions`](Self::read_positions) returns.
    pub(crate) fn write_positions(
        &self,
        gpu: &Gpu,
        positions: &[[f32; 4]],
    ) -> Result<(), GpuError> {
        self.write_positions_from(gpu, 0, positions)
    }

    /// Writes the positions of the vertices from number `first` on.
    pub(crate) fn write_positions_from(
        &self,
        gpu: &Gpu,
        first: usize,
        positions: &[[f32; 4]],
    ) -> Result<(), GpuError> {
        let first = first as u64;
        scoped(&gpu.device, || match self.parts.low_positions {
            None => {
                let bytes = bytemuck::cast_slice(positions);
                write_by_pieces(gpu, &self.positions, first * POSITION, bytes);
            }
            Some(low) => {
                let half = |of: fn(&[f32; 4]) -> [f32; 2]| positions.iter().map(of).collect();
                let (highs, lows): (Vec<_>, Vec<_>) =
                    (half(|p| [p[0], p[1]]), half(|p| [p[2], p[3]]));
                let at = first * PART;
                write_by_pieces(gpu, &self.positions, at, bytemuck::cast_slice(&highs));
                write_by_pieces(gpu, &self.positions, low + at, bytemuck::cast_slice(&lows));
            }
        })
    }

    /// Overwrites the maps with the maps of another problem of the same layout. Does nothing for a problem without maps.
    pub(crate) fn write_maps(&self, gpu: &Gpu, problem: &Problem) -> Result<(), GpuError> {
        let Some(maps) = problem.maps() else { return Ok(()) };
        let first = problem.positions().len() as u64;
        scoped(&gpu.device, || match self.parts.low_positions {
            None => {
                let maps: Vec<_> = maps.iter().map(|&[xx, xy, yy]| [xx, xy, yy, 0.0]).collect();
                let bytes = bytemuck::cast_slice(&maps);
                write_by_pieces(gpu, &self.positions, first * POSITION, bytes);
            }
            Some(low) => {
                let highs: Vec<_> = maps.iter().map(|&[xx, xy, _]| [xx, xy]).collect();
                let lows: Vec<_> = maps.iter().map(|&[_, _, yy]| [yy, 0.0]).collect();
                let at = first * PART;
                write_by_pieces(gpu, &self.positions, at, bytemuck::cast_slice(&highs));
                write_by_pieces(gpu, &self.positions, low + at, bytemuck::cast_slice(&lows));
            }
        })
    }

    /// Returns the binding of the mesh's one-rings in one part.
    pub(crate) fn bind_ring(&self, part: usize) -> wgpu::BindingResource<'_> {
        rows(&self.ring, &of_part(&self.parts.rings, part).entries, NUMBER)
    }

    /// Returns the binding of the mesh's elements in one part.
    pub(crate) fn bind_elements(&self, part: usize) -> wgpu::BindingResource<'_> {
        let part = of_part(&self.parts.elements, part);
        match &self.quadrilaterals {
            Some(quadrilaterals) if part.are_quadrilaterals => {
                rows(quadrilaterals, &part.range, QUADRILATERAL)
            }
            _ => rows(&self.triangles, &part.range, TRIANGLE),
        }
    }
}

/// Number of rows that are computed between two pauses.
const CHUNK: usize = 1 << 14;

/// Size of the high parts of a position, in bytes. The low parts have equal size.
const PART: u64 = POSITION / 2;

/// Returns the content of the buffer of positions. Without `low`, the low parts of each vertex follow its high parts.
/// With `low`, all high parts come first, and all low parts start at byte `low`. Maps follow the positions in
/// the same form, and then the rows of discs.
async fn laid_out(
    positions: &[DVec2],
    maps: Option<&[[f32; 3]]>,
    discs: &[[f32; 4]],
    low: Option<u64>,
) -> Vec<[f32; 2]> {
    let first_disc = positions.len() + maps.map_or(0, <[_]>::len);
    let count = first_disc + discs.len();
    let (step, low, length) = match low {
        None => (2, 1, 2 * count),
        Some(low) => (1, (low / PART) as usize, (low / PART) as usize + count),
    };
    let mut parts = vec![[0.0; 2]; length];
    let maps = maps.unwrap_or_default();
    let row_of = |row: usize| match positions.get(row) {
        Some(&position) => split(position),
        None if row >= first_disc => discs[row - first_disc],
        None => {
            let [xx, xy, yy] = maps[row - positions.len()];
            [xx, xy, yy, 0.0]
        }
    };
    paced::in_order(count, CHUNK, |rows| {
        for row in rows {
            let [a, b, c, d] = row_of(row);
            parts[step * row] = [a, b];
            parts[step * row + low] = [c, d];
        }
    })
    .await;
    parts
}
