//! Computes the memory that a mesh takes on a device, before anything is allocated.

use crate::error::GpuError;
use crate::gpu::kernels::form::Positions;
use crate::gpu::kernels::layouts::storage_bindings;
use crate::gpu::kernels::uniforms::{Control, HELD, MOST_SUMMED, SLOTS, WORKGROUP};
use crate::mesh::MeshSize;

/// The size of one buffer of a mesh, with a name for errors.
struct Need {
    what: &'static str,
    bytes: u64,
    spread: BindingRule,
}

/// The rule by which a buffer larger than a binding is bound.
enum BindingRule {
    /// The buffer is bound whole, or the mesh does not fit.
    No,
    /// Two bindings, with half of the buffer in each.
    Two,
    /// One dispatch per part of the buffer, with at least `least` bytes in each part.
    Parts { least: u64 },
}

/// Bytes of a position, a pair of floats for each coordinate.
pub(crate) const POSITION: u64 = size_of::<[f32; 4]>() as u64;
/// The largest alignment, in bytes, that a device may require of the start of a binding.
pub(crate) const ALIGNMENT: u64 = 256;
/// Bytes of a triangle.
pub(crate) const TRIANGLE: u64 = size_of::<[u32; 3]>() as u64;
/// Bytes of a quadrilateral.
pub(crate) const QUADRILATERAL: u64 = size_of::<[u32; 4]>() as u64;
/// Bytes of a vertex number.
pub(crate) const NUMBER: u64 = size_of::<u32>() as u64;

/// Largest number of triangles for the kernels. One-rings have at most one entry for each corner of a triangle, and the
/// offsets of one-rings must stay below the bit [`HELD`] of a ring start.
const MAX_TRIANGLES: usize = (HELD as usize - 1) / 3;
/// Largest number of vertices for the kernels, which number the vertices, and the end of the one-rings, in 32 bits.
const MAX_VERTICES: usize = u32::MAX as usize - 1;

impl MeshSize {
    /// Returns the size of each buffer. For one-rings and best positions, the sizes are upper bounds: one-rings hold
    /// each corner of a triangle at most once, and best positions are stored for free vertices only.
    fn needs(self, positions: Positions) -> [Need; 6] {
        let room = if positions == Positions::InTwo { ALIGNMENT } else { 0 };
        let (vertices, triangles) = (self.vertices as u64, self.triangles as u64);
        let invocations = objective_invocations(self.triangles);
        let sums = u64::from(invocations + span_count(invocations));
        let (best, rings) =
            (vertices.saturating_mul(POSITION), triangles.saturating_mul(3 * NUMBER));
        let sums =
            (SLOTS as u64 * sums * size_of::<[f32; 2]>() as u64).max(size_of::<Control>() as u64);
        let starts = vertices.saturating_add(1).saturating_mul(NUMBER);
        let need = |what, bytes, spread| Need { what, bytes, spread };
        let round = BindingRule::Parts { least: u64::from(invocations) * TRIANGLE };
        [
            need("the buffer of vertex positions", best.saturating_add(room), BindingRule::Two),
            need("the buffer of triangles", triangles.saturating_mul(TRIANGLE), round),
            need("the buffer of one-rings", rings, BindingRule::Parts { least: 0 }),
            need("the buffer of ring starts", starts, BindingRule::No),
            need("the buffer of best positions", best, BindingRule::Parts { least: 0 }),
            need("the buffer of sums", sums, BindingRule::No),
        ]
    }

    /// Returns an upper bound on the device memory for the mesh and its sweeps, in bytes: about 84 for each vertex.
    /// Schemes that lower f in every sweep take 68 bytes per vertex. Corrections from coarser levels are not included:
    /// some 60 bytes more for each vertex, and another 40 while corrections are accelerated. Newton steps take some 230 bytes more for
    /// each vertex in place of corrections. If the sum overflows,
    /// returns [`u64::MAX`].
    pub fn bytes(self) -> u64 {
        self.needs(Positions::Whole).iter().fold(0, |sum, need| sum.saturating_add(need.bytes))
    }

    /// Returns the size of the largest buffer, in bytes.
    pub(crate) fn largest(self, positions: Positions) -> u64 {
        self.needs(positions).iter().map(|need| need.bytes).fold(0, u64::max)
    }

    /// Returns the size of the largest buffer for a move of all vertices, in bytes.
    pub(crate) fn largest_of_move(self) -> u64 {
        // A row for each vertex, and a row for each target.
        row_bytes(self.vertices.saturating_mul(2)).max(moved_triangle_bytes(self.triangles))
    }

    /// Returns an upper estimate of the size of the largest buffer for Newton steps of all vertices, in bytes: the blocks of
    /// the Hessian, one for each neighbor of a vertex, or the matrices of the levels.
    pub(crate) fn largest_of_step(self) -> u64 {
        // Each corner of a triangle is a neighbor of the next corner, and around a boundary there is one neighbor more.
        let blocks = (self.triangles.saturating_mul(3)).saturating_add(self.vertices) as u64;
        blocks.saturating_mul(16).max((self.vertices as u64).saturating_mul(160))
    }

