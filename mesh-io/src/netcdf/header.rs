//! Dimensions and variables of a netCDF file by name, in the classic formats and in netCDF-4.

use super::attribute::Attribute;
use super::types::NumberType;
use crate::binary::byte_order::ByteOrder;
use crate::disk::source::Source;
use crate::error::ReadError;
use crate::hdf5::{Dataset, DatasetArray, Hdf5};
use std::borrow::Cow;
use std::ops::Range;

/// The dimensions and variables of a netCDF file. In the classic formats, no variables overlap or end beyond the file.
pub(crate) struct Header<'a> {
    pub(crate) source: &'a Source,
    pub(crate) dimensions: Vec<(Vec<u8>, u64)>,
    pub(crate) variables: Vec<Variable>,
    /// Length of the record dimension; 0 without records.
    pub(crate) records: usize,
    /// The HDF5 file of netCDF-4; `None` in the classic formats.
    pub(crate) hdf5: Option<Hdf5<'a>>,
}

/// A variable of a netCDF file.
pub(crate) struct Variable {
    pub(crate) name: Vec<u8>,
    /// Lengths of the dimensions except the record dimension.
    pub(crate) shape: Vec<u64>,
    pub(crate) is_record: bool,
    pub(crate) number: NumberType,
    pub(crate) order: ByteOrder,
    pub(super) attributes: Vec<Attribute>,
    /// Size in bytes of the variable, or of each record if the variable has records.
    pub(crate) size: usize,
    pub(super) content: Content,
}

/// Location of the values of a variable in the file.
pub(super) enum Content {
    /// Classic formats: the offset of record 0, and the distance from each record to the next in bytes.
    Bytes { begin: usize, stride: usize },
    /// NetCDF-4: a dataset of the HDF5 file.
    Dataset(Box<Dataset>),
}

impl Variable {
    fn attribute(&self, name: &str) -> Option<&Attribute> {
        self.attributes.iter().find(|attribute| attribute.name == name.as_bytes())
    }

    /// Returns the text of an attribute; `None` if the attribute is missing or not text.
    pub(crate) fn text(&self, attribute: &str) -> Option<&[u8]> {
        self.attribute(attribute)?.text()
    }

    /// Returns the first number of an attribute as an integer; `None` if the attribute is missing or the number has a
    /// fraction.
    pub(crate) fn whole(&self, attribute: &str) -> Option<i64> {
        self.attribute(attribute)?.whole()
    }

    /// Returns the value that marks a missing number: the attribute `_FillValue`, else `missing_value`.
    pub(crate) fn missing(&self) -> Option<f64> {
        ["_FillValue", "missing_value"].iter().find_map(|name| self.attribute(name)?.real())
    }

    /// Returns the factor and the offset of packed numbers, by the CF conventions, section 8.1: stored numbers times
    /// `scale_factor`, plus `add_offset`. `None` for numbers that are not packed.
    pub(crate) fn packing(&self) -> Option<[f64; 2]> {
        let number = |name: &str, absent| {
            self.attribute(name)
                .and_then(Attribute::real)
                .filter(|x| x.is_finite())
                .unwrap_or(absent)
        };
        let packing = [number("scale_factor", 1.0), number("add_offset", 0.0)];
        (packing != [1.0, 0.0]).then_some(packing)
    }

    /// Decodes `bytes`, a part of the variable's values, as real numbers. Empty if the variable has another type.
    pub(crate) fn reals(&self, bytes: &[u8]) -> Vec<f64> {
        match self.number {
            NumberType::Real(_) => self.numbers(bytes),
            _ => Vec::new(),
        }
    }

    /// Decodes `bytes`, a part of the variable's values, as real numbers or integers. Empty if the variable has another
    /// type.
    pub(crate) fn numbers(&self, bytes: &[u8]) -> Vec<f64> {
        let each = bytes.chunks_exact(self.number.bytes().max(1));
        match self.number {
            NumberType::Real(precision) => each.map(|x| self.order.real(precision, x)).collect(),
            NumberType::Whole(number) => {
                each.map(|x| self.order.integer_as_real(number, x)).collect()
            }
            NumberType::Text | NumberType::Other(_) => Vec::new(),
        }
    }
}

/// The values of a variable as bytes.
pub(crate) struct Items<'a> {
    /// The whole file in the classic formats; the decoded dataset in netCDF-4.
    pub(crate) bytes: Cow<'a, [u8]>,
    /// Offset of record 0 in `bytes`.
    first: usize,
    /// Distance from each record to the next, in bytes.
    stride: usize,
    /// Size of a record in bytes.
    size: usize,
    /// The dataset of netCDF-4, whose own bytes were moved to `bytes`; `None` in the classic formats.
    pub(crate) array: Option<DatasetArray<'a>>,
}

impl<'a> Items<'a> {
    /// Returns the range of a record in `bytes`. Record 0 of a variable without records is the whole variable.
    pub(crate) fn range(&self, record: usize) -> Range<usize> {
        let start = self.first + record * self.stride;
        start..start + self.size
    }

