//! VTK's numbers of cell types, which SU2 uses too.

use crate::visit::items::CellKind;

/// An empty cell, without vertices.
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
pub(crate) const LAGRANGE_CURVE: u64 = 68;
pub(crate) const LAGRANGE_TRIANGLE: u64 = 69;
pub(crate) const LAGRANGE_QUAD: u64 = 70;
pub(crate) const BEZIER_CURVE: u64 = 75;
pub(crate) const BEZIER_TRIANGLE: u64 = 76;
pub(crate) const BEZIER_QUAD: u64 = 77;

/// Returns whether cells of the type are first-order volume cells: tetrahedra (10) to hexagonal prisms (16), convex
/// point sets (41) and polyhedra (42).
pub(crate) fn is_of_volume(number: u64) -> bool {
    matches!(number, TETRA..=16 | 41 | 42)
}

/// Returns VTK's cell type for an element kind.
pub(crate) fn number_of(kind: CellKind) -> u64 {
    match kind {
        CellKind::Point => VERTEX,
        CellKind::Line => LINE,
        CellKind::Triangle => TRIANGLE,
        CellKind::Polygon => POLYGON,
        CellKind::Quadrilateral => QUAD,
    }
}

/// Returns the element kind for VTK's cell type. `None` for types with a variable number of vertices, volume cells and
/// cells of higher order.
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
