//! Node data of netCDF files: variables that are visited record by record.

use crate::edit::numbers::{EncodedArrays, NumberEncoding, Offsets};
use crate::hdf5::Hdf5Arrays;
use crate::netcdf::{Header, Items, NumberType, Variable};
use crate::visit::items::PointNumbers;
use crate::visit::storage::{ArrayLocation, ByteSpace};
use crate::visit::visitor::MeshVisitor;
use std::ops::Range;
use std::sync::Arc;

/// Layout of a variable's record, and its visited parts. A record consists of `all` equal parts, such as model layers,
/// with `components` numbers per node.
#[derive(Clone)]
pub(crate) struct RecordParts {
    /// Indices of the visited parts, from 0.
    pub(crate) wanted: Range<usize>,
    /// Number of equal parts of a record.
    pub(crate) all: usize,
    /// Numbers per node in a part.
    pub(crate) components: u64,
}

impl RecordParts {
    /// Layout of a record with a single number per node.
    pub(crate) const WHOLE: RecordParts = RecordParts { wanted: 0..1, all: 1, components: 1 };
}

/// Reader of node and face data, which visits the node data. All parts and records of a compressed variable share an
/// encoding, so that their edits are encoded together.
pub(crate) struct PointData<'h, 'a> {
    header: &'h Header<'a>,
    /// HDF5 variables read so far that edits must encode again, by name: compressed ones, or those in several chunks.
    encoded: Vec<(&'h [u8], Arc<Hdf5Arrays>)>,
    /// Name and content of the variable read last, so that its records and parts are decoded once.
    last: Option<(&'h [u8], Items<'a>)>,
}

impl<'h, 'a> PointData<'h, 'a> {
    pub(crate) fn new(header: &'h Header<'a>) -> PointData<'h, 'a> {
        PointData { header, encoded: Vec::new(), last: None }
    }

    /// Visits the wanted parts of each record of a variable as arrays of point data called `name`. Real numbers can be
    /// rewritten, whole numbers cannot. Numbers equal to `missing` become NaN.
    pub(crate) fn send(
        &mut self,
        name: &[u8],
        variable: &'h Variable,
        parts: &RecordParts,
        missing: Option<f64>,
        visitor: &mut dyn MeshVisitor,
    ) {
        let is_real = matches!(variable.number, NumberType::Real(_));
        for record in 0..self.header.steps(variable) {
            for part in parts.wanted.clone() {
                if visitor.point_array(name, parts.components, is_real)
                    && let Some(numbers) = self.numbers(variable, record, part, parts, missing)
                {
                    variable.packing().into_iter().for_each(|packing| visitor.packing(packing));
                    visitor.point_numbers(numbers);
                }
            }
        }
    }

    /// Reads one part of one record. `None` if the variable holds text, or if its content cannot be read.
    pub(crate) fn numbers(
        &mut self,
        variable: &'h Variable,
        record: usize,
        part: usize,
        parts: &RecordParts,
        missing: Option<f64>,
    ) -> Option<PointNumbers> {
        let precision = match variable.number {
            NumberType::Real(precision) => Some(precision),
            NumberType::Whole(_) => None,
            NumberType::Text | NumberType::Other(_) => return None,
        };
        if self.last.as_ref().is_none_or(|(name, _)| *name != variable.name) {
            self.last = Some((&variable.name, self.items(variable)?));
        }
        let (_, items) = self.last.as_ref()?;
        let encoding = self.encoding(variable);
        let bytes = encoding.map_or(&items.bytes[..], |encoding| encoding.bytes());
        let range = items.range(record);
        let size = range.len() / parts.all.max(1);
        let range = range.start + part * size..range.start + (part + 1) * size;
        let (start, home) = match encoding {
            None => (items.byte_of(range.start), ByteSpace::File),
            Some(encoding) => {
                (range.start, ByteSpace::Encoded(Arc::clone(encoding) as Arc<dyn EncodedArrays>))
            }
        };
        let mut numbers = variable.numbers(bytes.get(range).unwrap_or_default());
        let is_missing = |number: &&mut f64| Some(**number) == missing;
        numbers.iter_mut().filter(is_missing).for_each(|number| *number = f64::NAN);
        let stored = precision.map(|precision| {
            let offsets = Offsets::Regular { start, stride: precision.bytes() };
            ArrayLocation {
                offsets,
                encoding: NumberEncoding::Binary(variable.order, precision),
                space: home,
                file_index: 0,
                shared: None,
            }
        });
        Some(PointNumbers { numbers, nodes: None, location: stored })
    }

    fn encoding(&self, variable: &Variable) -> Option<&Arc<Hdf5Arrays>> {
        let known = self.encoded.iter().find(|(known, _)| *known == variable.name);
        known.map(|(_, encoding)| encoding)
    }

    /// Reads the content of a variable. If the variable is not a single range of plain bytes in the file, its content
    /// moves to `encoded` for later edits.
    fn items(&mut self, variable: &'h Variable) -> Option<Items<'a>> {
        let mut items = self.header.items(variable).ok()?;
        if items.start().is_none()
            && self.encoding(variable).is_none()
            && let (Some(file), Some(array)) = (&self.header.hdf5, items.take_array())
        {
            let encoding = Arc::new(Hdf5Arrays::new(file, vec![array]));
            self.encoded.push((&variable.name, encoding));
        }
        Some(items)
    }
}
