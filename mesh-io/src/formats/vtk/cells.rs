//! Cells by VTK's type numbers, as VTK's formats and XDMF have them.

use crate::binary::int_array::IntArray;
use crate::binary::number_field::NumberField;
use crate::error::ReadError;
use crate::formats::vtk::types;
use crate::text::cursor::{CORRECT, Cursor};
use crate::visit::items::{CellKind, Element};
use crate::visit::records::{FieldRule, MIN_PARALLEL_RECORDS, Region, TriangleRecords};
use crate::visit::rows::volume;
use crate::visit::visitor::{MeshVisitor, POLYLINES};
use std::ops::Range;

/// A cell of a VTK or XDMF file.
#[derive(Clone, Copy)]
pub(crate) struct Cell<'a> {
    /// Position of the cell in the file, from 0.
    pub(crate) id: u64,
    /// VTK's type number, such as 5 for a triangle.
    pub(crate) cell_type: u64,
    /// Ids of the cell's points.
    pub(crate) points: &'a [u64],
    /// Numbers of the cell in the region arrays; 0 without an array.
    pub(crate) region: [i64; 2],
}

impl Cell<'_> {
    /// Visits the cell. Polygons of more than four corners and polylines go to [`MeshVisitor::polygon`] and
    /// [`MeshVisitor::polyline`]; a point set becomes a point element per point.
    ///
    /// # Errors
    /// If the cell is a triangle strip, a volume cell or of higher order, or if its number of points is wrong for its
    /// type.
    pub(crate) fn send(
        &self,
        cursor: &Cursor<'_>,
        visitor: &mut dyn MeshVisitor,
    ) -> Result<(), ReadError> {
        let Cell { id, cell_type, points, region } = *self;
        let kind = kind_of(cursor, id, cell_type, points.len())?;
        if kind.nodes() == points.len() {
            let mut nodes = [0; 4];
            nodes[..points.len()].copy_from_slice(points);
            if cell_type == types::PIXEL {
                // The points of a pixel are in rows, not around the cell.
                nodes.swap(2, 3);
            }
            return visitor.element(cursor, &Element { id, kind, region, nodes });
        }
        match cell_type {
            types::POLY_LINE if points.len() > 2 => visitor.unsupported(POLYLINES),
            types::POLY_VERTEX if points.len() > 1 => {
                visitor.unsupported("sets of points, which become single points");
            }
            _ => {}
        }
        match (kind, cell_type) {
            (CellKind::Polygon, _) => visitor.polygon(cursor, id, region, points),
            (_, types::POLY_LINE) => visitor.polyline(cursor, id, region, points),
            _ => points.iter().try_for_each(|&point| {
                let nodes = [point, 0, 0, 0];
                visitor.element(cursor, &Element { id, kind, region, nodes })
            }),
        }
    }
}

/// Cells from a triangle to the end of a list, whose leading triangles are visited in bulk.
pub(crate) struct Triangles<'a> {
    /// Number of cells, the first triangle and all later cells of the list.
    pub(crate) count: usize,
    /// Point indices of all cells of the list, and the range of the first triangle's indices.
    pub(crate) numbers: &'a IntArray<'a>,
    pub(crate) own: Range<usize>,
    /// End of each cell's indices in `numbers`, from the first triangle on. `None` if each cell starts with its point
    /// count.
    pub(crate) ends: Option<NumberField<'a>>,
    /// Type numbers of the cells, from the first triangle on. `None` if the list has only polygons.
    pub(crate) types: Option<NumberField<'a>>,
    /// Id of the point with the index 0, which is added to each index.
    pub(crate) first: u64,
    /// Exclusive upper bound of the point indices, before `first` is added.
    pub(crate) below: u64,
    /// Region numbers of the cells, from the first triangle on.
    pub(crate) regions: [Region<'a>; 2],
}

impl Triangles<'_> {
    /// Visits triangles in bulk. Returns the number of triangles that the visitor took, and the end of their point
    /// indices in `numbers`.
    pub(crate) fn send(self, visitor: &mut dyn MeshVisitor) -> (usize, usize) {
        let Triangles { count, numbers, own, ends, types, first, below, regions } = self;
        let (stride, counts) = match ends {
            Some(ends) => (3, (ends, FieldRule::Steps { first: own.end as u64, step: 3 })),
            None => match own.start.checked_sub(1) {
                Some(before) => (4, (numbers.field(before, 4), FieldRule::Is(3))),
                None => return (0, own.end),
            },
        };
        let triangles = types.map(|types| (types, FieldRule::Is(types::TRIANGLE)));
        let expected: Vec<_> = [counts].into_iter().chain(triangles).collect();
        let corners = numbers.field(own.start, stride);
        let taken = visitor.triangle_records(&TriangleRecords {
            count,
            nodes: corners,
            min_node: first,
            node_end: below,
            regions,
            required_fields: &expected,
        });
        (taken, own.start + 3 + taken.saturating_sub(1) * stride)
    }
}

/// Limits the bulk visits of a list, which cost time where cell types alternate: ten tries per list. After a try, at
/// least [`MIN_PARALLEL_RECORDS`] cells pass before the next.
pub(crate) struct BulkBackoff {
    left: usize,
    next: usize,
}

impl BulkBackoff {
    pub(crate) const NEW: BulkBackoff = BulkBackoff { left: 10, next: 0 };

    pub(crate) fn is_due(&self, cell: usize) -> bool {
        self.left > 0 && cell >= self.next
    }

    /// Records a try at index `cell`, at which the visitor took `taken` triangles.
    pub(crate) fn done(&mut self, cell: usize, taken: usize) {
        self.left -= 1;
        self.next = cell + taken + MIN_PARALLEL_RECORDS;
    }
}

/// Returns the element kind of a cell with VTK's type number `cell_type`. Empty cells, point sets and polylines are of
/// the kind `Point`, as each of their points is a constraint.
///
/// # Errors
/// If the type cannot be read, or if its cells do not have `points` points.
fn kind_of(
    cursor: &Cursor<'_>,
    id: u64,
    cell_type: u64,
    points: usize,
) -> Result<CellKind, ReadError> {
    let kind = match cell_type {
        types::EMPTY | types::POLY_VERTEX | types::POLY_LINE => return Ok(CellKind::Point),
        types::POLYGON => {
            return Ok(CellKind::of_polygon(points as u64).unwrap_or(CellKind::Polygon));
        }
        types::PIXEL => CellKind::Quadrilateral,
        // DOLFINx gives these types to linear cells too.
        types::LAGRANGE_CURVE | types::BEZIER_CURVE if points == 2 => CellKind::Line,
        types::LAGRANGE_TRIANGLE | types::BEZIER_TRIANGLE if points == 3 => CellKind::Triangle,
        types::LAGRANGE_QUAD | types::BEZIER_QUAD if points == 4 => CellKind::Quadrilateral,
        types::TRIANGLE_STRIP => {
            let problem = format!("cell {id} is a strip of triangles");
            return Err(cursor.error(problem, "Save strips as triangles"));
        }
        number if types::is_of_volume(number) => {
            return Err(volume(cursor, "cells of a volume"));
        }
        number => types::kind_of(number).ok_or_else(|| {
            let problem = format!("cell {id} is of type {number}, not of first order");
            cursor.error(
                problem,
                "Save a mesh of linear triangles (type 5) or quadrilaterals (type 9)",
            )
        })?,
    };
    if points != kind.nodes() {
        let problem = format!("cell {id}, a {}, has {points} points", kind.name());
        return Err(cursor.error(problem, CORRECT));
    }
    Ok(kind)
}
