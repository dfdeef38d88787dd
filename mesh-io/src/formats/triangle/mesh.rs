//! Triangle's `.node` and `.ele`, with the segments of a `.poly` if there is one.
//!
//! The formats: <https://www.cs.cmu.edu/~quake/triangle.html>. Like Triangle itself, this reader ignores text after the
//! announced rows and columns.

use crate::content::constraints::Constraints;
use crate::content::regions::{Numbering, Regions};
use crate::disk::source::Source;
use crate::edit::numbers;
use crate::error::{Location, ReadError};
use crate::format::Format;
use crate::text::cursor::{CORRECT, CUT_OFF, Cursor};
use crate::text::parallel_rows::take_rows;
use crate::text::syntax::Syntax;
use crate::text::token::{float, integer};
use crate::visit::parsed::{Parsed, fixed_note};

/// Returns a cursor before the first row of one of the files.
pub(crate) fn rows(source: &Source) -> Cursor<'_> {
    // Triangle skips a comma before the blanks that precede a number.
    Cursor::new(source).of(Syntax::TRAILING)
}

/// Reads a mesh from its two files, and from its `.poly` if there is one.
pub(crate) fn parse(
    node: &Source,
    ele: &Source,
    poly: Option<&Source>,
) -> Result<Parsed, ReadError> {
    let (numbers, points, x_at, data) = vertices(node)?;
    let (triangles, regions) = triangles(ele, node, &numbers)?;
    let mut constraints = Constraints::default();
    let mut notes = Vec::new();
    if let Some(poly) = poly {
        let segments = segments(poly, node, &numbers, &mut constraints)?;
        notes.push(fixed_note(segments, "segment", &format!(" of {}", poly.name())));
    }
    constraints.vertices =
        [constraints.anchored.as_slice(), constraints.lines.as_flattened()].concat();
    Ok(Parsed {
        format: Format::Triangle,
        points,
        triangles,
        x_at: numbers::Places::List(x_at),
        owners: None,
        part: 0,
        numbers: numbers::Numbers::TEXT,
        encoded: None,
        regions,
        constraints,
        notes,
        data,
        has_parameters: false,
        has_centers: false,
    })
}

/// Returns line and number of the vertices whose x have these offsets, which are ascending.
pub(crate) fn vertex_places(
    node: &Source,
    x_at: impl Iterator<Item = usize>,
) -> Vec<(Location, u64)> {
    let (mut line, mut counted) = (1, 0);
    let place = |at: usize| {
        line += memchr::memchr_iter(b'\n', &node.bytes[counted..at]).count();
        counted = at;
        let start = memchr::memrchr(b'\n', &node.bytes[..at]).map_or(0, |end| end + 1);
        let number = std::str::from_utf8(&node.bytes[start..at]).unwrap_or_default().trim();
        let number = integer(number.trim_end_matches(',').as_bytes()).unwrap_or_default();
        (Location::Line(line), number)
    };
    x_at.map(place).collect()
}

/// Returns line and number of the triangles with these indices, which are ascending. The file must have been read
/// before.
pub(crate) fn triangle_places(ele: &Source, indices: &[usize]) -> Vec<(Location, u64)> {
    let mut cursor = rows(ele);
    // The header comes before the triangles.
    cursor.next_row();
    let mut rows = 0;
    let place = |&index: &usize| {
        while rows <= index {
            cursor.next_row();
            rows += 1;
        }
        (cursor.location(), cursor.integer("its number").unwrap_or_default())
    };
    indices.iter().map(place).collect()
}

/// The numbering of a file's vertices: `count` of them from `first` on.
pub(crate) struct Numbers {
    pub(crate) first: u64,
    pub(crate) count: u64,
}

impl Numbers {
    /// Reads a vertex of `owner`. Returns its zero-based index.
    #[inline]
    pub(crate) fn index(
        &self,
        cursor: &mut Cursor<'_>,
        list: &Source,
        owner: impl std::fmt::Display,
    ) -> Result<u32, ReadError> {
        let number = cursor.integer(format_args!("a vertex of {owner}"))?;
        match number.checked_sub(self.first) {
            // The count fits into 32 bits.
            Some(index) if index < self.count => Ok(index as u32),
            _ => {
                let (first, list) = (self.first, list.name());
                let last = first + self.count - 1;
                let problem = format!(
                    "{owner} has vertex {number}, but {list} has vertices {first} to {last}"
                );
                Err(cursor.error(problem, "Take files of one mesh, or correct the line"))
            }
        }
    }
}

type Vertices = (Numbers, Vec<[f64; 2]>, Vec<usize>, Vec<String>);

