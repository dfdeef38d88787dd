//! Reads the points of a VTK XML file, piece by piece.

use super::arrays::File;
use super::blocks::{BlockEncoding, DecodedBlocks};
use super::document::{Array, ArrayFormat};
use super::encoding::XmlArrays;
use crate::binary::number_field::NumberField;
use crate::edit::numbers::{CoordinateEncoding, EncodedArrays};
use crate::error::ReadError;
use crate::precision::Precision;
use crate::text::cursor::{CORRECT, Cursor};
use crate::text::token::quoted;
use crate::visit::records::{NodeIds, NodeRecords};
use crate::visit::send::REWRITE;
use crate::visit::storage::ByteSpace;
use crate::visit::visitor::MeshVisitor;
use crate::visit::z_values::ZValues;
use std::ops::Range;
use std::sync::Arc;

/// Encoding of the coordinates of all pieces, with the encoded arrays of the pieces.
pub(super) struct PointStorage {
    pub(super) numbers: CoordinateEncoding,
    /// Encoded point arrays; `None` if coordinates are replaced in place.
    pub(super) encoded: Option<Box<dyn EncodedArrays>>,
    /// Another array with bytes of the points, in messages; `None` if the points have bytes of their own.
    pub(super) shared_with: Option<String>,
}

/// State of reading the points of all pieces.
struct Points<'s, 'f> {
    visitor: &'s mut dyn MeshVisitor,
    z_values: ZValues,
    /// Encoding of the coordinates, and whether the arrays are base64 or compressed. Both must be equal in all pieces,
    /// as a rewrite uses one encoding.
    numbers: Option<(CoordinateEncoding, bool)>,
    /// Encoded point arrays of the pieces so far, each with its range in the file.
    encoded: Vec<(BlockEncoding, DecodedBlocks<'f>, Range<usize>)>,
    /// Length of the decoded bytes of `encoded`.
    bytes: usize,
    /// Number of points so far; also the id of the next point.
    count: u64,
    /// Offset at which the last point array starts. Arrays that are replaced in place must be in file order, as
    /// coordinate offsets ascend.
    end: usize,
    /// Another array with bytes of an array of points so far, in messages.
    shared_with: Option<String>,
}

/// Visits the points of all pieces, and their third coordinates. Returns encoding and location of the coordinates for a
/// rewrite.
pub(super) fn read(
    file: &File<'_>,
    visitor: &mut dyn MeshVisitor,
) -> Result<PointStorage, ReadError> {
    let z_values = ZValues::new(visitor);
    let mut points = Points {
        visitor,
        z_values,
        numbers: None,
        encoded: Vec::new(),
        bytes: 0,
        count: 0,
        end: 0,
        shared_with: None,
    };
    for (piece, announced) in file.document.pieces.iter().enumerate() {
        if announced.points > 0 || file.document.pieces.len() == 1 {
            points.read(file, file.array(piece, "Points", None)?, announced.points)?;
        }
    }
    let Points { z_values, numbers, encoded, shared_with, visitor, .. } = points;
    let Some((numbers, is_encoded)) = numbers else {
        return Err(file.source.error("it has no piece with points", CORRECT));
    };
    let home = if is_encoded { ByteSpace::Points } else { ByteSpace::File };
    let encoded = is_encoded.then(|| {
        let offsets = Arc::clone(&file.offsets);
        Box::new(XmlArrays::new(encoded, offsets)) as Box<dyn EncodedArrays>
    });
    visitor.end_nodes(&Cursor::new(file.source))?;
    z_values.send_from("z", numbers.into(), home, 0, visitor);
    Ok(PointStorage { numbers, encoded, shared_with })
}

impl<'f> Points<'_, 'f> {
    fn read(&mut self, file: &'f File<'_>, points: &Array, count: u64) -> Result<(), ReadError> {
        let cursor = &mut Cursor::on_line_of(file.source, points.at);
        cursor.check_vertex_count(self.count.saturating_add(count))?;
        if points.components != 3 {
            let problem = format!("the points have {} components", points.components);
            return Err(cursor.error(problem, "In VTK points have three: save the mesh again"));
        }
        let precision = match points.number.as_str() {
            "Float32" => Precision::Single,
            "Float64" => Precision::Double,
            other => {
                let problem =
                    format!("points of the type {} are not read", quoted(other.as_bytes()));
                return Err(cursor.error(problem, "Save them as Float32 or Float64"));
            }
        };
        let (start, numbers, is_encoded) = match points.format {
            ArrayFormat::Ascii => {
                self.text(file, points, count)?;
                (points.content.start, CoordinateEncoding::Text { precision }, false)
            }
            _ => self.binary(file, points, count, precision)?,
        };
        if *self.numbers.get_or_insert((numbers, is_encoded)) != (numbers, is_encoded) {
            let problem =
                "the points of this piece have another encoding than the points of previous pieces";
            return Err(cursor.error(problem, "Save the mesh again, or merge its pieces"));
        }
        if !is_encoded && start < self.end {
            let problem =
                "the points of this piece precede the points of the previous piece in the file";
            return Err(cursor.error(problem, "Save the mesh again, or merge its pieces"));
        }
        self.end = start;
        self.count += count;
        if let (Some(shared), None) = (file.shared.get(&points.at), &self.shared_with) {
            self.shared_with = Some(shared.other.clone());
        }
        Ok(())
    }

