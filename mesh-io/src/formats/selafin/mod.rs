//! TELEMAC's SELAFIN (also SERAFIN), in either byte order and precision.
//!
//! The format: TELEMAC-MASCARET's user manual, appendix on SERAFIN. A file is a sequence of Fortran records, each
//! between two copies of its length. The x of all points precede the y of all points. The time steps that follow are
//! kept. Titles of double precision end in `SERAFIND` by the manual, but other programs write such files with any title.
//! So the length of the record of x decides the precision, as in `parserSELAFIN.py` of TELEMAC.

pub(crate) mod conditions;
pub(crate) mod write;

use crate::binary::byte_order::ByteOrder;
use crate::binary::number_field::NumberField;
use crate::disk::source::Source;
use crate::edit::numbers::{CoordinateEncoding, NumberEncoding, Offsets};
use crate::error::ReadError;
use crate::format::Format;
use crate::formats::selafin::conditions::Faces;
use crate::precision::Precision;
use crate::text::cursor::{CUT_OFF, Cursor};
use crate::visit::items::{CellKind, PointNumbers};
use crate::visit::reader::FormatReader;
use crate::visit::records::{NodeIds, NodeRecords, Region};
use crate::visit::rows::volume;
use crate::visit::send::{ElementRecords, REWRITE};
use crate::visit::storage::{ArrayLocation, CoordinateStorage};
use crate::visit::visitor::MeshVisitor;

pub(crate) struct Selafin;

impl FormatReader for Selafin {
    const VERTICES: &'static str = "the list of points";

    fn load_companions(given: Source) -> Result<Source, ReadError> {
        let beside = conditions::load(&given.path);
        Ok(Source { beside, ..given })
    }

    fn visit(
        source: &Source,
        visitor: &mut dyn MeshVisitor,
    ) -> Result<CoordinateStorage, ReadError> {
        let cursor = &mut Cursor::new(source);
        let order = match source.bytes.starts_with(&[0, 0, 0, 80]) {
            true => ByteOrder::Big,
            false => ByteOrder::Little,
        };
        record(cursor, order, "the title", Some(80))?;
        let counts = integers(record(cursor, order, "the numbers of variables", Some(8))?, order);
        let variables = u64::from(counts[0].unsigned_abs()) + u64::from(counts[1].unsigned_abs());
        let mut names = Vec::new();
        for _ in 0..variables {
            let name = record(cursor, order, "the name of a variable", Some(32))?;
            names.push(name[..16].trim_ascii());
        }
        let parameters = integers(record(cursor, order, "the parameters", Some(40))?, order);
        if parameters[6] > 1 {
            return Err(volume(cursor, "several planes"));
        }
        if parameters[9] == 1 {
            record(cursor, order, "the date", Some(24))?;
        }
        let sizes = integers(record(cursor, order, "the sizes", Some(16))?, order);
        let [triangles, points, corners] = [sizes[0], sizes[1], sizes[2]];
        let kind = match corners {
            3 => CellKind::Triangle,
            4 => CellKind::Quadrilateral,
            6 => return Err(volume(cursor, "prisms")),
            other => {
                let problem = format!("the elements have {other} corners");
                return Err(cursor.error(problem, "Save a mesh of triangles"));
            }
        };
        let sized = |count: i32, each: usize| {
            usize::try_from(count).ok().and_then(|count| count.checked_mul(each))
        };
        let (Some(listed), Some(numbered), Some(doubles)) =
            (sized(triangles, 4 * kind.nodes()), sized(points, 4), sized(points, 8))
        else {
            return Err(cursor.error("a size is negative", "Write the mesh again"));
        };
        let connectivity = record(cursor, order, "the elements", Some(listed))?;
        let listed_at = cursor.last_taken();
        record(cursor, order, "the boundary numbers", Some(numbered))?;
        let length = cursor.clone().take(4).map(|bytes| record_length(bytes, order));
        let has_doubles = points > 0 && length.is_some_and(|n| usize::try_from(n) == Ok(doubles));
        let (precision, numbers) = match has_doubles {
            true => (Precision::Double, doubles),
            false => (Precision::Single, numbered),
        };
        let xs = record(cursor, order, "the x of all points", Some(numbers))?;
        let x_at = cursor.last_taken();
        let ys = record(cursor, order, "the y of all points", Some(numbers))?;
        let y_after = (cursor.last_taken() - x_at) as isize;
        let after_mesh = cursor.clone();
        let size = precision.bytes();
        let [x, y] = [xs, ys].map(|bytes| NumberField::new(Some(bytes), size, size, order));
        NodeRecords { count: points as usize, x, y, x_offset: x_at, ids: NodeIds::Consecutive(1) }
            .send(
                visitor,
                |index| Cursor::at_byte_offset(source, x_at + index * size),
                |index| {
                    let problem =
                        format!("a coordinate of point {} is not a finite number", index + 1);
                    cursor.error(problem, REWRITE)
                },
            )?;
        visitor.end_nodes(cursor)?;
        let stride = 4 * kind.nodes();
        let elements = ElementRecords {
            kind,
            count: triangles as usize,
            first_tag: 1,
            nodes: NumberField::new(Some(connectivity), stride, 4, order),
            is_signed: true,
            regions: [Region::Same(0); 2],
        };
        elements
            .send(visitor, |index, _| Cursor::at_byte_offset(source, listed_at + index * stride))?;
        if visitor.asks_for_groups()
            && let Some(list) = &source.beside
        {
            let corners = NumberField::new(Some(connectivity), 4, 4, order);
            let (count, corners_of_face) = (triangles as usize, kind.nodes());
            let faces = Faces { corners, count, corners_of_face, x, points: points as usize };
            conditions::visit(list, cursor, &faces, visitor);
        }
        if visitor.asks_for_data() {
            visitor.origin([parameters[2], parameters[3]]);
            if parameters[9] == 1 {
                visitor.unsupported("the date of a SELAFIN");
            }
        }
        steps(after_mesh, order, precision, &names, numbers, visitor)?;
        if !visitor.asks_for_data() {
            names.iter().for_each(|name| _ = visitor.point_array(name, 1, true));
        }
        let numbers = CoordinateEncoding::Binary { order, precision, y_after };
        Ok(CoordinateStorage::in_place(Format::Selafin, numbers))
    }
}