fn vertices(node: &Source) -> Result<Vertices, ReadError> {
    let cursor = &mut rows(node);
    let mut numbers = Numbers { first: 0, count: vertex_header(cursor)? };
    if numbers.count == 0 {
        return Err(cursor.error("no vertices are announced", "Write the mesh again"));
    }
    // A wrong number in the header must not prevent the vertices from being read.
    let attributes = cursor.integer_or(0, "the number of attributes per vertex").unwrap_or(0);
    let data = attribute_names(cursor.capacity(attributes, 1) as u64).collect();
    let capacity = cursor.capacity(numbers.count, "1 0 0\n".len());
    let mut points = Vec::with_capacity(capacity);
    let mut x_at = Vec::with_capacity(capacity);
    let read = |cursor: &mut Cursor<'_>| {
        let number = cursor.integer("the number of a vertex")?;
        Ok((number, cursor.point(format_args!("vertex {number}"))?))
    };
    let plain = take_rows(cursor, numbers.count, read, |(number, (at, point))| {
        if points.is_empty() {
            numbers.first = number.min(1);
        }
        let expected = number == numbers.first + points.len() as u64;
        if expected {
            x_at.push(at);
            points.push(point);
        }
        expected
    });
    for row in plain..numbers.count {
        let number = vertex_number(cursor, row, &mut numbers)?;
        let (at, point) = cursor.point(format_args!("vertex {number}"))?;
        x_at.push(at);
        points.push(point);
    }
    Ok((numbers, points, x_at, data))
}

/// Returns the names of the attributes of vertices.
pub(crate) fn attribute_names(attributes: u64) -> impl Iterator<Item = String> {
    (1..=attributes).map(move |number| match attributes {
        1 => "attribute".to_owned(),
        _ => format!("attribute{number}"),
    })
}

/// Reads the number of vertices, and checks that these have two coordinates.
pub(crate) fn vertex_header(cursor: &mut Cursor<'_>) -> Result<u64, ReadError> {
    header(cursor, "vertices")?;
    let count = cursor.vertex_count()?;
    match cursor.integer_or(2, "the dimension")? {
        2 => Ok(count),
        3 => {
            Err(cursor
                .error("the vertices have 3 coordinates", "Only meshes of the plane are read"))
        }
        other => Err(cursor.error(format!("the dimension is {other}, not 2"), CORRECT)),
    }
}

/// Reads the number at the start of a vertex's row. The first one tells where numbering starts.
pub(crate) fn vertex_number(
    cursor: &mut Cursor<'_>,
    row: u64,
    numbers: &mut Numbers,
) -> Result<u64, ReadError> {
    cursor.row(row, numbers.count, "vertices")?;
    let number = cursor.integer("the number of a vertex")?;
    if row == 0 {
        if number > 1 {
            let problem = format!("the first vertex has number {number}");
            return Err(cursor.error(problem, "Number the vertices from 0 or from 1"));
        }
        numbers.first = number;
    } else if number != numbers.first + row {
        let expected = numbers.first + row;
        let problem = format!("vertex {number} stands where vertex {expected} should");
        return Err(cursor.error(problem, "Number the vertices consecutively"));
    }
    Ok(number)
}

type Triangles = (Vec<[u32; 3]>, Option<Vec<u32>>);

/// Reads the triangles, and the region of each if there are several regions.
fn triangles(ele: &Source, node: &Source, numbers: &Numbers) -> Result<Triangles, ReadError> {
    let cursor = &mut rows(ele);
    header(cursor, "triangles")?;
    let count = cursor.integer("the number of triangles")?;
    match cursor.integer_or(3, "the number of vertices per triangle")? {
        3 => {}
        6 => {
            let problem = "the triangles have 6 nodes, and mid-side nodes are not moved";
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
    let mut triangles = Vec::with_capacity(cursor.capacity(count, "1 1 2 3\n".len()));
    let (mut attributes, mut regions) = (Attributes::default(), Regions::default());
    let mut take = |(corners, text)| {
        triangles.push(corners);
        regions.push(attributes.region(text));
        true
    };
    let read = |cursor: &mut _| triangle(cursor, node, numbers, columns);
    let plain = take_rows(cursor, count, read, &mut take);
    for row in plain..count {
        cursor.row(row, count, "triangles")?;
        take(triangle(cursor, node, numbers, columns)?);
    }
    Ok((triangles, regions.finish()))
}

/// Numbers the regions: triangles with the same attributes are of one region.
#[derive(Default)]
struct Attributes<'a> {
    texts: Numbering<&'a [u8]>,
    /// The region of each text of attributes.
    regions: Vec<u32>,
    names: Numbering<String>,
}

impl<'a> Attributes<'a> {
    #[inline]
    fn region(&mut self, text: &'a [u8]) -> u32 {
        let number = self.texts.number(text) as usize;
        if number == self.regions.len() {
            self.regions.push(self.names.number(normalized(text)));
        }
        self.regions[number]
    }
}

/// Normalizes the text of attributes, so that equal numbers have equal texts.
fn normalized(attributes: &[u8]) -> String {
    let is_between = |&byte: &u8| byte <= b' ' || byte == b',';
    let tokens = attributes.split(is_between).filter(|token| !token.is_empty());
    let normalized = tokens.map(|token| match float(token) {
        // Adding zero makes a negative zero positive.
        Some(number) => format!("{:?} ", number + 0.0),
        None => format!("{} ", String::from_utf8_lossy(token)),
    });
    normalized.collect()
}

/// Reads a triangle's row: its corners, and the text of its attributes, which are `columns` tokens.
#[inline]
fn triangle<'a>(
    cursor: &mut Cursor<'a>,
    node: &Source,
    numbers: &Numbers,
    columns: u64,
) -> Result<([u32; 3], &'a [u8]), ReadError> {
    let number = cursor.integer("the number of a triangle")?;
    let mut corners = [0; 3];
    for corner in &mut corners {
        *corner = numbers.index(cursor, node, format_args!("triangle {number}"))?;
    }
    let [a, b, c] = corners;
    if a == b || b == c || c == a {
        let twice = numbers.first + u64::from(if b == c { b } else { a });
        let problem = format!("triangle {number} lists vertex {twice} twice");
        return Err(cursor.error(problem, "Remove the triangle, or correct its vertices"));
    }
    Ok((corners, cursor.tokens(columns)))
}

