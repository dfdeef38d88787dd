//! VTK's numbers of the types of cells, which SU2 uses too.

use crate::visit::items::CellKind;

/// An empty cell, which has no vertices.
pub(crate) const EMPTY: u64 = 0;
pub(crate) const VERTEX: u64 = 1;
pub(crate) const POLY_VERTEX: u64 = 2;
pub(crate) const LINE: u64 = 3;
pub(crate) const POLY_LINE: u64 = 4;
pub(crate) const TRIANGLE: u64 = 5;
pub(crate) const TRIANGLE_STRIP: u64 = 6;
pub(crate) const POLYGON: u64 = 7;
pub(crate) const PIXEL: u64 = 8;
pub(crate) const QUAD: u64 = 9;
pub(crate) const TETRA: u64 = 10;
pub(crate) const HEXAHEDRON: u64 = 12;
pub(crate) const WEDGE: u64 = 13;
pub(crate) const PYRAMID: u64 = 14;

/// Whether cells of the type are of first order and belong to a volume: from tetrahedra to hexagonal prisms, sets of points
/// (41) and polyhedra (42).
pub(crate) fn is_of_volume(number: u64) -> bool {
    matches!(number, TETRA..=16 | 41 | 42)
}

/// Returns the number of the cell that a kind of element is.
pub(crate) fn number_of(kind: CellKind) -> u64 {
    match kind {
        CellKind::Point => VERTEX,
        CellKind::Line => LINE,
        CellKind::Triangle => TRIANGLE,
        CellKind::Polygon => POLYGON,
        CellKind::Quadrilateral => QUAD,
    }
}

/// Returns the kind of an element by the number of its cell; `None` if cells of the type may have any number of vertices,
/// belong to a volume or are not of first order.
#[inline]
pub(crate) fn kind_of(number: u64) -> Option<CellKind> {
    match number {
        VERTEX => Some(CellKind::Point),
        LINE => Some(CellKind::Line),
        TRIANGLE => Some(CellKind::Triangle),
        QUAD => Some(CellKind::Quadrilateral),
        _ => None,
    }
}
