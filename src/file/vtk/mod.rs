//! VTK's legacy `.vtk`: unstructured grids and polygonal data, as text and in binary.
//!
//! The format: <https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html>, versions 1.0 to 5.1. Binary numbers are
//! big-endian. Points of the type `float` are read and written in single precision in text too, as VTK itself reads
//! them. Of the data, arrays are read that name the cells' regions.

mod cells;
mod data;

pub(in crate::file) use cells::Cell;
pub(in crate::file) use data::names_regions;

use crate::error::ReadError;
use crate::file::binary::Order;
use crate::file::format::Format;
use crate::file::heights::Heights;
use crate::file::numbers::{Form, Numbers};
use crate::file::parallel_rows::take_rows;
use crate::file::sink::{Layout, Sink, Walk, each_row};
use crate::file::source::Source;
use crate::file::text::{CORRECT, CUT_OFF, Cursor};
use crate::file::token::quoted;
use crate::mesh::Precision;
use data::Regions;

pub(crate) struct Vtk;

/// The numbers of a list of cells.
struct Cells<'a> {
    /// For each cell where its points start in `points`, and the length of `points` last.
    starts: Vec<usize>,
    points: Vec<u64>,
    /// The type of each cell; None for polygonal data.
    types: Option<Vec<u64>>,
    kind: List,
    /// Where the first cell starts.
    first: Cursor<'a>,
    /// How many bytes a number has, if they are binary.
    width: Option<usize>,
    /// Whether the number of its points stands before each cell.
    counted: bool,
}

/// What a list of cells holds.
#[derive(Clone, Copy, PartialEq)]
enum List {
    /// Cells of the types that CELL_TYPES lists.
    Cells,
    Polygons,
    Strips,
    Lines,
    /// Points.
    Others,
}

impl Walk for Vtk {
    const VERTICES: &'static str = "POINTS";

    fn walk(source: &Source, sink: &mut dyn Sink) -> Result<Layout, ReadError> {
        let cursor = &mut Cursor::new(source);
        cursor.line();
        cursor.line();
        cursor.row(0, 1, "lines that say ASCII or BINARY")?;
        let binary = match cursor.token().unwrap_or_default() {
            b"ASCII" | b"ascii" => false,
            b"BINARY" | b"binary" => true,
            other => {
                let problem = format!("`{}` is neither ASCII nor BINARY", quoted(other));
                return Err(cursor.error(problem, CORRECT));
            }
        };
        let mut lists: Vec<Cells<'_>> = Vec::new();
        let mut precision = None;
        let mut heights = None;
        let mut regions: Vec<Regions> = Vec::new();
        while cursor.next_word() {
            // VTK does not tell small letters from capitals.
            let keyword = cursor.token().unwrap_or_default().to_ascii_uppercase();
            match keyword.as_slice() {
                b"DATASET" => dataset(cursor)?,
                b"POINTS" => {
                    if precision.is_some() {
                        let problem = "this is the second list of POINTS";
                        return Err(cursor.error(problem, "Save each mesh to a file of its own"));
                    }
                    let mut seen = Heights::new(sink);
                    precision = Some(points(cursor, binary, &mut seen, sink)?);
                    heights = Some(seen);
                }
                b"CELLS" | b"POLYGONS" | b"LINES" | b"VERTICES" | b"TRIANGLE_STRIPS" => {
                    let kind = match keyword.as_slice() {
                        b"CELLS" => List::Cells,
                        b"POLYGONS" => List::Polygons,
                        b"TRIANGLE_STRIPS" => List::Strips,
                        b"LINES" => List::Lines,
                        _ => List::Others,
                    };
                    lists.push(cells(cursor, binary, kind)?);
                }
                b"CELL_TYPES" => {
                    let count = cursor.integer("the number of cell types")?;
                    let types = Some(integers(cursor, count, binary.then_some(4))?);
                    match lists.last_mut() {
                        Some(cells) if cells.starts.len() as u64 == count + 1 => {
                            cells.types = types;
                        }
                        _ => {
                            let problem = format!("{count} types, but another number of cells");
                            return Err(cursor.error(problem, CORRECT));
                        }
                    }
                }
                b"METADATA" => while cursor.line().is_some_and(|line| !line.is_empty()) {},
                b"FIELD" => {
                    sink.leaves_out("field data");
                    data::pass_field(cursor, binary)?;
                }
                // Data of points and cells, to the end of the file.
                b"POINT_DATA" | b"CELL_DATA" => {
                    regions = data::regions(cursor, binary, &keyword, sink);
                    break;
                }
                other => {
                    let problem = format!("`{}` is not known here", quoted(other));
                    return Err(cursor.error(problem, "Save as an unstructured grid"));
                }
            }
        }
        let Some(precision) = precision else {
            return Err(source.error("it has no POINTS", "Save the mesh again"));
        };
        sink.end_nodes(cursor)?;
        if let Some(heights) = heights {
            let form = match binary {
                true => Form::Binary(Order::Big, precision),
                false => Form::Text(precision),
            };
            heights.send("z", form, sink);
        }
        sink.columns(regions.iter().map(Regions::column).collect());
        let mut tag = 0;
        for cells in &lists {
            elements(cursor, cells, &regions, &mut tag, sink)?;
        }
        let (format, numbers) = match binary {
            false => (Format::Vtk, Numbers::Text { precision }),
            true => (Format::VtkBinary, Numbers::adjacent(Order::Big, precision)),
        };
        Ok(Layout::in_place(format, numbers))
    }
}

