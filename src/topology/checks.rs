//! Checks of the input of a topology: indices, coordinates, and the size of a mesh.

use crate::error::MeshError;
use crate::mesh::{Element, Mesh};
use crate::parallel::{map_parts, map_ranges};
use crate::topology::winding::NONE;

/// Upper limit of the number of vertices. One-rings mark vertices by the highest bit of their numbers.
const MOST_VERTICES: usize = 1 << 31;

/// Checks that the mesh has elements, that indices fit 32 bits and are valid, that coordinates are finite, and that no
/// element repeats a vertex.
pub(super) fn check_indices(mesh: &Mesh) -> Result<(), MeshError> {
    let Mesh { points, triangles, quadrilaterals, fixed } = mesh;
    if triangles.is_empty() && quadrilaterals.is_empty() {
        return Err(MeshError::Empty);
    }
    let vertices = points.len();
    let corners = triangles.len() + 4 * quadrilaterals.len();
    if vertices >= MOST_VERTICES || corners >= NONE as usize / 3 {
        return Err(MeshError::TooLarge { vertices, triangles: mesh.size().triangles });
    }
    check_finite(points)?;
    check_elements(vertices, triangles, Element::Triangle)?;
    check_elements(vertices, quadrilaterals, Element::Quadrilateral)?;
    match fixed.iter().find(|&&v| v as usize >= vertices) {
        Some(&vertex) => Err(MeshError::IndexOutOfRange { element: None, vertex, vertices }),
        None => Ok(()),
    }
}

/// Checks that the vertices of elements exist, and that no element repeats one.
fn check_elements<const N: usize>(
    vertices: usize,
    elements: &[[u32; N]],
    element: impl Fn(usize) -> Element,
) -> Result<(), MeshError> {
    let count = vertices as u32;
    let is_bad = |corners: &[u32; N]| {
        let mut bad = false;
        for i in 0..N {
            bad |= corners[i] >= count;
            for k in 0..i {
                bad |= corners[i] == corners[k];
            }
        }
        bad
    };
    let Some(index) = first(elements, is_bad) else { return Ok(()) };
    let (corners, element) = (&elements[index], element(index));
    if let Some(&vertex) = corners.iter().find(|&&v| v >= count) {
        return Err(MeshError::IndexOutOfRange { element: Some(element), vertex, vertices });
    }
    let is_repeated = |&i: &usize| corners[i + 1..].contains(&corners[i]);
    match (0..N).find(is_repeated) {
        Some(i) => Err(MeshError::RepeatedVertex { element, vertex: corners[i] }),
        None => Ok(()),
    }
}

/// Checks that all coordinates are finite.
pub(super) fn check_finite(points: &[[f64; 2]]) -> Result<(), MeshError> {
    let is_infinite = |p: &[f64; 2]| !(p[0].is_finite() & p[1].is_finite());
    match first(points, is_infinite) {
        None => Ok(()),
        Some(vertex) => Err(MeshError::NotFinite { vertex: vertex as u32 }),
    }
}

/// Returns the index of the first item for which `is_bad` holds.
fn first<T: Sync>(items: &[T], is_bad: impl Fn(&T) -> bool + Sync) -> Option<usize> {
    const CHUNK: usize = 1 << 14;
    // Every item of a chunk is tested, as a loop without branches is faster than a loop that may end early.
    let any = |_, chunk: &[T]| chunk.iter().fold(false, |any, item| any | is_bad(item));
    let chunk = map_parts(items.chunks(CHUNK), any).into_iter().position(|any| any)?;
    items.iter().skip(chunk * CHUNK).position(is_bad).map(|i| chunk * CHUNK + i)
}

/// Returns the larger coordinate of a point, in absolute value.
pub(super) fn size(point: [f64; 2]) -> f64 {
    point[0].abs().max(point[1].abs())
}

/// Checks that the largest coordinate of a vertex that some element uses is from 1e-100 to 1e100 in absolute value.
/// Unused vertices may be anywhere. `size` returns the larger coordinate of each of `count` vertices, 0 for an unused
/// vertex.
pub(super) fn check_size(
    count: usize,
    size: impl Fn(usize) -> f64 + Sync,
) -> Result<(), MeshError> {
    let sizes = map_ranges(count, 1 << 14, |range| range.map(&size).fold(0.0, f64::max));
    let size = sizes.into_iter().fold(0.0, f64::max);
    match size {
        1e-100..=1e100 => Ok(()),
        _ => Err(MeshError::OutOfRange { size }),
    }
}
