//! Cuts a mesh into parts if its buffers are larger than a binding.
//!
//! Buffers stay whole. A sweep over a color is one dispatch, or several if the one-rings of the color do not fit one
//! binding; each dispatch binds the one-rings of its own vertices. Likewise, each part of the triangles takes a
//! dispatch of the objective kernel. A kernel may read any position, so every kernel binds all positions, if need be in
//! two bindings: the high parts and the low parts.

use std::ops::Range;

use crate::error::GpuError;
use crate::gpu::device::size::{
    NUMBER, POSITION, QUADRILATERAL, TRIANGLE, check_limit, check_rows, objective_invocations,
};
use crate::gpu::kernels::form::{MeshForm, Positions};
use crate::gpu::kernels::uniforms::WORKGROUP;
use crate::gpu::mesh::bounds;
use crate::layout::{MapKind, Problem};
use crate::mesh::MeshSize;

/// Ranges of a mesh's data that a device can bind at once. Data smaller than a binding form a single part.
#[derive(Clone)]
pub(crate) struct Parts {
    /// Byte offset of the low parts in the buffer of positions. `None` if positions take a single binding.
    pub(crate) low_positions: Option<u64>,
    /// Kind of the maps that follow the positions in their buffer.
    maps: MapKind,
    /// Whether the free vertices are bounded. Discs follow the maps.
    is_bounded: bool,
    /// Parts of the one-rings, cut between vertices.
    pub(crate) rings: Vec<RingPart>,
    /// Parts of the elements: of the triangles, then of the quadrilaterals.
    pub(crate) elements: Vec<ElementPart>,
    /// Whether the one-rings have opposite vertices of quadrilaterals.
    has_quadrilaterals: bool,
    /// Parts of the free vertices, for buffers with a position per free vertex.
    pub(crate) free: Vec<Range<u32>>,
    /// Parts of all vertices, for buffers with a position per vertex.
    pub(crate) vertices: Vec<Range<u32>>,
}

/// One-rings that a kernel binds at once.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct RingPart {
    /// Range of the vertices inside these one-rings.
    pub(crate) vertices: Range<u32>,
    /// Bound range of the buffer of one-rings, in entries. The start is rounded down to the device's alignment, so the
    /// range may begin inside the previous part.
    pub(crate) entries: Range<u32>,
}

/// Elements of one kind that a kernel binds at once.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct ElementPart {
    /// Range in the list of the kind.
    pub(crate) range: Range<u32>,
    /// Number of the first element. Quadrilaterals have the numbers after those of the triangles.
    pub(crate) first: u32,
    pub(crate) are_quadrilaterals: bool,
}

impl ElementPart {
    /// Returns the number of elements.
    pub(crate) fn count(&self) -> u32 {
        self.range.end - self.range.start
    }

    /// Returns the form of the kernels that go over the elements, from the form of the mesh.
    pub(crate) fn form(&self, of_mesh: MeshForm) -> MeshForm {
        if self.are_quadrilaterals { of_mesh } else { of_mesh.of_triangles() }
    }
}

impl Parts {
    /// Cuts a mesh into parts that fit the limits.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`] if the kernels cannot number the vertices or triangles, [`GpuError::Limit`] if the mesh
    /// cannot be cut into parts that fit.
    pub(crate) fn new(problem: &Problem, limits: &wgpu::Limits) -> Result<Self, GpuError> {
        let triangles = problem.judged_triangles().len();
        let quadrilaterals = problem.judged_count() - triangles;
        let vertices = problem.positions().len();
        let size = MeshSize { vertices, triangles: triangles + 4 * quadrilaterals };
        size.check(limits)?;
        let maps = problem.map_kind();
        let rows = bounds::rows(problem);
        check_rows(rows, limits)?;
        let free = problem.free_count() as u32;
        // A part consists of whole rounds of the objective's invocations, so that the sums do not depend on the parts.
        // A binding may start after any round, as the bytes of 64 triangles are a multiple of the alignment, and so are
        // the bytes of 64 positions.
        let round = objective_invocations(problem.judged_count());
        let (triangles, quadrilaterals) = (triangles as u32, quadrilaterals as u32);
        let of_kind = |count, bytes, first, are_quadrilaterals| {
            let ranges = ranges(count, bytes, round, limits).into_iter();
            ranges.map(move |range| ElementPart {
                first: first + range.start,
                range,
                are_quadrilaterals,
            })
        };
        let mut elements = Vec::new();
        if triangles > 0 || quadrilaterals == 0 {
            elements.extend(of_kind(triangles, TRIANGLE, 0, false));
        }
        if quadrilaterals > 0 {
            elements.extend(of_kind(quadrilaterals, QUADRILATERAL, triangles, true));
        }
        Ok(Self {
            low_positions: low_positions(rows, limits),
            maps,
            is_bounded: problem.is_bounded(),
            rings: rings(problem.ring_start(), limits)?,
            elements,
            has_quadrilaterals: problem.has_quadrilaterals(),
            free: ranges(free, POSITION, WORKGROUP, limits),
            vertices: ranges(vertices as u32, POSITION, WORKGROUP, limits),
        })
    }

    /// Returns the number of bind groups that cover all one-rings, elements and free vertices: the largest of their
    /// part counts.
    pub(crate) fn count(&self) -> usize {
        self.rings.len().max(self.elements.len()).max(self.free.len())
    }

    /// Returns whether one binding holds all one-rings, one all free vertices, and one all elements of a kind.
    pub(crate) fn are_whole(&self) -> bool {
        let kinds = self.elements.chunk_by(|a, b| a.are_quadrilaterals == b.are_quadrilaterals);
        self.rings.len() == 1 && self.free.len() == 1 && kinds.count() == self.elements.len()
    }