fn dataset(cursor: &mut Cursor<'_>) -> Result<(), ReadError> {
    let kind = cursor.token().unwrap_or_default();
    match kind.to_ascii_uppercase().as_slice() {
        b"UNSTRUCTURED_GRID" | b"POLYDATA" => Ok(()),
        other => {
            let problem = format!("a dataset of the kind {} has no triangles", quoted(other));
            Err(cursor.error(problem, "Save as an unstructured grid (UNSTRUCTURED_GRID)"))
        }
    }
}

/// Reads the points, of three coordinates each. Returns how many digits they have.
fn points(
    cursor: &mut Cursor<'_>,
    binary: bool,
    heights: &mut Heights,
    sink: &mut dyn Sink,
) -> Result<Precision, ReadError> {
    let count = cursor.vertex_count()?;
    let precision = match cursor.token().unwrap_or_default().to_ascii_lowercase().as_slice() {
        b"float" => Precision::Single,
        b"double" => Precision::Double,
        other => {
            let problem = format!("points are of the type `{}`", quoted(other));
            return Err(cursor.error(problem, "Points of the types float and double are read"));
        }
    };
    if binary {
        let width = precision.bytes();
        let bytes = take(cursor, count, 3 * width)?;
        let start = cursor.taken();
        sink.expect_nodes(bytes.len() / (3 * width));
        for (index, point) in bytes.chunks_exact(3 * width).enumerate() {
            let [x, y, z] = [0, 1, 2].map(|axis| {
                let number = &point[axis * width..][..width];
                Order::Big.real(precision, number)
            });
            let x_at = start + index * 3 * width;
            let place = &Cursor::at_byte_of(cursor.source, x_at);
            sink.node(place, index as u64, 2, x_at, finite(place, [x, y])?);
            heights.see((x_at + 2 * width, z));
        }
        return Ok(precision);
    }
    sink.expect_nodes(cursor.capacity(count, "0 0 0\n".len()));
    // One point a row, or else the numbers are broken into lines anywhere.
    let mut rest = cursor.clone();
    let mut done = 0;
    let plain = each_row(
        cursor,
        count,
        "points",
        sink,
        |cursor| {
            let point = cursor.point("a point")?;
            let z = cursor.height("a point")?;
            match cursor.is_at_end() {
                true => Ok((point, z)),
                false => Err(cursor.error("more than a point on a line", CORRECT)),
            }
        },
        |cursor, sink, index, ((x_at, at), z)| {
            sink.node(cursor, index, 2, x_at, at);
            heights.see(z);
            done = index + 1;
            Ok(())
        },
    );
    if plain.is_ok() {
        return Ok(precision);
    }
    for index in 0..count {
        let mut places = [0; 3];
        let mut point = [0.0; 3];
        for (axis, x) in point.iter_mut().enumerate() {
            if !rest.next_word() {
                let problem = format!("the file ends after {index} of {count} points");
                return Err(rest.error(problem, CUT_OFF));
            }
            places[axis] = rest.at();
            *x = rest.coordinate(['x', 'y', 'z'][axis], format_args!("point {index}"))?;
        }
        if index >= done {
            sink.node(&rest, index, 2, places[0], [point[0], point[1]]);
            heights.see((places[2], point[2]));
        }
    }
    *cursor = rest;
    Ok(precision)
}

