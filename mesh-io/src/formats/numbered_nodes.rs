//! Reads lists of nodes in text files: nodes with ids, as in grids of coastal models, or nodes counted from 0.

use crate::error::ReadError;
use crate::text::cursor::Cursor;
use crate::text::cursor_numbers::NO_Z;
use crate::visit::rows::each_row;
use crate::visit::visitor::MeshVisitor;
use crate::visit::z_values::ZValues;

/// Visits a list of nodes. Each row has the id, x, y, and a third coordinate or depth, which may be missing if
/// `is_third_optional`. Returns the third coordinates or depths.
pub(crate) fn numbered_nodes(
    cursor: &mut Cursor<'_>,
    count: u64,
    is_third_optional: bool,
    visitor: &mut dyn MeshVisitor,
) -> Result<ZValues, ReadError> {
    visitor.expect_nodes(cursor.capacity(count, "1 0 0\n".len()));
    let mut z_values = ZValues::new(visitor);
    each_row(
        cursor,
        count,
        "nodes",
        visitor,
        |cursor| {
            let id = cursor.integer("the number of a node")?;
            let point = cursor.point(format_args!("node {id}"))?;
            let third = match is_third_optional {
                true => cursor.z_if_any(format_args!("node {id}"))?,
                false => cursor.z(format_args!("node {id}"))?,
            };
            Ok((id, point, third))
        },
        |cursor, visitor, _, (id, (x_at, at), third)| {
            visitor.node(cursor, id, 2, x_at, at);
            z_values.push(third);
            Ok(())
        },
    )?;
    Ok(z_values)
}

/// Words for the nodes of a format, for messages.
#[derive(Clone, Copy)]
pub(crate) struct NodeNames {
    /// A single node, with its article.
    pub(crate) one: &'static str,
    pub(crate) all: &'static str,
}

/// Visits a list of nodes without ids, which are counted from 0. Each row has two or three coordinates, as `dimensions`
/// says. Returns the third coordinates.
///
/// # Errors
/// If `dimensions` is neither 2 nor 3, or if a node cannot be read.
pub(crate) fn counted_nodes(
    cursor: &mut Cursor<'_>,
    count: u64,
    dimensions: u64,
    names: NodeNames,
    visitor: &mut dyn MeshVisitor,
) -> Result<ZValues, ReadError> {
    let NodeNames { one, all } = names;
    if !(2..=3).contains(&dimensions) {
        let problem = format!("the {all} have {dimensions} coordinates");
        return Err(cursor.error(problem, "Those of 2 and 3 coordinates are read"));
    }
    visitor.expect_nodes(cursor.capacity(count, "0 0\n".len()));
    let mut z_values = ZValues::new(visitor);
    each_row(
        cursor,
        count,
        all,
        visitor,
        |cursor| {
            let point = cursor.point(one)?;
            Ok((point, if dimensions == 3 { cursor.z(one)? } else { NO_Z }))
        },
        |cursor, visitor, index, ((x_at, at), z)| {
            visitor.node(cursor, index, 2, x_at, at);
            z_values.push(z);
            Ok(())
        },
    )?;
    Ok(z_values)
}
