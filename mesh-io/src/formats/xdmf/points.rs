//! The points of an XDMF file.

use super::File;
use super::document::Item;
use super::heavy;
use crate::binary::number_field::NumberField;
use crate::edit::numbers::{CoordinateEncoding, EncodedArrays};
use crate::error::ReadError;
use crate::format::Format;
use crate::hdf5::{Datatype, Hdf5Arrays};
use crate::precision::Precision;
use crate::text::cursor::CORRECT;
use crate::text::token::quoted;
use crate::visit::records::{NodeIds, NodeRecords};
use crate::visit::send::REWRITE;
use crate::visit::storage::{ByteSpace, CoordinateStorage};
use crate::visit::visitor::MeshVisitor;
use crate::visit::z_values::ZValues;

impl File<'_> {
    /// Visits the points of a Geometry. Returns encoding and location of the coordinates for a rewrite, and the number
    /// of points.
    pub(super) fn points(
        &self,
        item: &Item,
        visitor: &mut dyn MeshVisitor,
    ) -> Result<(CoordinateStorage, u64), ReadError> {
        let axes = match item.kind.as_str() {
            "xy" => 2,
            "" | "xyz" => 3,
            other => {
                let problem =
                    format!("a Geometry of the type {} is not read", quoted(other.as_bytes()));
                return Err(self.cursor(item).error(problem, "Save points as XY or XYZ"));
            }
        };
        match self.heavy.read(item, &self.cursor(item))? {
            Some(numbers) => self.heavy_points(item, numbers, axes as usize, visitor),
            None => self.text_points(item, axes, visitor),
        }
    }

    fn text_points(
        &self,
        item: &Item,
        axes: u64,
        visitor: &mut dyn MeshVisitor,
    ) -> Result<(CoordinateStorage, u64), ReadError> {
        if item.precision.is_none() {
            let problem = "the points are whole numbers";
            return Err(self.cursor(item).error(problem, "Save them as Float"));
        }
        let announced = item.announced();
        let count = announced.map(|count| count / axes);
        self.cursor(item).check_vertex_count(count.unwrap_or(0))?;
        let cursor = &mut self.content(item);
        visitor.expect_nodes(cursor.capacity(count.unwrap_or(0), "0 0 ".len()));
        let mut z_values = ZValues::new(visitor);
        let mut index = 0;
        while cursor.next_word() {
            if Some(index) == count {
                return Err(cursor.error(
                    format!("there are more points than the {index} that Dimensions announces"),
                    CORRECT,
                ));
            }
            let own = cursor.clone();
            let mut point = [0.0; 3];
            let mut places = [0; 3];
            for axis in 0..axes as usize {
                if !cursor.next_word() {
                    return Err(cursor.error(format!("point {index} lacks a coordinate"), CORRECT));
                }
                places[axis] = cursor.at();
                point[axis] = match axis {
                    2 => cursor.z(format_args!("point {index}"))?.1,
                    _ => cursor.coordinate(['x', 'y'][axis], format_args!("point {index}"))?,
                };
            }
            visitor.node(&own, index, 2, places[0], [point[0], point[1]]);
            if axes == 3 {
                z_values.push((places[2], point[2]));
            }
            index += 1;
        }
        if announced.is_some_and(|announced| index.checked_mul(axes) != Some(announced)) {
            let problem = format!("the Geometry ends after {index} points");
            return Err(
                cursor.error(problem, "Its Dimensions announce another number: correct them")
            );
        }
        cursor.check_vertex_count(index)?;
        visitor.end_nodes(&self.cursor(item))?;
        let precision = item.precision.unwrap_or(Precision::Double);
        let numbers = CoordinateEncoding::Text { precision };
        z_values.send("z", numbers.into(), visitor);
        Ok((CoordinateStorage::in_place(Format::Xdmf, numbers), index))
    }

    /// Visits the points of a companion file.
    fn heavy_points(
        &self,
        item: &Item,
        mut numbers: heavy::HeavyArray<'_>,
        axes: usize,
        visitor: &mut dyn MeshVisitor,
    ) -> Result<(CoordinateStorage, u64), ReadError> {
        let Datatype::Real(precision, order) = numbers.number else {
            let problem = "the points are not floating-point numbers of 32 or 64 bits";
            return Err(self.cursor(item).error(problem, "Save them as Float"));
        };
        let size = precision.bytes();
        let stride = axes * size;
        if !numbers.bytes.len().is_multiple_of(stride) {
            let problem = format!(
                "there are {} numbers, not {axes} for each point",
                numbers.bytes.len() / size
            );
            return Err(self.cursor(item).error(problem, CORRECT));
        }
        let count = numbers.bytes.len() / stride;
        self.cursor(item).check_vertex_count(count as u64)?;
        // Plain bytes of the file are replaced in place; a dataset with chunks or filters is encoded again.
        let (start, file_index) = (numbers.start.unwrap_or(0), numbers.file_index);
        let encoded: Option<Hdf5Arrays> = match numbers.start {
            Some(_) => None,
            None => self.heavy.encoding(&mut numbers),
        };
        let bytes = encoded.as_ref().map_or(&numbers.bytes[..], Hdf5Arrays::bytes);
        let mut z_values = ZValues::new(visitor);
        let field = |axis: usize| NumberField::new(bytes.get(axis * size..), stride, size, order);
        let (x, y, ids) = (field(0), field(1), NodeIds::Consecutive(0));
        let place = |index| numbers.cursor(index * stride);
        NodeRecords { count, x, y, x_offset: start, ids }.send(visitor, place, |index| {
            let problem = format!("a coordinate of point {index} is not a finite number");
            place(index).error(problem, REWRITE)
        })?;
        if axes == 3 {
            z_values.push_records(field(2), count, start + 2 * size);
        }
        visitor.end_nodes(&self.cursor(item))?;
        let numbers = CoordinateEncoding::adjacent(order, precision);
        let home = if encoded.is_some() { ByteSpace::Points } else { ByteSpace::File };
        z_values.send_from("z", numbers.into(), home, file_index, visitor);
        let encoded = encoded.map(|encoding| Box::new(encoding) as Box<dyn EncodedArrays>);
        Ok((
            CoordinateStorage {
                encoded,
                file_index,
                ..CoordinateStorage::in_place(Format::Xdmf, numbers)
            },
            count as u64,
        ))
    }
}
