//! Cell lists of a legacy VTK file.

use super::skip::{size_at, skip_metadata, take};
use crate::binary::byte_order::ByteOrder;
use crate::binary::int_array::IntArray;
use crate::error::ReadError;
use crate::formats::vtk::cells::{BulkBackoff, Cell, Triangles};
use crate::formats::vtk::regions::RegionNumbers;
use crate::formats::vtk::types;
use crate::text::cursor::{CORRECT, CUT_OFF, Cursor};
use crate::text::parallel_rows::take_rows;
use crate::text::token::quoted;
use crate::visit::visitor::MeshVisitor;
use std::ops::Range;

/// A cell list: CELLS of an unstructured grid, or a list of polygonal data.
pub(super) struct Cells<'a> {
    pub(super) count: usize,
    /// Point indices of all cells, cell after cell. Before version 5, each cell starts with its point count.
    numbers: IntArray<'a>,
    /// Start of each cell's indices in `numbers`, then the end of the last cell's. `None` before version 5.
    offsets: Option<IntArray<'a>>,
    /// VTK's type number of each cell. `None` for polygonal data, and for CELLS before CELL_TYPES is read.
    pub(super) types: Option<IntArray<'a>>,
    pub(super) kind: List,
    /// Cursor at the first cell.
    first: Cursor<'a>,
    /// Width of a binary integer in bytes; `None` for text.
    width: Option<usize>,
}

/// Keyword of a cell list, in the order in which VTK numbers the cells of polygonal data (`vtkPolyData`).
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum List {
    /// Cells of an unstructured grid, whose types CELL_TYPES lists.
    Cells,
    Vertices,
    Lines,
    Polygons,
    Strips,
}

/// Reads `count` integers: binary ones of `size` bytes, or text if `size` is `None`.
pub(super) fn integers<'a>(
    cursor: &mut Cursor<'a>,
    count: u64,
    size: Option<usize>,
) -> Result<IntArray<'a>, ReadError> {
    match size {
        Some(size) => {
            let bytes = take(cursor, count, size)?;
            Ok(IntArray::binary(bytes.into(), size, ByteOrder::Big))
        }
        None => {
            let mut numbers = IntArray::with_capacity(cursor.capacity(count, "0 ".len()));
            if cursor.is_at_end() && cursor.is_long() {
                whole_rows(cursor, count, &mut numbers);
            }
            for done in numbers.len() as u64..count {
                if !cursor.next_word() {
                    let problem = format!("the file ends after {done} of {count} numbers");
                    return Err(cursor.error(problem, CUT_OFF));
                }
                numbers.push(cursor.integer("a number")?);
            }
            Ok(numbers)
        }
    }
}

/// Reads rows of integers on all threads. Stops before the first row with another word, or with which the integers
/// would exceed `count`.
fn whole_rows(cursor: &mut Cursor<'_>, count: u64, numbers: &mut IntArray<'_>) {
    /// Limit on the integers of a row that is read on all threads. A longer row, or an integer above 32 bits, is left
    /// to the serial reader.
    const MAX_ROW_NUMBERS: usize = 10;
    let read = |cursor: &mut Cursor<'_>| -> Result<([u32; MAX_ROW_NUMBERS], u8), ReadError> {
        let mut row = ([0; MAX_ROW_NUMBERS], 0);
        while !cursor.is_at_end() {
            let number = u32::try_from(cursor.integer("a number")?).ok();
            let (Some(number), Some(next)) = (number, row.0.get_mut(usize::from(row.1))) else {
                return Err(cursor.error("a long row or number", CORRECT));
            };
            *next = number;
            row.1 += 1;
        }
        Ok(row)
    };
    let done = take_rows(cursor, u64::MAX, read, |(row, length)| {
        let length = usize::from(length);
        let fits = numbers.len() as u64 + length as u64 <= count;
        if fits {
            row[..length].iter().for_each(|&number| numbers.push(u64::from(number)));
        }
        fits
    });
    if done > 0 {
        // The cursor is before the words of the last row taken, which must not be read twice.
        cursor.rest();
    }
}

