//! Coordinates that a file stores axis by axis, not node by node.

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

/// Byte order and precision of binary floating-point numbers.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) struct BinaryReals {
    pub(crate) order: ByteOrder,
    pub(crate) precision: Precision,
}

/// Coordinates of the nodes of a mesh, stored axis by axis. At least two axes are present.
pub(crate) struct Axes<'a> {
    source: &'a Source,
    form: BinaryReals,
    /// Byte range of each axis: in the file, or in the decoded bytes of `encoded`.
    ranges: Vec<Range<usize>>,
    /// HDF5 datasets with the coordinates. `None` if each dataset is a single range of plain bytes in the file.
    encoded: Option<Hdf5Arrays>,
}

impl<'a> Axes<'a> {
    /// Makes coordinates that the file stores uncompressed: for each axis, `count` numbers from the offset
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

    /// Makes coordinates from HDF5 datasets. Together the datasets hold `axes` axes of `count` numbers each, axis after
    /// axis.
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
        // If each dataset is a single range of plain bytes, a rewrite replaces numbers in place. Otherwise it encodes
        // all datasets again.
        let places: Option<Vec<usize>> = arrays.iter().map(DatasetArray::start).collect();
        if let Some(places) = places {
            let of = |start: usize| (0..of_each).map(move |axis| start + axis * length);
            let starts: Vec<usize> = places.into_iter().flat_map(of).collect();
            return Axes::in_place(source, form, &starts, count);
        }
        let ranges = (0..axes).map(|axis| axis * length..(axis + 1) * length).collect();
        Axes { source, form, ranges, encoded: Some(Hdf5Arrays::new(file, arrays)) }
    }

    /// Visits `count` nodes with consecutive ids from `first` on, and their third coordinates if there are three axes.
    /// Returns encoding and location of the coordinates for a rewrite.
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
        // A number of a compressed dataset has no offset of its own; messages name a byte of the dataset.
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
