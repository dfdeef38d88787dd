//! What netCDF gives, whichever format it has its variables in: dimensions and variables by name.

use crate::error::ReadError;
use crate::file::binary::Order;
use crate::file::hdf5::{Array, Dataset, Hdf5};
use crate::file::source::Source;
use crate::precision::Precision;
use std::borrow::Cow;
use std::ops::Range;

/// The dimensions and variables of a file. No two of the variables overlap, and none ends beyond the file.
pub(super) struct Header<'a> {
    pub(super) source: &'a Source,
    pub(super) dimensions: Vec<(Vec<u8>, u64)>,
    pub(super) variables: Vec<Variable>,
    /// How many records there are.
    pub(super) records: usize,
    /// The file, if it is HDF5.
    pub(super) hdf5: Option<Hdf5<'a>>,
}

/// A variable of a netCDF file.
pub(super) struct Variable {
    pub(super) name: Vec<u8>,
    /// Its lengths, but for the record dimension.
    pub(super) shape: Vec<u64>,
    pub(super) is_record: bool,
    pub(super) number: Number,
    pub(super) order: Order,
    /// The content of its attribute `elem_type`.
    pub(super) element_type: Option<Vec<u8>>,
    /// How many bytes it has, in each record if it is of records.
    pub(super) size: usize,
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

/// The types of numbers that are told apart.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Number {
    Text,
    Whole(usize),
    Real(Precision),
    /// None that Exodus has.
    Other(usize),
}

impl Number {
    pub(super) fn bytes(self) -> usize {
        match self {
            Number::Text => 1,
            Number::Whole(bytes) | Number::Other(bytes) => bytes,
            Number::Real(precision) => precision.bytes(),
        }
    }
}

/// The content of a variable.
pub(super) struct Items<'a> {
    /// Bytes that it stands in, and where its records start there.
    pub(super) bytes: Cow<'a, [u8]>,
    first: usize,
    stride: usize,
    size: usize,
    /// What these bytes are, if they are not those of the file.
    pub(super) array: Option<Array<'a>>,
}

impl<'a> Items<'a> {
    /// Where a record is among the bytes; of a variable without records all of it.
    pub(super) fn range(&self, record: usize) -> Range<usize> {
        let start = self.first + record * self.stride;
        start..start + self.size
    }

    /// All of a variable without records.
    pub(super) fn own(&self) -> &[u8] {
        self.bytes.get(self.range(0)).unwrap_or_default()
    }

    /// Where in the file it starts, if it stands there as it is.
    pub(super) fn place(&self) -> Option<usize> {
        self.array.as_ref().map_or(Some(self.first), Array::place)
    }

    /// Takes out what it is, with its bytes, if these are not those of the file.
    pub(super) fn take_array(&mut self) -> Option<Array<'a>> {
        let mut array = self.array.take()?;
        array.bytes = std::mem::take(&mut self.bytes);
        Some(array)
    }

    /// The byte of the file at or near which this one of the bytes stands.
    pub(super) fn byte_of(&self, at: usize) -> usize {
        self.array.as_ref().map_or(at, |array| array.byte_of(at))
    }
}

impl<'a> Header<'a> {
    /// The content of a variable.
    pub(super) fn items(&self, variable: &Variable) -> Result<Items<'a>, ReadError> {
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
    pub(super) fn place(&self, variable: &Variable) -> usize {
        match &variable.content {
            Content::Bytes { begin, .. } => *begin,
            Content::Dataset(dataset) => dataset.at,
        }
    }

    /// The whole numbers of a variable; none if it has others.
    pub(super) fn integers(&self, variable: &Variable) -> Option<Vec<i64>> {
        let Number::Whole(bytes) = variable.number else { return None };
        let items = self.items(variable).ok()?;
        Some(items.own().chunks_exact(bytes).map(|n| variable.order.signed(n)).collect())
    }

    /// The texts of a variable, the rows of a table of letters, without what fills them up.
    pub(super) fn texts(&self, variable: &Variable) -> Vec<Vec<u8>> {
        let width = variable.shape.last().map_or(1, |&width| width as usize).max(1);
        let is_table = variable.number == Number::Text && !variable.is_record;
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
    pub(super) fn steps(&self, variable: &Variable) -> usize {
        if variable.is_record { self.records } else { 1 }
    }

    /// The length of a dimension.
    pub(super) fn dimension(&self, name: &str) -> Option<u64> {
        let found = self.dimensions.iter().find(|(own, _)| own == name.as_bytes());
        found.map(|&(_, length)| length)
    }

    /// The variable of a name.
    pub(super) fn variable(&self, name: &str) -> Option<&Variable> {
        self.variables.iter().find(|variable| variable.name == name.as_bytes())
    }

    /// The variables called so with a number after it, in the order of these.
    pub(super) fn numbered(&self, name: &str) -> Vec<(usize, &Variable)> {
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