/// Reads a cell list after its keyword. Up to version 4, each cell is its point count and its point indices. From
/// version 5 on, OFFSETS lists the start of each cell in the point indices of CONNECTIVITY.
pub(super) fn read<'a>(
    cursor: &mut Cursor<'a>,
    binary: bool,
    kind: List,
) -> Result<Cells<'a>, ReadError> {
    let first = cursor.integer("the number of cells")?;
    let second = cursor.integer("the length of the list of cells")?;
    let mut ahead = cursor.clone();
    let by_offsets =
        ahead.next_row() && ahead.token().is_some_and(|word| word.eq_ignore_ascii_case(b"OFFSETS"));
    if by_offsets {
        *cursor = ahead;
        let size = width(cursor, first)?;
        let offsets = integers(cursor, first, binary.then_some(size))?;
        skip_metadata(cursor, 1);
        cursor.row(0, 1, "lists of CONNECTIVITY")?;
        if !cursor.token().is_some_and(|word| word.eq_ignore_ascii_case(b"CONNECTIVITY")) {
            return Err(cursor.error("OFFSETS without CONNECTIVITY", CORRECT));
        }
        let size = width(cursor, second)?;
        let first = start_of(cursor, binary);
        let numbers = integers(cursor, second, binary.then_some(size))?;
        skip_metadata(cursor, 1);
        let count = offsets.len().saturating_sub(1);
        if !offsets.is_sorted() || (!offsets.is_empty() && offsets.at(count) > second) {
            return Err(cursor.error("the OFFSETS do not fit the CONNECTIVITY", CORRECT));
        }
        let (offsets, width) = (Some(offsets), binary.then_some(size));
        return Ok(Cells { count, numbers, offsets, types: None, kind, first, width });
    }
    let first_cell = start_of(cursor, binary);
    let numbers = integers(cursor, second, binary.then_some(4))?;
    skip_metadata(cursor, 1);
    let mut at = 0;
    for done in 0..first {
        let corners = if at < numbers.len() { Some(numbers.at(at)) } else { None };
        match corners {
            Some(corners) if corners < (numbers.len() - at) as u64 => at += 1 + corners as usize,
            _ => {
                let problem = format!("the list ends after {done} of {first} cells");
                return Err(cursor.error(problem, CORRECT));
            }
        }
    }
    let (first, count, width) = (first_cell, first as usize, binary.then_some(4));
    Ok(Cells { count, numbers, offsets: None, types: None, kind, first, width })
}

/// Returns a cursor at the integers that follow, for messages on cells.
fn start_of<'a>(cursor: &Cursor<'a>, binary: bool) -> Cursor<'a> {
    match binary {
        true => Cursor::at_byte_offset(cursor.source, cursor.at_byte()),
        false => cursor.clone(),
    }
}

/// Reads the name of the type of the `count` integers that follow. Returns their width in bytes.
fn width(cursor: &mut Cursor<'_>, count: u64) -> Result<usize, ReadError> {
    let kind = cursor.token().unwrap_or_default().to_ascii_lowercase();
    match (kind.as_slice(), size_at(cursor, &kind, count)) {
        (
            b"vtktypeint64" | b"vtktypeuint64" | b"vtkidtype" | b"long" | b"vtktypeint32"
            | b"vtktypeuint32" | b"int",
            Some(size),
        ) => Ok(size),
        (other, _) => {
            let problem = format!("whole numbers of the type `{}` are not read", quoted(other));
            Err(cursor.error(problem, "Save them as vtktypeint32 or vtktypeint64"))
        }
    }
}