/// Adds the segments of a `.poly`, and the vertices it lists, to `constraints`. Returns the number of segments. Holes and
/// regions matter only to mesh generators.
fn segments(
    poly: &Source,
    node: &Source,
    numbers: &Numbers,
    constraints: &mut Constraints,
) -> Result<u64, ReadError> {
    let mut segments = Segments::new(poly, node, numbers)?;
    constraints.anchored.extend(0..segments.listed as u32);
    for row in 0..segments.count {
        constraints.lines.push(segments.segment(row)?.1);
    }
    Ok(segments.count)
}

/// Reads the segments of a `.poly` row by row.
pub(crate) struct Segments<'s> {
    /// Stands after the number of segments at first, then after the vertices of the last segment.
    pub(crate) cursor: Cursor<'s>,
    /// The number of segments.
    pub(crate) count: u64,
    /// How many vertices the `.poly` lists itself. They are the first ones of the mesh.
    listed: u64,
    node: &'s Source,
    ends: Numbers,
}

impl<'s> Segments<'s> {
    pub(crate) fn new(
        poly: &'s Source,
        node: &'s Source,
        numbers: &Numbers,
    ) -> Result<Self, ReadError> {
        let mut cursor = rows(poly);
        let listed = vertex_header(&mut cursor)?;
        // The `.poly` may number its vertices from another number on than the mesh.
        let mut own = Numbers { first: numbers.first, count: listed };
        for row in 0..listed {
            vertex_number(&mut cursor, row, &mut own)?;
            if row >= numbers.count {
                let problem =
                    format!("more vertices than the {} of {}", numbers.count, node.name());
                return Err(cursor.error(problem, "Take files of one mesh"));
            }
        }
        let ends = Numbers { first: own.first, count: numbers.count };
        header(&mut cursor, "segments")?;
        let count = cursor.integer("the number of segments")?;
        Ok(Self { cursor, count, listed, node, ends })
    }

    /// Reads the segment in row `row` of the list. Returns its number, and the zero-based indices of its vertices.
    pub(crate) fn segment(&mut self, row: u64) -> Result<(u64, [u32; 2]), ReadError> {
        let Self { cursor, count, node, ends, .. } = self;
        cursor.row(row, *count, "segments")?;
        let number = cursor.integer("the number of a segment")?;
        let mut vertices = [0; 2];
        for vertex in &mut vertices {
            *vertex = ends.index(cursor, node, format_args!("segment {number}"))?;
        }
        Ok((number, vertices))
    }
}

/// Moves to the header of a list, the row with its length.
pub(crate) fn header(cursor: &mut Cursor<'_>, what: &str) -> Result<(), ReadError> {
    if cursor.next_row() {
        return Ok(());
    }
    Err(cursor.error(format!("the file ends before the number of {what}"), CUT_OFF))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn attributes_are_numbers_however_they_are_written() {
        let mut attributes = Attributes::default();
        let texts = ["1 2", "1.0\t 2e0", "2 1", "1", "0", "-0.0", "land", "sea", "+1 2", "land"];
        let regions = texts.map(|text| attributes.region(text.as_bytes()));
        assert_eq!(regions, [0, 0, 1, 2, 3, 3, 4, 5, 0, 4]);
    }
}
