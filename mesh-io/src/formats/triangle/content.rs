//! Describes a mesh of the mesh generator Triangle, whose files were read before.

use crate::content::label::Label;
use crate::disk::source::Source;
use crate::error::ReadError;
use crate::export::collector::Collector;
use crate::export::content::Content;
use crate::formats::triangle::mesh::{
    Numbers, Segments, attribute_names, header, rows, vertex_header, vertex_number,
};
use crate::precision::Precision;
use crate::text::token::float;
use crate::visit::heights::TextNumbers;
use crate::visit::sink::{Column, Element, Kind, Sink};

/// Reads the description of a mesh from its files.
pub(crate) fn content(
    node: &Source,
    ele: &Source,
    poly: Option<&Source>,
) -> Result<Content, ReadError> {
    let mut sink = Collector::default();
    let numbers = vertices(node, &mut sink)?;
    triangles(ele, node, &numbers, &mut sink)?;
    if let Some(poly) = poly {
        segments(poly, node, &numbers, &mut sink)?;
    }
    Ok(sink.finish())
}

fn vertices(node: &Source, sink: &mut Collector) -> Result<Numbers, ReadError> {
    let cursor = &mut rows(node);
    let mut numbers = Numbers { first: 0, count: vertex_header(cursor)? };
    let attributes = cursor.integer_or(0, "the number of attributes per vertex").unwrap_or(0);
    let attributes = cursor.capacity(attributes, 1) as u64;
    let marked = cursor.integer_or(0, "whether vertices have markers").unwrap_or(0) != 0;
    let before = cursor.clone();
    for row in 0..numbers.count {
        let number = vertex_number(cursor, row, &mut numbers)?;
        let (x_at, at) = cursor.point("a vertex")?;
        sink.node(cursor, number, 2, x_at, at);
        cursor.tokens(attributes);
        let marker = if marked { cursor.token().and_then(float) } else { None };
        if let Some(marker) = marker.filter(|&marker| marker != 0.0) {
            sink.node_within(row as u32, "marker", marker as i64);
        }
    }
    sink.end_nodes(cursor)?;
    for (column, name) in attribute_names(attributes).enumerate() {
        let mut values = TextNumbers::default();
        values.column(before.clone(), numbers.count, 3 + column as u64)?;
        sink.point_array(name.as_bytes(), 1, true);
        sink.point_numbers(values.finish(Precision::Double, None));
    }
    Ok(numbers)
}

/// Makes a column of real numbers, which are handed on as their bits.
fn column(what: &str, zero_is_none: bool) -> Column {
    let label: fn(i64) -> Option<Label> = match zero_is_none {
        true => |bits| {
            let number = f64::from_bits(bits.cast_unsigned());
            (number != 0.0).then(|| Label::number(number))
        },
        false => |bits| Some(Label::number(f64::from_bits(bits.cast_unsigned()))),
    };
    Column { what: what.into(), from_dimension: 1, label }
}

fn bits(token: Option<&[u8]>) -> i64 {
    // Adding zero makes a negative zero positive.
    (token.and_then(float).unwrap_or(0.0) + 0.0).to_bits().cast_signed()
}

fn triangles(
    ele: &Source,
    node: &Source,
    numbers: &Numbers,
    sink: &mut Collector,
) -> Result<(), ReadError> {
    let cursor = &mut rows(ele);
    header(cursor, "triangles")?;
    let count = cursor.integer("the number of triangles")?;
    cursor.integer_or(3, "the number of vertices per triangle")?;
    let columns = cursor.integer_or(0, "the number of attributes per triangle")?;
    let names: &[&str] = match columns {
        0 => &[],
        1 => &["attribute"],
        _ => &["attribute1", "attribute2"],
    };
    if columns > 2 {
        sink.leaves_out("all but two attributes of triangles");
    }
    sink.columns(names.iter().map(|name| column(name, false)).collect());
    for done in 0..count {
        cursor.row(done, count, "triangles")?;
        let tag = cursor.integer("the number of a triangle")?;
        let mut nodes = [0; 4];
        for node_of in &mut nodes[..3] {
            let index = numbers.index(cursor, node, format_args!("triangle {tag}"))?;
            *node_of = u64::from(index) + numbers.first;
        }
        let mut region = [0; 2];
        region.iter_mut().take(names.len()).for_each(|number| *number = bits(cursor.token()));
        sink.element(cursor, &Element { tag, kind: Kind::Triangle, region, nodes })?;
    }
    Ok(())
}

fn segments(
    poly: &Source,
    node: &Source,
    numbers: &Numbers,
    sink: &mut Collector,
) -> Result<(), ReadError> {
    let mut segments = Segments::new(poly, node, numbers)?;
    segments.cursor.integer_or(0, "whether segments have markers")?;
    sink.columns(vec![column("marker", true)]);
    for row in 0..segments.count {
        let (tag, vertices) = segments.segment(row)?;
        let [a, b] = vertices.map(|vertex| u64::from(vertex) + numbers.first);
        let region = [bits(segments.cursor.token()), 0];
        let element = Element { tag, kind: Kind::Line, region, nodes: [a, b, 0, 0] };
        sink.element(&segments.cursor, &element)?;
    }
    // Holes and regions matter only to the mesh generator.
    let cursor = &mut segments.cursor;
    if cursor.next_row() && cursor.integer("the number of holes").is_ok_and(|holes| holes > 0) {
        sink.leaves_out("holes of the .poly");
    }
    Ok(())
}
