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

/// Encoding of the coordinates of all pieces, with their encoded arrays.
pub(super) struct PointStorage {
    pub(super) numbers: CoordinateEncoding,
    pub(super) encoded: Option<Box<dyn EncodedArrays>>,
}

/// The points read so far.
struct Points<'s, 'f> {
    visitor: &'s mut dyn MeshVisitor,
    z_values: ZValues,
    /// How the numbers are stored, and whether they are encoded. It must be the same in all pieces.
    numbers: Option<(CoordinateEncoding, bool)>,
    encoded: Vec<(BlockEncoding, DecodedBlocks<'f>, Range<usize>)>,
    /// The bytes of all encoded arrays, decoded.
    bytes: usize,
    /// The number of points.
    count: u64,
    /// The offset of the last array of points that is not encoded.
    end: usize,
}

/// Hands on the points of all pieces.
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
    };
    for (piece, announced) in file.document.pieces.iter().enumerate() {
        if announced.points > 0 || file.document.pieces.len() == 1 {
            points.read(file, file.array(piece, "Points", None)?, announced.points)?;
        }
    }
    let Points { z_values, numbers, encoded, visitor, .. } = points;
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
    Ok(PointStorage { numbers, encoded })
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
            let problem = "the points of this piece are not encoded as those of the pieces before";
            return Err(cursor.error(problem, "Save the mesh again, or merge its pieces"));
        }
        if !is_encoded && start < self.end {
            let problem =
                "the points of this piece stand in the file before those of the piece before it";
            return Err(cursor.error(problem, "Save the mesh again, or merge its pieces"));
        }
        self.end = start;
        self.count += count;
        Ok(())
    }

    /// Hands on binary points. Returns their offset, how they are stored, and whether they are encoded.
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
        // Raw bytes can be replaced in place. All others are encoded again.
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

    /// Hands on points of a text.
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
