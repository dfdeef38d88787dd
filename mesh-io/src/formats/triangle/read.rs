//! Reads Triangle's `.node` and `.ele`, with the segments of a `.poly` if there is one.
//!
//! The formats: <https://www.cs.cmu.edu/~quake/triangle.html>. Like Triangle itself, this reader ignores text after the
//! announced rows and columns, but refuses further vertices and triangles.

use crate::content::group_label::GroupLabel;
use crate::content::regions::Interner;
use crate::content::remark::Remark;
use crate::disk::source::Source;
use crate::edit::numbers::CoordinateEncoding;
use crate::error::{ReadError, WriteError};
use crate::format::Format;
use crate::formats::triangle::files;
use crate::formats::triangle::rows::{VertexNumbering, header, rows, vertex_header};
use crate::formats::triangle::segments::{Segments, listed_vertices};
use crate::precision::Precision;
use crate::text::cursor::{CORRECT, Cursor};
use crate::text::token::float;
use crate::visit::items::{CellKind, Element, GroupScope};
use crate::visit::reader::FormatReader;
use crate::visit::rows::{each_row, end_of_list};
use crate::visit::storage::CoordinateStorage;
use crate::visit::visitor::MeshVisitor;
use crate::visit::z_values::{TextNumbers, ZValues};
use std::path::{Path, PathBuf};

/// The reader of Triangle meshes. The source is the `.node`; its companions are the `.ele` and the optional `.poly`.
pub(crate) struct Triangle;

impl FormatReader for Triangle {
    const VERTICES: &'static str = "the .node";
    const NAMES_OTHER_LINES: bool = false;

    fn load_companions(given: Source) -> Result<Source, ReadError> {
        files::load_companions(given)
    }

    fn require_single(source: &Source) -> Result<(), ReadError> {
        files::require_single(source)
    }

    fn destinations(node: &Source, path: &Path) -> Result<Vec<PathBuf>, WriteError> {
        files::destinations(node, path)
    }

    fn visit(node: &Source, visitor: &mut dyn MeshVisitor) -> Result<CoordinateStorage, ReadError> {
        let mut others = node.companions.iter().map(|companion| &companion.source);
        let (ele, poly) = (others.next().unwrap_or(node), others.next());
        let vertices = Vertices::read(node, poly, visitor)?;
        triangles(ele, node, &vertices.numbers, visitor)?;
        vertices.send_markers(visitor)?;
        if let Some(poly) = poly {
            segments(poly, node, &vertices.numbers, visitor)?;
        }
        Ok(CoordinateStorage::in_place(Format::Triangle, CoordinateEncoding::TEXT))
    }
}

/// The list of vertices of a `.node`.
struct Vertices<'s> {
    numbers: VertexNumbering,
    /// Number of coordinates plus number of attributes of a vertex.
    columns: u64,
    has_markers: bool,
    /// The cursor before the first vertex.
    before: Cursor<'s>,
}

impl<'s> Vertices<'s> {
    /// Reads the list, and hands vertices and attributes to the visitor.
    fn read(
        node: &'s Source,
        poly: Option<&Source>,
        visitor: &mut dyn MeshVisitor,
    ) -> Result<Self, ReadError> {
        let cursor = &mut rows(node);
        let (count, coordinates) = vertex_header(cursor)?;
        if count == 0 {
            return Err(cursor.error("no vertices are announced", "Write the mesh again"));
        }
        // A wrong number in the header must not prevent the vertices from being read.
        let attributes = cursor.integer_or(0, "the number of attributes per vertex").unwrap_or(0);
        // A row cannot hold more attributes than the file has bytes.
        let attributes = cursor.capacity(attributes, 1) as u64;
        let columns = coordinates + attributes;
        let has_markers = cursor.integer_or(0, "whether vertices have markers").unwrap_or(0) != 0;
        let before = cursor.clone();
        visitor.expect_nodes(cursor.capacity(count, "1 0 0\n".len()));
        let listed = poly.map_or(0, listed_vertices);
        let mut numbers = VertexNumbering { first: 0, count };
        if !visitor.asks_for_nodes() {
            // The first row has the number from which vertices are counted.
            if cursor.next_row() {
                numbers.first = cursor.integer("the number of a vertex")?;
            }
            return Ok(Vertices { numbers, columns, has_markers, before });
        }
        let read = |cursor: &mut Cursor<'_>| {
            let number = cursor.integer("the number of a vertex")?;
            let owner = format_args!("vertex {number}");
            let point = cursor.point(owner)?;
            Ok((number, point, if coordinates == 3 { Some(cursor.z(owner)?) } else { None }))
        };
        let mut z_values = ZValues::new(visitor);
        each_row(cursor, count, "vertices", visitor, read, |cursor, visitor, row, vertex| {
            let (number, (x_at, at), z) = vertex;
            numbers.check(cursor, row, number)?;
            // A vertex of the outline is a point of the model, which has the dimension 0.
            let dimension = if row < listed { 0 } else { 2 };
            visitor.node(cursor, number, dimension, x_at, at);
            z.into_iter().for_each(|z| z_values.push(z));
            Ok(())
        })?;
        end_of_list(cursor, count, "vertices", read)?;
        visitor.end_nodes(cursor)?;
        z_values.send("z", CoordinateEncoding::TEXT.into(), visitor);
        for (column, name) in
            (0..attributes).map(|column| (column, column_name(column, attributes)))
        {
            if visitor.point_array(name.as_bytes(), 1, true) {
                let mut values = TextNumbers::default();
                values.column(before.clone(), count, 1 + coordinates + column)?;
                visitor.point_numbers(values.finish(Precision::Double, None));
            }
        }
        Ok(Vertices { numbers, columns, has_markers, before })
    }

    /// Hands the markers of vertices to a visitor that asks for groups.
    fn send_markers(&self, visitor: &mut dyn MeshVisitor) -> Result<(), ReadError> {
        if !self.has_markers || !visitor.asks_for_groups() {
            return Ok(());
        }
        let read = |cursor: &mut Cursor<'_>| {
            cursor.tokens(self.columns.saturating_add(1));
            Ok(cursor.token().and_then(marker))
        };
        let cursor = &mut self.before.clone();
        each_row(cursor, self.numbers.count, "vertices", visitor, read, |_, visitor, row, label| {
            if let Some(label) = label {
                visitor.node_group(row as u32, "marker", &label);
            }
            Ok(())
        })
    }
}

