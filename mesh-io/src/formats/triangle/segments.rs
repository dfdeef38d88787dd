//! The segments of a `.poly`.

use crate::disk::source::Source;
use crate::error::ReadError;
use crate::formats::triangle::rows::{VertexNumbering, header, rows, vertex_header};
use crate::text::cursor::Cursor;

/// Returns the number of vertices in a `.poly`, or 0 for a damaged first row. The mesh starts with the vertices of the
/// `.poly`.
pub(super) fn listed_vertices(poly: &Source) -> u64 {
    vertex_header(&mut rows(poly)).map_or(0, |(count, _)| count)
}

/// Reads the segments of a `.poly` row by row.
pub(super) struct Segments<'s> {
    /// The cursor: initially after the number of segments, later after the vertices of the last segment read.
    pub(super) cursor: Cursor<'s>,
    /// The number of segments.
    pub(super) count: u64,
    node: &'s Source,
    /// The numbering of the `.poly`.
    own: VertexNumbering,
    /// The number of the first vertex in the `.node`, 0 or 1.
    first: u64,
}

impl<'s> Segments<'s> {
    /// Checks the vertices that the `.poly` lists, and moves to its segments. `numbers` is the numbering of the
    /// `.node`.
    pub(super) fn new(
        poly: &'s Source,
        node: &'s Source,
        numbers: &VertexNumbering,
    ) -> Result<Self, ReadError> {
        let mut cursor = rows(poly);
        let (listed, coordinates) = vertex_header(&mut cursor)?;
        if coordinates == 3 {
            let problem =
                "the vertices have 3 coordinates, as in TetGen, whose facets are not read";
            return Err(cursor.error(problem, "Rename the .poly, or write it as Triangle does"));
        }
        // The `.poly` may count its vertices from 1 and the `.node` from 0, or the reverse.
        let mut own = VertexNumbering { first: numbers.first, count: numbers.count };
        for row in 0..listed {
            cursor.row(row, listed, "vertices")?;
            let number = cursor.integer("the number of a vertex")?;
            own.check(&cursor, row, number)?;
            if row >= numbers.count {
                let problem =
                    format!("more vertices than the {} of {}", numbers.count, node.name());
                return Err(cursor.error(problem, "Take files of one mesh"));
            }
        }
        header(&mut cursor, "segments")?;
        let count = cursor.integer("the number of segments")?;
        Ok(Self { cursor, count, node, own, first: numbers.first })
    }

    /// Reads the segment in row `row` of the list; rows must be read in order. Returns the segment's number and its
    /// vertices, renumbered as in the `.node`.
    pub(super) fn segment(&mut self, row: u64) -> Result<(u64, [u64; 2]), ReadError> {
        let Self { cursor, count, node, own, first } = self;
        cursor.row(row, *count, "segments")?;
        let number = cursor.integer("the number of a segment")?;
        let mut vertices = [0; 2];
        for vertex in &mut vertices {
            let of_poly = own.vertex(cursor, node, format_args!("segment {number}"))?;
            *vertex = of_poly - own.first + *first;
        }
        Ok((number, vertices))
    }
}
