//! Lists of numbered nodes in text, as grids of coastal models have them.

use crate::error::ReadError;
use crate::file::heights::Heights;
use crate::file::sink::{Sink, each_row};
use crate::file::text::Cursor;

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
            let owner = format_args!("node {tag}");
            let point = cursor.point(owner)?;
            let third = match is_third_optional {
                true => cursor.height_if_any(owner)?,
                false => cursor.height(owner)?,
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