    /// Returns the form of the mesh for which kernels are composed.
    pub(crate) fn form(&self) -> MeshForm {
        let in_two = self.low_positions.is_some();
        let positions = if in_two { Positions::InTwo } else { Positions::Whole };
        let Self { maps, is_bounded, has_quadrilaterals, .. } = *self;
        MeshForm { positions, maps, is_bounded, has_quadrilaterals }
    }
}

/// Returns `parts[part]`, or the last part if the list is shorter.
pub(crate) fn of_part<T>(parts: &[T], part: usize) -> &T {
    &parts[part.min(parts.len() - 1)]
}

/// Returns the aligned byte offset of the low parts for this number of positions. `None` if the positions fit one
/// binding.
fn low_positions(vertices: usize, limits: &wgpu::Limits) -> Option<u64> {
    let in_two = Positions::of(vertices, limits) == Positions::InTwo;
    let alignment = u64::from(limits.min_storage_buffer_offset_alignment);
    in_two.then(|| (vertices as u64 * POSITION / 2).next_multiple_of(alignment))
}

/// Cuts `count` rows of `bytes` each into parts that fit a binding. Each part except the last has a multiple of `step`
/// rows.
fn ranges(count: u32, bytes: u64, step: u32, limits: &wgpu::Limits) -> Vec<Range<u32>> {
    let most = limits.max_storage_buffer_binding_size;
    let per_part = match u64::from(count) * bytes <= most {
        true => count.max(1),
        false => ((most / bytes) as u32 / step * step).max(step),
    };
    let starts = (0..count.max(1)).step_by(per_part as usize);
    starts.map(|start| start..start.saturating_add(per_part).min(count)).collect()
}

/// Cuts the one-rings between vertices into parts that fit a binding. Returns [`GpuError::Limit`] if a single one-ring
/// does not fit.
fn rings(start: &[u32], limits: &wgpu::Limits) -> Result<Vec<RingPart>, GpuError> {
    let most = limits.max_storage_buffer_binding_size;
    let aligned = (u64::from(limits.min_storage_buffer_offset_alignment) / NUMBER) as u32;
    let mut parts = Vec::new();
    let mut first = 0;
    while let Some((&begin, ends)) =
        start[first..].split_first().filter(|(_, ends)| !ends.is_empty())
    {
        let begin = begin - begin % aligned;
        let bytes = |end: u32| u64::from(end - begin) * NUMBER;
        let count = ends.partition_point(|&end| bytes(end) <= most);
        if count == 0 {
            let what =
                || format!("the one-ring of a vertex of {} neighbors", ends[0] - start[first]);
            check_limit("max_storage_buffer_binding_size", most, &what, bytes(ends[0]))?;
        }
        let last = first + count;
        let vertices = first as u32..last as u32;
        parts.push(RingPart { vertices, entries: begin..start[last] });
        first = last;
    }
    if parts.is_empty() {
        parts.push(RingPart { vertices: 0..0, entries: 0..0 });
    }
    Ok(parts)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn binding(size: u64) -> wgpu::Limits {
        wgpu::Limits { max_storage_buffer_binding_size: size, ..wgpu::Limits::default() }
    }

    #[test]
    fn data_that_fit_one_binding_are_one_part() {
        let part = RingPart { vertices: 0..3, entries: 0..256 };
        assert_eq!(rings(&[0, 100, 200, 256], &binding(1024)).unwrap(), [part]);
        assert_eq!(low_positions(64, &binding(1024)), None);
        assert_eq!(ranges(85, TRIANGLE, 64, &binding(12 * 85)), vec![0..85]);
    }

    #[test]
    fn rings_are_cut_between_vertices_and_bound_from_an_aligned_place_on() {
        // 256 bytes are 64 numbers, and a binding holds 256 numbers.
        let parts = rings(&[0, 100, 200, 257, 300, 500], &binding(1024)).unwrap();
        let part = |vertices, entries| RingPart { vertices, entries };
        assert_eq!(parts, [part(0..2, 0..200), part(2..4, 192..300), part(4..5, 256..500)]);
        // No vertex is left out, for any size of a binding.
        let start: Vec<u32> = (0..1000u32).map(|v| 6 * v + v % 5).collect();
        for size in [512, 1000, 1028, 4096] {
            let parts = rings(&start, &binding(size)).unwrap();
            assert!(parts.len() > 4);
            let mut next = 0;
            for RingPart { vertices, entries } in parts {
                assert_eq!((vertices.start, entries.start % 64), (next, 0));
                assert!(entries.start <= start[vertices.start as usize]);
                assert_eq!(entries.end, start[vertices.end as usize]);
                assert!(u64::from(entries.end - entries.start) * NUMBER <= size);
                next = vertices.end;
            }
            assert_eq!(next, 999);
        }
    }

    #[test]
    fn a_ring_larger_than_a_binding_is_refused() {
        let error = rings(&[0, 60, 330], &binding(1024)).unwrap_err();
        assert!(matches!(error, GpuError::Limit { needed: 1320, available: 1024, .. }), "{error}");
    }

    #[test]
    fn rows_are_cut_at_multiples_of_the_step() {
        assert_eq!(ranges(170, TRIANGLE, 64, &binding(12 * 150)), [0..128, 128..170]);
        assert_eq!(ranges(128, TRIANGLE, 64, &binding(12 * 127)), [0..64, 64..128]);
    }

    #[test]
    fn low_positions_begin_at_an_aligned_offset() {
        assert_eq!(low_positions(65, &binding(1039)), Some(768));
        assert_eq!(low_positions(96, &binding(1039)), Some(768));
        assert_eq!(low_positions(97, &binding(1039)), Some(1024));
    }
}