    /// Returns the bytes of record 0, which is all of a variable without records.
    pub(crate) fn own(&self) -> &[u8] {
        self.bytes.get(self.range(0)).unwrap_or_default()
    }

    /// Returns the offset of record 0 in the file; `None` if the values are chunked, compressed or under a checksum.
    pub(crate) fn start(&self) -> Option<usize> {
        self.array.as_ref().map_or(Some(self.first), DatasetArray::start)
    }

    /// Takes the dataset of netCDF-4 together with `bytes`, which become empty; `None` in the classic formats.
    pub(crate) fn take_array(&mut self) -> Option<DatasetArray<'a>> {
        let mut array = self.array.take()?;
        array.bytes = std::mem::take(&mut self.bytes);
        Some(array)
    }

    /// Returns the offset in the file at or near byte `at` of `bytes`, for messages.
    pub(crate) fn byte_of(&self, at: usize) -> usize {
        self.array.as_ref().map_or(at, |array| array.byte_of(at))
    }
}

impl<'a> Header<'a> {
    /// Reads the values of a variable.
    pub(crate) fn items(&self, variable: &Variable) -> Result<Items<'a>, ReadError> {
        let size = variable.size;
        match (&variable.content, &self.hdf5) {
            (Content::Dataset(dataset), Some(file)) => {
                let mut array = file.array(dataset)?;
                let bytes = std::mem::take(&mut array.bytes);
                Ok(Items { bytes, first: 0, stride: size, size, array: Some(array) })
            }
            (&Content::Bytes { begin, stride }, _) => {
                let bytes = Cow::Borrowed(&self.source.bytes[..]);
                Ok(Items { bytes, first: begin, stride, size, array: None })
            }
            (Content::Dataset(_), None) => {
                Err(self.source.error("it is not HDF5", "Write the mesh again"))
            }
        }
    }

    /// Returns an offset near a variable, for messages: of record 0, or of the object header in netCDF-4.
    pub(crate) fn start_of(&self, variable: &Variable) -> usize {
        match &variable.content {
            Content::Bytes { begin, .. } => *begin,
            Content::Dataset(dataset) => dataset.at,
        }
    }

    /// Returns the integers of a variable, of record 0 only; `None` if the variable has another type or cannot be read.
    pub(crate) fn integers(&self, variable: &Variable) -> Option<Vec<i64>> {
        let NumberType::Whole(number) = variable.number else { return None };
        let items = self.items(variable).ok()?;
        let each = items.own().chunks_exact(number.bytes);
        Some(each.map(|own| variable.order.integer(number, own)).collect())
    }

    /// Returns the rows of a table of characters, each up to its first zero byte and without blanks around the text.
    /// Empty for variables of other types, and for variables with records.
    pub(crate) fn texts(&self, variable: &Variable) -> Vec<Vec<u8>> {
        let width = variable.shape.last().map_or(1, |&width| width as usize).max(1);
        let is_table = variable.number == NumberType::Text && !variable.is_record;
        let Some(items) = is_table.then(|| self.items(variable).ok()).flatten() else {
            return Vec::new();
        };
        let rows = items.own().chunks_exact(width).map(|row| {
            let end = memchr::memchr(0, row).unwrap_or(row.len());
            row[..end].trim_ascii().to_vec()
        });
        rows.collect()
    }

    /// Returns the number of records of a variable; 1 for a variable without records.
    pub(crate) fn steps(&self, variable: &Variable) -> usize {
        if variable.is_record { self.records } else { 1 }
    }

    /// Returns the length of a dimension; `None` if no dimension has this name.
    pub(crate) fn dimension(&self, name: &str) -> Option<u64> {
        let found = self.dimensions.iter().find(|(own, _)| own == name.as_bytes());
        found.map(|&(_, length)| length)
    }

    /// Returns the error of the first HDF5 dataset with a wanted name that cannot be opened: damaged, or with an
    /// unsupported filter. `None` if every wanted dataset opens, or if the file is not HDF5.
    pub(crate) fn unread(&self, is_wanted: impl Fn(&[u8]) -> bool) -> Option<ReadError> {
        let file = self.hdf5.as_ref()?;
        let mut wanted = file.children(file.root()).filter(|(name, _)| is_wanted(name));
        wanted.find_map(|(_, object)| file.dataset(object).err())
    }

    /// Returns the variable of this name.
    pub(crate) fn variable(&self, name: &str) -> Option<&Variable> {
        self.variables.iter().find(|variable| variable.name == name.as_bytes())
    }

    /// Returns the variables whose name is `name` followed by a positive number, ascending by this number.
    pub(crate) fn numbered(&self, name: &str) -> Vec<(usize, &Variable)> {
        let number = |variable: &Variable| -> Option<usize> {
            let digits = variable.name.strip_prefix(name.as_bytes())?;
            let is_number = !digits.is_empty() && digits.iter().all(u8::is_ascii_digit);
            str::from_utf8(digits).ok().filter(|_| is_number)?.parse().ok().filter(|&n| n > 0)
        };
        let of = |variable| Some((number(variable)?, variable));
        let mut found: Vec<_> = self.variables.iter().filter_map(of).collect();
        found.sort_by_key(|&(number, _)| number);
        found
    }
}
