//! What a mesh takes on a device, known before anything is allocated.

use crate::error::GpuError;
use crate::gpu::kernels::pipelines::storage_bindings;
use crate::gpu::kernels::table::Positions;
use crate::gpu::kernels::uniforms::{Control, SLOTS, WORKGROUP};

/// How large a mesh is, for [`Gpu::required_limits`](crate::gpu::Gpu::required_limits) and
/// [`Gpu::check_size`](crate::gpu::Gpu::check_size).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MeshSize {
    /// Number of vertices.
    pub vertices: usize,
    /// Number of triangles.
    pub triangles: usize,
}

/// A buffer that grows with the mesh.
struct Need {
    what: &'static str,
    bytes: u64,
    spread: Spread,
}

/// How a buffer is bound where it is larger than a binding.
enum Spread {
    /// Not at all.
    No,
    /// In two bindings of every kernel, half of it in each.
    Two,
    /// Part by part, in a dispatch each, a part being of these many bytes at the least.
    Parts { least: u64 },
}

/// Bytes of a position, a pair of floats for each coordinate.
pub(crate) const POSITION: u64 = size_of::<[f32; 4]>() as u64;
/// What a binding begins at a multiple of, at the most.
const ALIGNMENT: u64 = 256;
/// Bytes of a triangle.
pub(crate) const TRIANGLE: u64 = size_of::<[u32; 3]>() as u64;
/// Bytes of a vertex number.
pub(crate) const NUMBER: u64 = size_of::<u32>() as u64;

impl MeshSize {
    /// Each buffer. Of the one-rings, which hold each corner of a triangle at most once, the bound; of the best
    /// positions, which hold free vertices alone, too.
    fn needs(self, positions: Positions) -> [Need; 6] {
        let room = if positions == Positions::InTwo { ALIGNMENT } else { 0 };
        let (vertices, triangles) = (self.vertices as u64, self.triangles as u64);
        let objective = u64::from(objective_invocations(self.triangles));
        let (best, rings) = (vertices * POSITION, 3 * triangles * NUMBER);
        let sums = (SLOTS as u64 * objective * size_of::<[f32; 2]>() as u64)
            .max(size_of::<Control>() as u64);
        let starts = (vertices + 1) * NUMBER;
        let need = |what, bytes, spread| Need { what, bytes, spread };
        let round = Spread::Parts { least: objective * TRIANGLE };
        [
            need("the buffer of vertex positions", best + room, Spread::Two),
            need("the buffer of triangles", triangles * TRIANGLE, round),
            need("the buffer of one-rings", rings, Spread::Parts { least: 0 }),
            need("the buffer of ring starts", starts, Spread::No),
            need("the buffer of best positions", best, Spread::Parts { least: 0 }),
            need("the buffer of sums", sums, Spread::No),
        ]
    }

    /// The bytes of device memory that the mesh and sweeps on it take, at the most: 84 a vertex. A scheme whose last
    /// state is its best takes 68. Corrections from coarser levels are not in it; they take some 60 more.
    pub fn bytes(self) -> u64 {
        self.needs(Positions::Whole).iter().map(|need| need.bytes).sum()
    }

    /// The largest buffer.
    pub(crate) fn largest(self, positions: Positions) -> u64 {
        self.needs(positions).iter().map(|need| need.bytes).fold(0, u64::max)
    }

    /// Fails if the mesh does not fit the limits, however it is bound.
    pub(crate) fn check(self, limits: &wgpu::Limits) -> Result<(), GpuError> {
        let bound = limits.max_storage_buffer_binding_size;
        let positions = Positions::of(self.vertices, limits);
        for Need { what, bytes, spread } in self.needs(positions) {
            let what = || format!("{what} ({} vertices)", self.vertices);
            check_limit("max_buffer_size", limits.max_buffer_size, &what, bytes)?;
            let at_once = match spread {
                Spread::Two if positions == Positions::InTwo => self.vertices as u64 * POSITION / 2,
                Spread::No | Spread::Two => bytes,
                Spread::Parts { least } => least,
            };
            check_limit("max_storage_buffer_binding_size", bound, &what, at_once)?;
        }
        // That other kernels bind few enough was checked when the `Gpu` was made.
        if positions == Positions::Whole {
            return Ok(());
        }
        let what = || format!("a kernel that binds positions in two ({} vertices)", self.vertices);
        let (needed, limit) =
            (storage_bindings(Positions::InTwo), "max_storage_buffers_per_shader_stage");
        let available = limits.max_storage_buffers_per_shader_stage;
        check_limit(limit, available.into(), &what, needed.into())
    }
}

/// Fails if more is needed than there is.
pub(crate) fn check_limit(
    limit: &'static str,
    available: u64,
    what: &impl Fn() -> String,
    needed: u64,
) -> Result<(), GpuError> {
    if needed > available {
        return Err(GpuError::Limit { what: what(), needed, limit, available });
    }
    Ok(())
}

/// Invocations of a sum over the triangles: few enough to end it in one workgroup, enough to fill a large
/// GPU.
pub(crate) fn objective_invocations(triangles: usize) -> u32 {
    (triangles as u32).div_ceil(2048).clamp(1, 1024) * WORKGROUP
}