fn finite(cursor: &Cursor<'_>, point: [f64; 2]) -> Result<[f64; 2], ReadError> {
    match point.iter().all(|x| x.is_finite()) {
        true => Ok(point),
        false => Err(cursor.error("a coordinate is not a finite number", "Write the mesh again")),
    }
}

/// Takes so many items of so many bytes. The line that announced them has to be read to its end.
fn take<'a>(cursor: &mut Cursor<'a>, count: u64, size: usize) -> Result<&'a [u8], ReadError> {
    let bytes = usize::try_from(count).ok().and_then(|count| count.checked_mul(size));
    let problem = format!("the file ends before {count} items of {size} bytes");
    match bytes {
        None => Err(cursor.error(problem, CUT_OFF)),
        Some(bytes) => {
            let start = cursor.clone();
            cursor.take(bytes).ok_or_else(|| start.error(problem, CUT_OFF))
        }
    }
}

/// Reads a list of whole numbers, of so many bytes each if they are binary.
fn integers(
    cursor: &mut Cursor<'_>,
    count: u64,
    size: Option<usize>,
) -> Result<Vec<u64>, ReadError> {
    match size {
        Some(size) => {
            let bytes = take(cursor, count, size)?;
            Ok(bytes.chunks_exact(size).map(|number| Order::Big.whole(number)).collect())
        }
        None => {
            let mut numbers = Vec::with_capacity(cursor.capacity(count, "0 ".len()));
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

/// Reads the numbers of the rows that follow on all threads, as long as they are plain and no more than are wanted.
fn whole_rows(cursor: &mut Cursor<'_>, count: u64, numbers: &mut Vec<u64>) {
    /// Rows of more numbers are left to be read one by one.
    const MOST: usize = 10;
    let read = |cursor: &mut Cursor<'_>| -> Result<([u64; MOST], usize), ReadError> {
        let mut row = ([0; MOST], 0);
        while !cursor.is_at_end() {
            if row.1 == MOST {
                return Err(cursor.error("a long row", CORRECT));
            }
            row.0[row.1] = cursor.integer("a number")?;
            row.1 += 1;
        }
        Ok(row)
    };
    let done = take_rows(cursor, u64::MAX, read, |(row, length)| {
        let fits = numbers.len() as u64 + length as u64 <= count;
        if fits {
            numbers.extend_from_slice(&row[..length]);
        }
        fits
    });
    if done > 0 {
        // It stands on the last row, before its words, which were read.
        cursor.rest();
    }
}

/// Reads a list of cells: for each the number of its points and these, or from version 5 on where each starts, and all
/// points.
fn cells<'a>(cursor: &mut Cursor<'a>, binary: bool, kind: List) -> Result<Cells<'a>, ReadError> {
    let first = cursor.integer("the number of cells")?;
    let second = cursor.integer("the length of the list of cells")?;
    let mut ahead = cursor.clone();
    let by_offsets =
        ahead.next_row() && ahead.token().is_some_and(|word| word.eq_ignore_ascii_case(b"OFFSETS"));
    if by_offsets {
        *cursor = ahead;
        let size = width(cursor)?;
        let offsets = integers(cursor, first, binary.then_some(size))?;
        cursor.row(0, 1, "lists of CONNECTIVITY")?;
        if !cursor.token().is_some_and(|word| word.eq_ignore_ascii_case(b"CONNECTIVITY")) {
            return Err(cursor.error("OFFSETS without CONNECTIVITY", CORRECT));
        }
        let size = width(cursor)?;
        let first_cell = start_of(cursor, binary);
        let points = integers(cursor, second, binary.then_some(size))?;
        let ascending = offsets.is_sorted() && offsets.last().is_none_or(|&last| last <= second);
        if !ascending {
            return Err(cursor.error("the OFFSETS do not fit the CONNECTIVITY", CORRECT));
        }
        let starts = match offsets.is_empty() {
            true => vec![0],
            false => offsets.iter().map(|&start| start as usize).collect(),
        };
        let (first, width) = (first_cell, binary.then_some(size));
        return Ok(Cells { starts, points, types: None, kind, first, width, counted: false });
    }
    let first_cell = start_of(cursor, binary);
    let numbers = integers(cursor, second, binary.then_some(4))?;
    let mut starts = Vec::with_capacity(numbers.len().min(usize::try_from(first).unwrap_or(0)) + 1);
    let mut points = Vec::with_capacity(numbers.len());
    let mut left = numbers.as_slice();
    starts.push(0);
    for done in 0..first {
        let taken = left.split_first().and_then(|(&corners, rest)| {
            let corners = usize::try_from(corners).ok()?;
            rest.split_at_checked(corners)
        });
        let Some((corners, rest)) = taken else {
            let problem = format!("the list ends after {done} of {first} cells");
            return Err(cursor.error(problem, CORRECT));
        };
        points.extend_from_slice(corners);
        starts.push(points.len());
        left = rest;
    }
    let (first, width) = (first_cell, binary.then_some(4));
    Ok(Cells { starts, points, types: None, kind, first, width, counted: true })
}