/// Returns the name of the attribute in a 0-based column: `attribute` for a single column, else `attribute1`,
/// `attribute2` and so on.
fn column_name(column: u64, columns: u64) -> String {
    match columns {
        1 => "attribute".to_owned(),
        _ => format!("attribute{}", column + 1),
    }
}

/// Returns the group label of an attribute: numeric labels for numbers, names for other tokens.
fn attribute(token: &[u8]) -> GroupLabel {
    float(token).map_or_else(|| GroupLabel::name(token), GroupLabel::number)
}

/// Returns the group label of a marker; `None` for zero, which means no marker.
fn marker(token: &[u8]) -> Option<GroupLabel> {
    (float(token) != Some(0.0)).then(|| attribute(token))
}

/// Visits the triangles of an `.ele`, with the region and the groups of their attributes.
fn triangles(
    ele: &Source,
    node: &Source,
    numbers: &VertexNumbering,
    visitor: &mut dyn MeshVisitor,
) -> Result<(), ReadError> {
    let cursor = &mut rows(ele);
    header(cursor, "triangles")?;
    let count = cursor.integer("the number of triangles")?;
    match cursor.integer_or(3, "the number of vertices per triangle")? {
        3 => {}
        6 => {
            let problem = "the triangles have 6 nodes, and mid-side nodes are not read";
            return Err(cursor.error(problem, "Make the mesh with 3-node triangles (without -o2)"));
        }
        4 => {
            let problem = "the elements have 4 nodes: tetrahedra";
            return Err(cursor.error(problem, "Only triangles of the plane are read"));
        }
        other => {
            let problem = format!("the triangles have {other} nodes");
            return Err(cursor.error(problem, "Make the mesh with 3-node triangles"));
        }
    }
    let columns = cursor.integer_or(0, "the number of attributes per triangle")?;
    // A row may lack attributes, but no row is longer than the file. Each attribute takes a blank and a character.
    if columns > cursor.capacity(columns, " 1".len()) as u64 {
        let problem = format!("{columns} attributes per triangle do not fit in the file");
        return Err(cursor.error(problem, CORRECT));
    }
    visitor.expect_elements(cursor.capacity(count, "1 1 2 3\n".len()));
    let mut attributes = Attributes { columns, ..Attributes::default() };
    let read = |cursor: &mut _| triangle(cursor, node, numbers, columns);
    each_row(cursor, count, "triangles", visitor, read, |cursor, visitor, _, triangle| {
        let (tag, [a, b, c], text) = triangle;
        let region = attributes.region(text, visitor);
        visitor.element(
            cursor,
            &Element { id: tag, kind: CellKind::Triangle, region, nodes: [a, b, c, 0] },
        )
    })?;
    visitor.group_scopes(&[]);
    end_of_list(cursor, count, "triangles", read)
}

/// Reads a triangle's row. Returns the triangle's number, its vertices, and the text of its attributes, which are
/// `columns` tokens.
#[inline]
fn triangle<'a>(
    cursor: &mut Cursor<'a>,
    node: &Source,
    numbers: &VertexNumbering,
    columns: u64,
) -> Result<(u64, [u64; 3], &'a [u8]), ReadError> {
    let number = cursor.integer("the number of a triangle")?;
    let mut corners = [0; 3];
    for corner in &mut corners {
        *corner = numbers.vertex(cursor, node, format_args!("triangle {number}"))?;
    }
    let [a, b, c] = corners;
    if a == b || b == c || c == a {
        let twice = if b == c { b } else { a };
        let problem = format!("triangle {number} lists vertex {twice} twice");
        return Err(cursor.error(problem, "Remove the triangle, or correct its vertices"));
    }
    Ok((number, corners, cursor.tokens(columns)))
}