    /// Visits binary points. Returns the offset of the first x (in the decoded bytes, if the array is encoded), the
    /// encoding, and whether the array is encoded.
    fn binary(
        &mut self,
        file: &'f File<'_>,
        points: &Array,
        count: u64,
        precision: Precision,
    ) -> Result<(usize, CoordinateEncoding, bool), ReadError> {
        let cursor = &Cursor::on_line_of(file.source, points.at);
        let (wrapping, old, range) = file.unwrap(points)?;
        let wide = precision.bytes();
        if Some(old.bytes.len() as u64) != count.checked_mul(3 * wide as u64) {
            let problem =
                format!("the array has {} bytes, which do not fit {count} points", old.bytes.len());
            return Err(cursor.error(problem, CORRECT));
        }
        // Appended raw bytes without compression are replaced in place. All other arrays are encoded again.
        let is_encoded = wrapping.base64 || wrapping.compressor.is_some();
        let start = if is_encoded { self.bytes } else { range.end - old.bytes.len() };
        let [x, y, z] = [0, 1, 2].map(|axis| {
            NumberField::new(old.bytes.get(axis * wide..), 3 * wide, wide, wrapping.order)
        });
        let (ids, count) = (NodeIds::Consecutive(self.count), count as usize);
        let not_finite = |index| cursor.error(format!("point {index} is not finite"), REWRITE);
        let records = NodeRecords { count, x, y, x_offset: start, ids };
        records.send(self.visitor, |_| cursor.clone(), not_finite)?;
        self.z_values.push_records(z, count, start + 2 * wide);
        let numbers = CoordinateEncoding::adjacent(wrapping.order, precision);
        if is_encoded {
            self.bytes += old.bytes.len();
            self.encoded.push((wrapping, old, range));
        }
        Ok((start, numbers, is_encoded))
    }

    /// Visits points of text.
    fn text(&mut self, file: &File<'_>, points: &Array, count: u64) -> Result<(), ReadError> {
        let cursor = &mut Cursor::within(file.source, points.content.clone());
        self.visitor.expect_nodes(cursor.capacity(count, "0 0 0 ".len()));
        for index in 0..count {
            let mut point = [0.0; 3];
            let mut places = [0; 3];
            for (axis, x) in point.iter_mut().enumerate() {
                if !cursor.next_word() {
                    let problem = format!("the array ends after {index} of {count} points");
                    return Err(cursor.error(problem, CORRECT));
                }
                places[axis] = cursor.at();
                *x = match axis {
                    2 => cursor.z(format_args!("point {index}"))?.1,
                    _ => cursor.coordinate(['x', 'y'][axis], format_args!("point {index}"))?,
                };
            }
            self.visitor.node(cursor, self.count + index, 2, places[0], [point[0], point[1]]);
            self.z_values.push((places[2], point[2]));
        }
        Ok(())
    }
}