/// Reads the time steps up to the end of the file, each a time and a record for each variable. Passes the numbers on if the
/// visitor asks for data.
///
/// # Errors
/// If the file ends within a step, or if a record is damaged.
fn steps(
    mut cursor: Cursor<'_>,
    order: ByteOrder,
    precision: Precision,
    names: &[&[u8]],
    bytes: usize,
    visitor: &mut dyn MeshVisitor,
) -> Result<(), ReadError> {
    let cursor = &mut cursor;
    while cursor.clone().take(1).is_some() {
        let time = record(cursor, order, "the time of a step", None)?;
        if visitor.asks_for_data() && time.iter().any(|&byte| byte != 0) {
            visitor.unsupported("the times of a SELAFIN");
        }
        for name in names {
            let values = record(cursor, order, "the values of a variable", Some(bytes))?;
            if visitor.asks_for_data() && visitor.point_array(name, 1, true) {
                let size = precision.bytes();
                let numbers = values.chunks_exact(size).map(|x| order.real(precision, x)).collect();
                let places = Offsets::Regular { start: cursor.last_taken(), stride: size };
                let stored =
                    ArrayLocation::in_place(places, NumberEncoding::Binary(order, precision));
                visitor.point_numbers(PointNumbers { numbers, nodes: None, location: stored });
            }
        }
    }
    Ok(())
}

/// Takes a Fortran record and returns its content, which starts at [`Cursor::last_taken`]. Messages call the record
/// `what`.
///
/// # Errors
/// If the file ends before the record, if the two copies of the length differ, or if the content does not have
/// `expected` bytes. `None` allows any length.
fn record<'a>(
    cursor: &mut Cursor<'a>,
    order: ByteOrder,
    what: &str,
    expected: Option<usize>,
) -> Result<&'a [u8], ReadError> {
    let start = cursor.clone();
    let cut_off = || start.error(format!("the file ends before {what}"), CUT_OFF);
    let size = record_length(cursor.take(4).ok_or_else(cut_off)?, order);
    let bytes = usize::try_from(size).unwrap_or(usize::MAX);
    if expected.is_some_and(|expected| bytes != expected) {
        let problem = format!("the record of {what} has {size} bytes");
        return Err(start.error(problem, "Write the mesh again"));
    }
    let taken = cursor.take(bytes).ok_or_else(cut_off)?;
    let mut after = cursor.clone();
    if record_length(after.take(4).ok_or_else(cut_off)?, order) != size {
        let problem = format!("the record of {what} ends with another length than it begins with");
        return Err(start.error(problem, "Write the mesh again"));
    }
    cursor.skip_bytes(4);
    Ok(taken)
}

/// Returns the number of bytes of a record by the first or last four bytes of the record.
fn record_length(bytes: &[u8], order: ByteOrder) -> i32 {
    order.i32(bytes.try_into().expect("4 bytes"))
}

fn integers(bytes: &[u8], order: ByteOrder) -> Vec<i32> {
    bytes.as_chunks().0.iter().map(|&bytes| order.i32(bytes)).collect()
}
