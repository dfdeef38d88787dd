//! The sections of version 2.2: one line per node and per element.

use super::super::text::Cursor;
use super::kind::{Kind, node_tags};
use super::{Sink, row};
use crate::error::ReadError;

/// Reads `$Nodes` after its first line. Returns their number.
pub(super) fn nodes(cursor: &mut Cursor<'_>, sink: &mut impl Sink) -> Result<u64, ReadError> {
    row(cursor, 0, 1, "counts")?;
    let count = cursor.vertex_count()?;
    sink.expect_nodes(cursor.capacity(count, "1 0 0 0\n".len()));
    for done in 0..count {
        row(cursor, done, count, "nodes")?;
        let tag = cursor.integer("a node tag")?;
        let owner = format_args!("node {tag}");
        let (x_at, at) = cursor.point(owner)?;
        // z is kept, but that the row holds it shows that it is whole.
        cursor.coordinate('z', owner)?;
        sink.node(cursor, tag, 2, x_at, at);
    }
    Ok(count)
}

/// Reads `$Elements` after its first line. Returns their number.
pub(super) fn elements(cursor: &mut Cursor<'_>, sink: &mut impl Sink) -> Result<u64, ReadError> {
    row(cursor, 0, 1, "counts")?;
    let count = cursor.integer("the number of elements")?;
    sink.expect_elements(cursor.capacity(count, "1 2 0 1 2 3\n".len()));
    for done in 0..count {
        row(cursor, done, count, "elements")?;
        let tag = cursor.integer("an element tag")?;
        let kind = cursor.integer(format_args!("the type of element {tag}"))?;
        let kind = Kind::new(cursor, kind)?;
        let groups = cursor.integer(format_args!("the number of tags of element {tag}"))?;
        for _ in 0..groups {
            if cursor.token().is_none() {
                let problem =
                    format!("element {tag} announces {groups} tags, and its line is shorter");
                return Err(cursor.error(problem, super::super::text::CORRECT));
            }
        }
        let mut tags = [0; 4];
        let tags = node_tags(cursor, kind, tag, &mut tags)?;
        sink.element(cursor, tag, kind, tags)?;
    }
    Ok(count)
}
