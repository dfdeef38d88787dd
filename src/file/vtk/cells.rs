//! Cells of VTK by their types.

use crate::error::ReadError;
use crate::file::sink::{Element, Kind, Sink, volume};
use crate::file::text::{CORRECT, Cursor};

/// A cell, as VTK's formats have it.
pub(in crate::file) struct Cell<'a> {
    /// Its position.
    pub(in crate::file) tag: u64,
    /// The number of its type in VTK.
    pub(in crate::file) cell_type: u64,
    pub(in crate::file) points: &'a [u64],
    pub(in crate::file) region: [i64; 2],
}

impl Cell<'_> {
    /// Hands the cell to the sink. Of cells that are neither triangles nor have a kind of their own, such as polylines and
    /// polygons of more corners, the points stay fixed.
    pub(in crate::file) fn send(
        &self,
        cursor: &Cursor<'_>,
        sink: &mut dyn Sink,
    ) -> Result<(), ReadError> {
        let Cell { tag, cell_type, points, region } = *self;
        let kind = kind_of(cursor, tag, cell_type, points.len())?;
        if kind.nodes() == points.len() {
            let mut nodes = [0; 4];
            nodes[..points.len()].copy_from_slice(points);
            return sink.element(cursor, &Element { tag, kind, region, nodes });
        }
        match (kind, cell_type) {
            (Kind::Corner, _) => sink.polygon(cursor, (tag, region), points),
            (_, 4) => sink.polyline(cursor, (tag, region), points),
            _ => points.iter().try_for_each(|&point| {
                let nodes = [point, 0, 0, 0];
                sink.element(cursor, &Element { tag, kind, region, nodes })
            }),
        }
    }
}

/// The kind of a cell by its type in VTK. It is that of a single vertex for cells of any number of points, which only
/// are to stay fixed.
fn kind_of(
    cursor: &Cursor<'_>,
    tag: u64,
    cell_type: u64,
    points: usize,
) -> Result<Kind, ReadError> {
    let kind = match cell_type {
        0 | 2 | 4 => return Ok(Kind::Point),
        7 => return Ok(Kind::of_polygon(points as u64).unwrap_or(Kind::Corner)),
        1 => Kind::Point,
        3 => Kind::Line,
        5 => Kind::Triangle,
        8 | 9 => Kind::Quadrilateral,
        10..=16 | 41..=42 => return Err(volume(cursor, "cells of a volume")),
        6 => {
            let problem = format!("cell {tag} is a strip of triangles");
            return Err(cursor.error(problem, "Save strips as triangles"));
        }
        _ => {
            let problem = format!("cell {tag} is of type {cell_type}, not of first order");
            return Err(cursor.error(problem, "Save a mesh of linear triangles (type 5)"));
        }
    };
    if points != kind.nodes() {
        let problem = format!("cell {tag}, a {}, has {points} points", kind.name());
        return Err(cursor.error(problem, CORRECT));
    }
    Ok(kind)
}
