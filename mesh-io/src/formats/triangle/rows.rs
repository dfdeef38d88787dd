//! The rows of Triangle's files, and the numbers of vertices in them.

use crate::disk::source::Source;
use crate::error::ReadError;
use crate::text::cursor::{CORRECT, CUT_OFF, Cursor};
use crate::text::syntax::Syntax;

/// Returns a cursor before the first row of a `.node`, `.ele` or `.poly`.
pub(super) fn rows(source: &Source) -> Cursor<'_> {
    // Triangle skips a comma before the blanks that precede a number.
    Cursor::new(source).with_syntax(Syntax::TRAILING)
}

/// The numbering of a file's vertices: `count` consecutive numbers from `first` on.
pub(super) struct VertexNumbering {
    pub(super) first: u64,
    pub(super) count: u64,
}

impl VertexNumbering {
    /// Reads the vertex number in a row of `owner`, such as a triangle.
    ///
    /// # Errors
    /// If the file `list` contains no vertex of this number.
    #[inline]
    pub(super) fn vertex(
        &self,
        cursor: &mut Cursor<'_>,
        list: &Source,
        owner: impl std::fmt::Display,
    ) -> Result<u64, ReadError> {
        let number = cursor.integer(format_args!("a vertex of {owner}"))?;
        match number.checked_sub(self.first) {
            Some(index) if index < self.count => Ok(number),
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

    /// Checks the number at the start of a vertex's row. Row 0 determines whether numbering starts at 0 or 1, and later
    /// numbers must be consecutive.
    #[inline]
    pub(super) fn check(
        &mut self,
        cursor: &Cursor<'_>,
        row: u64,
        number: u64,
    ) -> Result<(), ReadError> {
        if row == 0 {
            if number > 1 {
                let problem = format!("the first vertex has number {number}");
                return Err(cursor.error(problem, "Number the vertices from 0 or from 1"));
            }
            self.first = number;
        } else if number != self.first + row {
            let expected = self.first + row;
            let problem = format!("vertex {number} stands where vertex {expected} should");
            return Err(cursor.error(problem, "Number the vertices consecutively"));
        }
        Ok(())
    }
}

/// Moves to the header of a list, the row with its length.
pub(super) fn header(cursor: &mut Cursor<'_>, what: &str) -> Result<(), ReadError> {
    if cursor.next_row() {
        return Ok(());
    }
    Err(cursor.error(format!("the file ends before the number of {what}"), CUT_OFF))
}

/// Reads the number of vertices, and the coordinates per vertex: two as in Triangle, or three as in TetGen.
pub(super) fn vertex_header(cursor: &mut Cursor<'_>) -> Result<(u64, u64), ReadError> {
    header(cursor, "vertices")?;
    let count = cursor.vertex_count()?;
    match cursor.integer_or(2, "the dimension")? {
        coordinates @ 2..=3 => Ok((count, coordinates)),
        other => Err(cursor.error(format!("the dimension is {other}, not 2 or 3"), CORRECT)),
    }
}
