//! Groups in the files of the mesh generator Triangle: attributes of triangles, and markers of vertices and segments.

use crate::content::label::Label;
use crate::disk::source::Source;
use crate::error::ReadError;
use crate::formats::triangle::mesh::{
    Numbers, Segments, header, rows, vertex_header, vertex_number,
};
use crate::text::token::float;
use crate::visit::group_table::GroupTable;
use crate::visit::sink::Kind;

/// Gathers the groups of a mesh whose files were read before.
pub(crate) fn groups(
    node: &Source,
    ele: &Source,
    poly: Option<&Source>,
) -> Result<GroupTable, ReadError> {
    let mut table = GroupTable::default();
    attributes(ele, &mut table)?;
    let numbers = markers(node, &mut table)?;
    if let Some(poly) = poly {
        segments(poly, node, &numbers, &mut table)?;
    }
    Ok(table)
}

/// Returns the label that a token stands for. If `zero_is_none`, zero stands for no label.
fn label(token: &[u8], zero_is_none: bool) -> Option<Label> {
    match float(token) {
        Some(0.0) if zero_is_none => None,
        Some(number) => Some(Label::number(number)),
        None => Some(Label::name(token)),
    }
}

fn attributes(ele: &Source, table: &mut GroupTable) -> Result<(), ReadError> {
    let cursor = &mut rows(ele);
    header(cursor, "triangles")?;
    let count = cursor.integer("the number of triangles")?;
    cursor.integer_or(3, "the number of vertices per triangle")?;
    let columns = cursor.integer_or(0, "the number of attributes per triangle")?;
    let what = |column: u64| match columns {
        1 => "attribute".to_owned(),
        _ => format!("attribute{}", column + 1),
    };
    // The last token of each column and its group, as the next token is mostly the same.
    let mut last: Vec<(&[u8], usize)> = Vec::new();
    for row in 0..count {
        cursor.row(row, count, "triangles")?;
        cursor.tokens(4);
        for column in 0..columns {
            let Some(token) = cursor.token() else { break };
            let at = column as usize;
            if last.get(at).is_none_or(|(before, _)| *before != token) {
                let Some(label) = label(token, false) else { break };
                let group = table.number(&what(column), 2, &label);
                last.truncate(at);
                last.push((token, group));
            }
            table.add_triangle(last[at].1, row as u32);
        }
    }
    Ok(())
}

/// Gathers the markers of vertices. Returns how vertices are numbered.
fn markers(node: &Source, table: &mut GroupTable) -> Result<Numbers, ReadError> {
    let cursor = &mut rows(node);
    let mut numbers = Numbers { first: 0, count: vertex_header(cursor)? };
    let attributes = cursor.integer_or(0, "the number of attributes per vertex")?;
    let marked = cursor.integer_or(0, "whether vertices have markers")? != 0;
    for row in 0..numbers.count {
        vertex_number(cursor, row, &mut numbers)?;
        if !marked {
            // The first number tells how all are numbered.
            break;
        }
        cursor.tokens(attributes.saturating_add(2));
        if let Some(label) = cursor.token().and_then(|token| label(token, true)) {
            let group = table.number("marker", 0, &label);
            table.add_vertex(group, row as u32);
        }
    }
    Ok(numbers)
}

fn segments(
    poly: &Source,
    node: &Source,
    numbers: &Numbers,
    table: &mut GroupTable,
) -> Result<(), ReadError> {
    let mut segments = Segments::new(poly, node, numbers)?;
    if segments.cursor.integer_or(0, "whether segments have markers")? == 0 {
        return Ok(());
    }
    for row in 0..segments.count {
        let (_, vertices) = segments.segment(row)?;
        if let Some(label) = segments.cursor.token().and_then(|token| label(token, true)) {
            let group = table.number("marker", 1, &label);
            table.add(group, Kind::Line, &vertices);
        }
    }
    Ok(())
}