impl Cells<'_> {
    /// Visits the cells. `id` is the id of the list's first cell on entry, and of the next list's first cell on return.
    pub(super) fn send(
        &self,
        cursor: &Cursor<'_>,
        regions: &RegionNumbers,
        id: &mut u64,
        visitor: &mut dyn MeshVisitor,
    ) -> Result<(), ReadError> {
        visitor.expect_elements(self.count);
        if self.kind == List::Cells && self.types.is_none() && self.count > 0 {
            return Err(cursor.error("CELLS without CELL_TYPES", CUT_OFF));
        }
        // A visitor that allows parallel reading uses locations only for errors, so the cell is located after an error
        // alone.
        let mut place = self.first.clone();
        let mut tries = BulkBackoff::NEW;
        let (mut index, mut end) = (0, 0);
        let mut points = Vec::new();
        let first = *id;
        while index < self.count {
            *id = first + index as u64;
            let own = self.points(index, end);
            if own.len() == 3
                && tries.is_due(index)
                && let Some(triangles) = self.triangles(index, own.clone(), regions, *id)
            {
                let (taken, last) = triangles.send(visitor);
                tries.done(index, taken);
                if taken > 0 {
                    (index, end) = (index + taken, last);
                    continue;
                }
            }
            points.clear();
            points.extend(self.numbers.range(own.clone()));
            let region = regions.of(*id as usize);
            let cell = Cell { id: *id, cell_type: self.cell_type(index), points: &points, region };
            if visitor.allows_parallel() {
                if cell.send(cursor, visitor).is_err() {
                    self.seek_cell(&mut place, index);
                    return cell.send(&place, visitor);
                }
            } else {
                self.seek_next(&mut place);
                cell.send(&place, visitor)?;
                self.skip_cell(&mut place, own.len());
            }
            (index, end) = (index + 1, own.end);
        }
        *id = first + self.count as u64;
        Ok(())
    }

    /// Returns the triangles from cell `index` on, which has three points, for a bulk visit. `None` for lists of
    /// strips, lines or vertices.
    fn triangles<'c>(
        &'c self,
        index: usize,
        own: Range<usize>,
        regions: &'c RegionNumbers,
        id: u64,
    ) -> Option<Triangles<'c>> {
        let types = match (&self.types, self.kind) {
            (Some(types), _) => Some(types.field(index, 1)),
            (None, List::Polygons) => None,
            _ => return None,
        };
        Some(Triangles {
            count: self.count - index,
            numbers: &self.numbers,
            own,
            ends: self.offsets.as_ref().map(|offsets| offsets.field(index + 1, 1)),
            types,
            first: 0,
            below: u64::MAX,
            regions: regions.from(id as usize),
        })
    }

    /// Returns the range of a cell's point indices in `numbers`. `end` is the end of the previous cell's range, 0 for
    /// the first cell.
    fn points(&self, index: usize, end: usize) -> Range<usize> {
        match &self.offsets {
            Some(offsets) => offsets.at(index) as usize..offsets.at(index + 1) as usize,
            None => end + 1..end + 1 + self.numbers.at(end) as usize,
        }
    }

    /// Returns VTK's type number of a cell. Polygonal data list no types: the keyword of a list determines the type.
    fn cell_type(&self, index: usize) -> u64 {
        match (&self.types, self.kind) {
            (Some(types), _) => types.at(index),
            (None, List::Polygons) => types::POLYGON,
            (None, List::Strips) => types::TRIANGLE_STRIP,
            (None, List::Lines) => types::POLY_LINE,
            (None, _) => types::POLY_VERTEX,
        }
    }

    /// Moves the cursor from the first cell to the cell `index`.
    #[cold]
    fn seek_cell(&self, place: &mut Cursor<'_>, index: usize) {
        let mut end = 0;
        for before in 0..index {
            let points = self.points(before, end);
            self.skip_cell(place, points.len());
            end = points.end;
        }
        self.seek_next(place);
    }

    /// Moves the cursor to the first word of the next cell in text. Binary cells are adjacent.
    fn seek_next(&self, place: &mut Cursor<'_>) {
        if self.width.is_none() {
            place.next_word();
        }
    }

    /// Moves the cursor from the start of a cell with `points` points to the end of the cell.
    fn skip_cell(&self, place: &mut Cursor<'_>, points: usize) {
        let numbers = points + usize::from(self.offsets.is_none());
        match self.width {
            Some(width) => {
                *place = Cursor::at_byte_offset(place.source, place.last_taken() + numbers * width)
            }
            None => {
                for _ in 0..numbers {
                    place.next_word();
                    place.token();
                }
            }
        }
    }
}
