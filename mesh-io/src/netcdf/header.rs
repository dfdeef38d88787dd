//! What a netCDF file holds, whichever format it is in: dimensions and variables by name.

use super::attribute::Attribute;
use super::types::NumberType;
use crate::binary::byte_order::ByteOrder;
use crate::disk::source::Source;
use crate::error::ReadError;
use crate::hdf5::{Dataset, DatasetArray, Hdf5};
use std::borrow::Cow;
use std::ops::Range;

/// The dimensions and variables of a file. No two of the variables overlap, and none ends beyond the file.
pub(crate) struct Header<'a> {
    pub(crate) source: &'a Source,
    pub(crate) dimensions: Vec<(Vec<u8>, u64)>,
    pub(crate) variables: Vec<Variable>,
    /// How many records there are.
    pub(crate) records: usize,
    /// The file, if it is HDF5.
    pub(crate) hdf5: Option<Hdf5<'a>>,
}

/// A variable of a netCDF file.
pub(crate) struct Variable {
    pub(crate) name: Vec<u8>,
    /// Its lengths, but for the record dimension.
    pub(crate) shape: Vec<u64>,
    pub(crate) is_record: bool,
    pub(crate) number: NumberType,
    pub(crate) order: ByteOrder,
    pub(super) attributes: Vec<Attribute>,
    /// How many bytes it has, in each record if it is of records.
    pub(crate) size: usize,
    pub(super) content: Content,
}

/// Where the content of a variable stands.
pub(super) enum Content {
    /// From this byte of the file on; each record so many bytes after the one before.
    Bytes {
        begin: usize,
        stride: usize,
    },
    Dataset(Dataset),
}

impl Variable {
    fn attribute(&self, name: &str) -> Option<&Attribute> {
        self.attributes.iter().find(|attribute| attribute.name == name.as_bytes())
    }

    /// The text of an attribute, if it has one.
    pub(crate) fn text(&self, attribute: &str) -> Option<&[u8]> {
        self.attribute(attribute)?.text()
    }

    /// The first number of an attribute, if that is whole.
    pub(crate) fn whole(&self, attribute: &str) -> Option<i64> {
        self.attribute(attribute)?.whole()
    }

    /// The number that stands where there is none, if the file names one.
    pub(crate) fn missing(&self) -> Option<f64> {
        ["_FillValue", "missing_value"].iter().find_map(|name| self.attribute(name)?.real())
    }

    /// The real numbers in these bytes of it; none if it has others.
    pub(crate) fn reals(&self, bytes: &[u8]) -> Vec<f64> {
        match self.number {
            NumberType::Real(_) => self.numbers(bytes),
            _ => Vec::new(),
        }
    }

    /// The numbers in these bytes of it, real or whole; none if it has text.
    pub(crate) fn numbers(&self, bytes: &[u8]) -> Vec<f64> {
        let each = bytes.chunks_exact(self.number.bytes().max(1));
        match self.number {
            NumberType::Real(precision) => each.map(|x| self.order.real(precision, x)).collect(),
            NumberType::Whole(_) => each.map(|x| self.order.signed(x) as f64).collect(),
            NumberType::Text | NumberType::Other(_) => Vec::new(),
        }
    }
}

/// The content of a variable.
pub(crate) struct Items<'a> {
    /// Bytes that it stands in, and where its records start there.
    pub(crate) bytes: Cow<'a, [u8]>,
    first: usize,
    stride: usize,
    size: usize,
    /// What these bytes are, if they are not those of the file.
    pub(crate) array: Option<DatasetArray<'a>>,
}

impl<'a> Items<'a> {
    /// Where a record is among the bytes; of a variable without records all of it.
    pub(crate) fn range(&self, record: usize) -> Range<usize> {
        let start = self.first + record * self.stride;
        start..start + self.size
    }

    /// All of a variable without records.
    pub(crate) fn own(&self) -> &[u8] {
        self.bytes.get(self.range(0)).unwrap_or_default()
    }

    /// Where in the file it starts, if it stands there as it is.
    pub(crate) fn start(&self) -> Option<usize> {
        self.array.as_ref().map_or(Some(self.first), DatasetArray::start)
    }

    /// Takes out what it is, with its bytes, if these are not those of the file.
    pub(crate) fn take_array(&mut self) -> Option<DatasetArray<'a>> {
        let mut array = self.array.take()?;
        array.bytes = std::mem::take(&mut self.bytes);
        Some(array)
    }

    /// The byte of the file at or near which this one of the bytes stands.
    pub(crate) fn byte_of(&self, at: usize) -> usize {
        self.array.as_ref().map_or(at, |array| array.byte_of(at))
    }
}

impl<'a> Header<'a> {
    /// The content of a variable.
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

    /// Near which byte a variable stands, for messages.
    pub(crate) fn start_of(&self, variable: &Variable) -> usize {
        match &variable.content {
            Content::Bytes { begin, .. } => *begin,
            Content::Dataset(dataset) => dataset.at,
        }
    }

    /// The whole numbers of a variable; none if it has others.
    pub(crate) fn integers(&self, variable: &Variable) -> Option<Vec<i64>> {
        let NumberType::Whole(bytes) = variable.number else { return None };
        let items = self.items(variable).ok()?;
        Some(items.own().chunks_exact(bytes).map(|n| variable.order.signed(n)).collect())
    }

    /// The texts of a variable, the rows of a table of letters, without what fills them up.
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

    /// How many records a variable has; one if it has none.
    pub(crate) fn steps(&self, variable: &Variable) -> usize {
        if variable.is_record { self.records } else { 1 }
    }

    /// The length of a dimension.
    pub(crate) fn dimension(&self, name: &str) -> Option<u64> {
        let found = self.dimensions.iter().find(|(own, _)| own == name.as_bytes());
        found.map(|&(_, length)| length)
    }

    /// Why a dataset of one of these names is no variable: it is damaged, or packed by a filter that is not read. None if there is
    /// no such dataset.
    pub(crate) fn unread(&self, is_wanted: impl Fn(&[u8]) -> bool) -> Option<ReadError> {
        let file = self.hdf5.as_ref()?;
        let mut wanted = file.children(file.root()).filter(|(name, _)| is_wanted(name));
        wanted.find_map(|(_, object)| file.dataset(object).err())
    }

    /// The variable of a name.
    pub(crate) fn variable(&self, name: &str) -> Option<&Variable> {
        self.variables.iter().find(|variable| variable.name == name.as_bytes())
    }

    /// The variables called so with a number after it, in the order of these.
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