/// Numbers the attributes: triangles with equal attributes belong to one region.
#[derive(Default)]
struct Attributes<'a> {
    /// The number of attributes of each triangle.
    columns: u64,
    texts: Interner<&'a [u8]>,
    /// The region of each attribute text, by the text's number in `texts`: the number of the first attribute, and a
    /// number for all further attributes.
    regions: Vec<[i64; 2]>,
    names: Interner<String>,
    /// The attribute text of the last triangle, whose groups the visitor has, and its region.
    last: Option<(&'a [u8], [i64; 2])>,
}

impl<'a> Attributes<'a> {
    /// Returns the region of triangles with these attributes, and hands their groups to a visitor that asks for groups.
    #[inline]
    fn region(&mut self, text: &'a [u8], visitor: &mut dyn MeshVisitor) -> [i64; 2] {
        match self.last {
            Some((last, region)) if last == text => region,
            _ => self.next_region(text, visitor),
        }
    }

    fn next_region(&mut self, text: &'a [u8], visitor: &mut dyn MeshVisitor) -> [i64; 2] {
        if self.columns > 0 && visitor.asks_for_groups() {
            self.send_groups(text, visitor);
        }
        let region = self.number(text);
        self.last = Some((text, region));
        region
    }

    #[inline]
    fn number(&mut self, text: &'a [u8]) -> [i64; 2] {
        let number = self.texts.intern(text) as usize;
        if number == self.regions.len() {
            let mut all = tokens(text);
            let parts = [normalized(all.next().into_iter()), normalized(all)];
            self.regions.push(parts.map(|part| i64::from(self.names.intern(part))));
        }
        self.regions[number]
    }

    fn send_groups(&self, text: &[u8], visitor: &mut dyn MeshVisitor) {
        // Rows may have fewer attributes than the header announces, so tokens are counted, not columns.
        let groups: Vec<(String, GroupLabel)> = (0..self.columns)
            .zip(tokens(text))
            .map(|(column, token)| (column_name(column, self.columns), attribute(token)))
            .collect();
        let groups: Vec<GroupScope<'_>> = groups
            .iter()
            .map(|(kind, label)| GroupScope { kind, label: label.clone(), dimension: None })
            .collect();
        visitor.group_scopes(&groups);
    }
}

/// Splits the text of attributes into tokens, at blanks and commas.
fn tokens(text: &[u8]) -> impl Iterator<Item = &[u8]> {
    let is_between = |&byte: &u8| byte <= b' ' || byte == b',';
    text.split(is_between).filter(|token| !token.is_empty())
}

/// Normalizes the tokens of attributes, so that equal numbers have equal texts.
fn normalized<'a>(attributes: impl Iterator<Item = &'a [u8]>) -> String {
    let normalized = attributes.map(|token| match float(token) {
        // Adding zero makes a negative zero positive.
        Some(number) => format!("{:?} ", number + 0.0),
        None => format!("{} ", String::from_utf8_lossy(token)),
    });
    normalized.collect()
}

/// Visits the segments of a `.poly` as lines, with their markers as groups.
fn segments(
    poly: &Source,
    node: &Source,
    numbers: &VertexNumbering,
    visitor: &mut dyn MeshVisitor,
) -> Result<(), ReadError> {
    let mut segments = Segments::new(poly, node, numbers)?;
    let has_markers = visitor.asks_for_groups()
        && segments.cursor.integer_or(0, "whether segments have markers")? != 0;
    let mut last = None;
    for row in 0..segments.count {
        let (tag, [a, b]) = segments.segment(row)?;
        let label = segments.cursor.token().filter(|_| has_markers).and_then(marker);
        if label != last {
            let within = label.iter().map(|label| GroupScope {
                kind: "marker",
                label: label.clone(),
                dimension: None,
            });
            visitor.group_scopes(&within.collect::<Vec<_>>());
            last = label;
        }
        let nodes = [a, b, 0, 0];
        let element = Element { id: tag, kind: CellKind::Line, region: [0; 2], nodes };
        visitor.element(&segments.cursor, &element)?;
    }
    visitor.group_scopes(&[]);
    visitor.remark(Remark::elements(segments.count, "segment", &format!(" of {}", poly.name())));
    // Holes and regions matter only to the mesh generator. Files without regions end behind the holes.
    let cursor = &mut segments.cursor;
    for (counted, told) in [
        ("the number of holes", "holes of the .poly"),
        ("the number of regions", "region points of the .poly"),
    ] {
        let count = if cursor.next_row() { cursor.integer(counted).unwrap_or(0) } else { 0 };
        if count > 0 {
            visitor.unsupported(told);
        }
        if !(0..count).all(|_| cursor.next_row()) {
            break;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn attributes_are_numbers_however_they_are_written() {
        let mut attributes = Attributes::default();
        let texts = ["1 2", "1.0\t 2e0", "2 1", "1", "0", "-0.0", "land", "sea", "+1 2", "land"];
        let mut regions = Interner::default();
        let regions = texts.map(|text| regions.intern(attributes.number(text.as_bytes())));
        assert_eq!(regions, [0, 0, 1, 2, 3, 3, 4, 5, 0, 4]);
    }
}
