//! gmsh's element types.

use crate::error::ReadError;
use crate::text::cursor::Cursor;
use crate::visit::items::CellKind;

/// Returns the kind of an element by gmsh's type number.
///
/// # Errors
/// At the cursor's line, if the type belongs to a volume, is of higher order, or is unknown.
pub(super) fn kind_of(cursor: &Cursor<'_>, number: u64) -> Result<CellKind, ReadError> {
    match number {
        15 => Ok(CellKind::Point),
        1 => Ok(CellKind::Line),
        2 => Ok(CellKind::Triangle),
        3 => Ok(CellKind::Quadrilateral),
        _ => Err(refusal(cursor, number)),
    }
}

#[cold]
fn refusal(cursor: &Cursor<'_>, number: u64) -> ReadError {
    match number {
        4..=7 | 11..=14 | 17..=19 | 29..=33 | 35 => cursor.error(
            format!("element type {number} makes this a volume mesh"),
            "Save a mesh of the plane only (gmsh -2)",
        ),
        8..=10 | 16 | 20..=28 | 36..=66 => cursor.error(
            format!("element type {number} is of higher order, which is not read"),
            "Make the mesh of first order (Mesh.ElementOrder=1)",
        ),
        _ => cursor.error(
            format!("element type {number} is not known"),
            "Save points, lines, triangles and quadrilaterals only",
        ),
    }
}

/// Reads the node tags at the end of an element's row. Array entries beyond the kind's node count are 0.
#[inline]
pub(super) fn node_tags(
    cursor: &mut Cursor<'_>,
    kind: CellKind,
    tag: u64,
) -> Result<[u64; 4], ReadError> {
    let mut tags = [0; 4];
    for node in &mut tags[..kind.nodes()] {
        *node = cursor.integer(format_args!("a node of element {tag}"))?;
    }
    Ok(tags)
}
