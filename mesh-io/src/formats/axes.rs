//! Coordinates of which those of each axis stand by themselves.

use crate::binary::byte_order::ByteOrder;
use crate::binary::number_field::NumberField;
use crate::disk::source::Source;
use crate::edit::numbers::{CoordinateEncoding, EncodedArrays, NumberEncoding};
use crate::error::ReadError;
use crate::format::Format;
use crate::hdf5::{DatasetArray, Hdf5, Hdf5Arrays};
use crate::precision::Precision;
use crate::text::cursor::Cursor;
use crate::visit::records::{NodeIds, NodeRecords};
use crate::visit::send::REWRITE;
use crate::visit::storage::{ByteSpace, CoordinateStorage};
use crate::visit::visitor::MeshVisitor;
use crate::visit::z_values::ZValues;
use std::ops::Range;

/// The encoding of real numbers in binary.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) struct BinaryReals {
    pub(crate) order: ByteOrder,
    pub(crate) precision: Precision,
}

/// The coordinates of a mesh, axis by axis. There are at least two.
pub(crate) struct Axes<'a> {
    source: &'a Source,
    form: BinaryReals,
    /// Where those of each axis are, in the file or among those that are encoded.
    ranges: Vec<Range<usize>>,
    encoded: Option<Hdf5Arrays>,
}

impl<'a> Axes<'a> {
    /// Makes coordinates that stand uncompressed in the file: for each axis, `count` numbers from the offset
    /// `starts[axis]` on.
    pub(crate) fn in_place(
        source: &'a Source,
        form: BinaryReals,
        starts: &[usize],
        count: usize,
    ) -> Axes<'a> {
        let length = count * form.precision.bytes();
        let ranges = starts.iter().map(|&start| start..start + length).collect();
        Axes { source, form, ranges, encoded: None }
    }

    /// Of datasets that have `axes` of them together, `count` to an axis, one axis after another.
    pub(crate) fn of_arrays(
        file: &Hdf5<'a>,
        form: BinaryReals,
        arrays: Vec<DatasetArray<'_>>,
        axes: usize,
        count: usize,
    ) -> Axes<'a> {
        let source = file.source;
        let length = count * form.precision.bytes();
        let of_each = axes / arrays.len().max(1);
        // In the file itself, if they stand there as they are; else as what is written anew.
        let places: Option<Vec<usize>> = arrays.iter().map(DatasetArray::start).collect();
        if let Some(places) = places {
            let of = |start: usize| (0..of_each).map(move |axis| start + axis * length);
            let starts: Vec<usize> = places.into_iter().flat_map(of).collect();
            return Axes::in_place(source, form, &starts, count);
        }
        let ranges = (0..axes).map(|axis| axis * length..(axis + 1) * length).collect();
        Axes { source, form, ranges, encoded: Some(Hdf5Arrays::new(file, arrays)) }
    }

    /// Hands on the nodes, of which there are `count`, numbered from `first` on. Returns how the format has them.
    pub(crate) fn send(
        self,
        format: Format,
        count: usize,
        first: u64,
        visitor: &mut dyn MeshVisitor,
    ) -> Result<CoordinateStorage, ReadError> {
        let Axes { source, form: BinaryReals { order, precision }, ranges, encoded } = self;
        let [x, y] = [0, 1].map(|axis| ranges.get(axis).cloned().unwrap_or_default());
        let size = precision.bytes();
        let bytes = encoded.as_ref().map_or(&source.bytes[..], Hdf5Arrays::bytes);
        // Numbers that are encoded have no place of their own.
        let place = |at: usize| match &encoded {
            None => Cursor::at_byte_offset(source, at),
            Some(encoding) => Cursor::at_byte_offset(source, encoding.byte_of(at)),
        };
        let y_after = y.start as isize - x.start as isize;
        let field =
            |axis: &Range<usize>| NumberField::new(bytes.get(axis.clone()), size, size, order);
        let (x_at, ids) = (x.start, NodeIds::Consecutive(first));
        let place_of = |index: usize| place(x.start + index * size);
        NodeRecords { count, x: field(&x), y: field(&y), x_offset: x_at, ids }.send(
            visitor,
            place_of,
            |index| {
                let id = index as u64 + first;
                let problem = format!("a coordinate of node {id} is not a finite number");
                place_of(index).error(problem, REWRITE)
            },
        )?;
        visitor.end_nodes(&place(x.start))?;
        if let Some(z) = ranges.get(2) {
            let mut z_values = ZValues::new(visitor);
            z_values.push_records(field(z), z.len() / size, z.start);
            let home = if encoded.is_some() { ByteSpace::Points } else { ByteSpace::File };
            z_values.send_from("z", NumberEncoding::Binary(order, precision), home, 0, visitor);
        }
        let numbers = CoordinateEncoding::Binary { order, precision, y_after };
        let encoded = encoded.map(|encoding| Box::new(encoding) as Box<dyn EncodedArrays>);
        Ok(CoordinateStorage { encoded, ..CoordinateStorage::in_place(format, numbers) })
    }
}
