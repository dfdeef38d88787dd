//! Cells of VTK, by the numbers of their types.

use crate::binary::int_array::IntArray;
use crate::binary::number_field::NumberField;
use crate::error::ReadError;
use crate::formats::vtk::types;
use crate::text::cursor::{CORRECT, Cursor};
use crate::visit::items::{CellKind, Element};
use crate::visit::records::{FieldRule, MIN_PARALLEL_RECORDS, Region, TriangleRecords};
use crate::visit::rows::volume;
use crate::visit::visitor::MeshVisitor;
use std::ops::Range;

/// A cell of one of VTK's formats.
#[derive(Clone, Copy)]
pub(crate) struct Cell<'a> {
    /// The position of the cell in the file.
    pub(crate) id: u64,
    /// VTK's number for the type of the cell.
    pub(crate) cell_type: u64,
    pub(crate) points: &'a [u64],
    pub(crate) region: [i64; 2],
}

impl Cell<'_> {
    /// Hands the cell to the visitor. The points of cells without a kind of their own, such as polylines and polygons of
    /// more than four corners, stay fixed.
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
            return visitor.element(cursor, &Element { id, kind, region, nodes });
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

/// The cells from a triangle on. Those up to the next cell of another kind are handed on at once.
pub(crate) struct Triangles<'a> {
    /// How many cells there are from the first triangle on.
    pub(crate) count: usize,
    /// The points of all cells, and the range of the first triangle's points.
    pub(crate) numbers: &'a IntArray<'a>,
    pub(crate) own: Range<usize>,
    /// The ends of the cells' points, from the first triangle on. `None` if each cell's number of points stands before
    /// its points.
    pub(crate) ends: Option<NumberField<'a>>,
    /// The types of the cells from the first triangle on. `None` if all are polygons.
    pub(crate) types: Option<NumberField<'a>>,
    /// The number that is added to each point.
    pub(crate) first: u64,
    /// The bound that each point must be less than.
    pub(crate) below: u64,
    pub(crate) regions: [Region<'a>; 2],
}

impl Triangles<'_> {
    /// Hands on triangles. Returns how many the visitor has taken, and where the points of the last one end.
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

/// Decides at which cells triangles are visited in bulk: at most ten times, and not again among the
/// [`MIN_PARALLEL_RECORDS`] cells after the last time.
pub(crate) struct BulkBackoff {
    left: usize,
    next: usize,
}

impl BulkBackoff {
    pub(crate) const NEW: BulkBackoff = BulkBackoff { left: 10, next: 0 };

    pub(crate) fn is_due(&self, cell: usize) -> bool {
        self.left > 0 && cell >= self.next
    }

    /// Records a try at a cell, and how many triangles were handed on.
    pub(crate) fn done(&mut self, cell: usize, taken: usize) {
        self.left -= 1;
        self.next = cell + taken + MIN_PARALLEL_RECORDS;
    }
}

/// Returns the kind of a cell by VTK's number of its type. For cells of any number of points that stay fixed, it is
/// that of a single point.
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
        types::TRIANGLE_STRIP => {
            let problem = format!("cell {id} is a strip of triangles");
            return Err(cursor.error(problem, "Save strips as triangles"));
        }
        number if types::is_of_volume(number) => {
            return Err(volume(cursor, "cells of a volume"));
        }
        number => types::kind_of(number).ok_or_else(|| {
            let problem = format!("cell {id} is of type {number}, not of first order");
            cursor.error(problem, "Save a mesh of linear triangles (type 5)")
        })?,
    };
    if points != kind.nodes() {
        let problem = format!("cell {id}, a {}, has {points} points", kind.name());
        return Err(cursor.error(problem, CORRECT));
    }
    Ok(kind)
}
