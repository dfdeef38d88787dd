//! Lists of nodes in text, with numbers of their own, as in grids of coastal models, or without.

use crate::error::ReadError;
use crate::text::cursor::Cursor;
use crate::text::cursor_numbers::NO_HEIGHT;
use crate::visit::heights::Heights;
use crate::visit::rows::each_row;
use crate::visit::sink::Sink;

/// Reads a list of nodes, each a number, x, y and a third coordinate or depth, and hands them to the sink. Returns the
/// third numbers. If these are optional, a node may end after y.
pub(crate) fn numbered_nodes(
    cursor: &mut Cursor<'_>,
    count: u64,
    is_third_optional: bool,
    sink: &mut dyn Sink,
) -> Result<Heights, ReadError> {
    sink.expect_nodes(cursor.capacity(count, "1 0 0\n".len()));
    let mut heights = Heights::new(sink);
    each_row(
        cursor,
        count,
        "nodes",
        sink,
        |cursor| {
            let tag = cursor.integer("the number of a node")?;
            let point = cursor.point(format_args!("node {tag}"))?;
            let third = match is_third_optional {
                true => cursor.height_if_any(format_args!("node {tag}"))?,
                false => cursor.height(format_args!("node {tag}"))?,
            };
            Ok((tag, point, third))
        },
        |cursor, sink, _, (tag, (x_at, at), third)| {
            sink.node(cursor, tag, 2, x_at, at);
            heights.see(third);
            Ok(())
        },
    )?;
    Ok(heights)
}

/// What nodes are called in messages.
#[derive(Clone, Copy)]
pub(crate) struct Names {
    /// A single node, with its article.
    pub(crate) one: &'static str,
    pub(crate) all: &'static str,
}

/// Reads a list of nodes of two or three coordinates each, counted from zero, and hands them to the sink. Returns the third
/// coordinates.
pub(crate) fn counted_nodes(
    cursor: &mut Cursor<'_>,
    count: u64,
    dimensions: u64,
    names: Names,
    sink: &mut dyn Sink,
) -> Result<Heights, ReadError> {
    let Names { one, all } = names;
    if !(2..=3).contains(&dimensions) {
        let problem = format!("the {all} have {dimensions} coordinates");
        return Err(cursor.error(problem, "Those of 2 and 3 coordinates are read"));
    }
    sink.expect_nodes(cursor.capacity(count, "0 0\n".len()));
    let mut heights = Heights::new(sink);
    each_row(
        cursor,
        count,
        all,
        sink,
        |cursor| {
            let point = cursor.point(one)?;
            Ok((point, if dimensions == 3 { cursor.height(one)? } else { NO_HEIGHT }))
        },
        |cursor, sink, index, ((x_at, at), z)| {
            sink.node(cursor, index, 2, x_at, at);
            heights.see(z);
            Ok(())
        },
    )?;
    Ok(heights)
}