    /// Returns [`GpuError::TooLarge`] if the kernels cannot number the vertices or triangles, and [`GpuError::Limit`]
    /// if a buffer exceeds the limits even when bound in parts.
    pub(crate) fn check(self, limits: &wgpu::Limits) -> Result<(), GpuError> {
        let Self { vertices, triangles } = self;
        if triangles > MAX_TRIANGLES || vertices > MAX_VERTICES {
            let (most_vertices, most_triangles) = (MAX_VERTICES, MAX_TRIANGLES);
            return Err(GpuError::TooLarge { vertices, triangles, most_vertices, most_triangles });
        }
        let bound = limits.max_storage_buffer_binding_size;
        let positions = Positions::of(self.vertices, limits);
        for Need { what, bytes, spread } in self.needs(positions) {
            let what = || format!("{what} ({vertices} vertices)");
            check_limit("max_buffer_size", limits.max_buffer_size, &what, bytes)?;
            let at_once = match spread {
                BindingRule::Two if positions == Positions::InTwo => {
                    vertices as u64 * (POSITION / 2)
                }
                BindingRule::No | BindingRule::Two => bytes,
                BindingRule::Parts { least } => least,
            };
            check_limit("max_storage_buffer_binding_size", bound, &what, at_once)?;
        }
        // The kernels of positions in one binding were checked against this limit when the `Gpu` was made.
        if positions == Positions::Whole {
            return Ok(());
        }
        let what = || format!("a kernel that binds positions in two ({vertices} vertices)");
        let (needed, limit) =
            (storage_bindings(Positions::InTwo), "max_storage_buffers_per_shader_stage");
        let available = limits.max_storage_buffers_per_shader_stage;
        check_limit(limit, available.into(), &what, needed.into())
    }
}

/// Returns the size of a buffer of positions and targets with this number of rows, in bytes.
fn row_bytes(rows: usize) -> u64 {
    (rows as u64).saturating_mul(POSITION).saturating_add(ALIGNMENT)
}

/// Returns the size of the triangles around moved vertices, in bytes.
pub(crate) fn moved_triangle_bytes(triangles: usize) -> u64 {
    (triangles as u64).saturating_mul(size_of::<[u32; 6]>() as u64)
}

/// Returns [`GpuError::Limit`] if a buffer with this number of rows, each as large as a position, exceeds the limits
/// even in two bindings.
pub(crate) fn check_rows(rows: usize, limits: &wgpu::Limits) -> Result<(), GpuError> {
    let bytes = row_bytes(rows);
    let what = || format!("the buffer of positions and targets ({rows} rows)");
    check_limit("max_buffer_size", limits.max_buffer_size, &what, bytes - ALIGNMENT)?;
    let at_once = match Positions::of(rows, limits) {
        Positions::Whole => bytes - ALIGNMENT,
        Positions::InTwo => bytes / 2,
    };
    let bound = limits.max_storage_buffer_binding_size;
    check_limit("max_storage_buffer_binding_size", bound, &what, at_once)
}

/// Returns [`GpuError::Limit`] if `needed` exceeds `available`. `what` names the resource in the error.
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

/// Returns how many invocations sum over the triangles: enough to fill a large GPU, and few enough that the sums of their
/// [spans](span_count) are few.
pub(crate) fn objective_invocations(triangles: usize) -> u32 {
    u32::try_from(triangles).unwrap_or(u32::MAX).div_ceil(2048).clamp(1, 1024) * WORKGROUP
}

/// Returns the number of spans in which a list of partial sums is added up; 0 if one workgroup adds up the whole list in one stage.
/// `span_count` of shaders/spans.wgsl agrees.
pub(crate) fn span_count(partials: u32) -> u32 {
    if partials > MOST_SUMMED { partials.div_ceil(MOST_SUMMED) } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A device without limits.
    fn boundless() -> wgpu::Limits {
        wgpu::Limits {
            max_buffer_size: u64::MAX,
            max_storage_buffer_binding_size: u64::MAX,
            ..wgpu::Limits::default()
        }
    }

    #[test]
    fn ring_starts_that_meet_the_bit_of_held_vertices_are_refused() {
        let size = |triangles| MeshSize { vertices: 360_000_000, triangles };
        // The last ring ends at three times the triangles.
        let most = (HELD as usize - 1) / 3;
        size(most).check(&boundless()).unwrap();
        let error = size(most + 1).check(&boundless()).unwrap_err();
        assert!(matches!(error, GpuError::TooLarge { triangles, .. } if triangles == most + 1));
        let text = error.to_string();
        assert!(text.contains("715827883 triangles") && text.contains("715827882"), "{text}");
    }

    #[test]
    fn vertices_that_32_bits_do_not_number_are_refused() {
        let size = MeshSize { vertices: u32::MAX as usize, triangles: 1 };
        let error = size.check(&boundless()).unwrap_err();
        assert!(matches!(error, GpuError::TooLarge { .. }), "{error}");
    }

    #[test]
    fn bytes_of_an_impossible_mesh_do_not_wrap() {
        for size in [
            MeshSize { vertices: usize::MAX, triangles: usize::MAX },
            MeshSize { vertices: usize::MAX, triangles: 1 },
            MeshSize { vertices: 1, triangles: usize::MAX },
            MeshSize { vertices: usize::MAX / 16 + 1, triangles: usize::MAX / 12 + 1 },
        ] {
            assert_eq!(size.bytes(), u64::MAX, "{size:?}");
            for positions in Positions::ALL {
                assert!(size.largest(positions) > u64::MAX / 2, "{size:?}");
            }
            assert!(size.check(&boundless()).is_err());
        }
        let bytes = |vertices| MeshSize { vertices, triangles: 2 * vertices }.bytes();
        assert_eq!(bytes(20_000_000) - bytes(10_000_000), 84 * 10_000_000);
    }

    #[test]
    fn the_number_of_invocations_never_falls_with_more_triangles() {
        let counts = [0, 1, 1 << 20, 1 << 31, (1 << 32) - 1, 1 << 32, usize::MAX];
        let invocations = counts.map(objective_invocations);
        assert!(invocations.is_sorted(), "{invocations:?}");
    }
}