/// Where the numbers start that are read next.
fn start_of<'a>(cursor: &Cursor<'a>, binary: bool) -> Cursor<'a> {
    match binary {
        true => Cursor::at_byte_of(cursor.source, cursor.at_byte()),
        false => cursor.clone(),
    }
}

/// The size of a number of the type that the row names.
fn width(cursor: &mut Cursor<'_>) -> Result<usize, ReadError> {
    match cursor.token().unwrap_or_default().to_ascii_lowercase().as_slice() {
        b"vtktypeint64" | b"vtktypeuint64" | b"vtkidtype" | b"long" => Ok(8),
        b"vtktypeint32" | b"vtktypeuint32" | b"int" => Ok(4),
        other => {
            let problem = format!("whole numbers are of the type `{}`", quoted(other));
            Err(cursor.error(problem, "vtktypeint32 and vtktypeint64 are read"))
        }
    }
}

/// Hands cells to the sink.
fn elements(
    cursor: &Cursor<'_>,
    cells: &Cells<'_>,
    regions: &[Regions],
    tag: &mut u64,
    sink: &mut dyn Sink,
) -> Result<(), ReadError> {
    sink.expect_elements(cells.starts.len() - 1);
    if cells.kind == List::Cells && cells.types.is_none() && cells.starts.len() > 1 {
        return Err(cursor.error("CELLS without CELL_TYPES", CUT_OFF));
    }
    // Where each cell stands is looked for only by those who use it.
    let mut place = cells.first.clone();
    for (index, ends) in cells.starts.windows(2).enumerate() {
        let points = &cells.points[ends[0]..ends[1]];
        // Polygonal data has no types: as if they were polygons, strips, and lists of points and lines.
        let cell_type = match (&cells.types, cells.kind) {
            (Some(types), _) => types[index],
            (None, List::Polygons) => 7,
            (None, List::Strips) => 6,
            // A list of lines, or one of points.
            (None, List::Lines) => 4,
            (None, _) => 2,
        };
        let mut region = [0; 2];
        for (number, regions) in region.iter_mut().zip(regions) {
            *number = regions.names.get(*tag as usize).copied().unwrap_or(0);
        }
        let cell = Cell { tag: *tag, cell_type, points, region };
        if sink.takes_ahead() {
            if cell.send(cursor, sink).is_err() {
                (0..index).for_each(|before| cells.pass(&mut place, before));
                cells.stand(&mut place);
                return cell.send(&place, sink);
            }
        } else {
            cells.stand(&mut place);
            cell.send(&place, sink)?;
            cells.pass(&mut place, index);
        }
        *tag += 1;
    }
    Ok(())
}

impl Cells<'_> {
    /// Moves to where the next cell starts, past what stands before it in text.
    fn stand(&self, place: &mut Cursor<'_>) {
        if self.width.is_none() {
            place.next_word();
        }
    }

    /// Moves from the start of a cell to that of the next.
    fn pass(&self, place: &mut Cursor<'_>, index: usize) {
        let numbers = self.starts[index + 1] - self.starts[index] + usize::from(self.counted);
        match self.width {
            Some(width) => {
                *place = Cursor::at_byte_of(place.source, place.taken() + numbers * width)
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
