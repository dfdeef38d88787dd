//! The header of a netCDF file in the classic format, with 64-bit offsets or as CDF-5: where each variable stands.
//!
//! The format: <https://docs.unidata.ucar.edu/nug/current/file_format_specifications.html>. All numbers have their highest byte
//! first. Variables of the record dimension come at the end, one record after another.

use crate::error::ReadError;
use crate::file::binary::Order;
use crate::file::source::Source;
use crate::file::text::{CUT_OFF, Cursor};
use crate::mesh::Precision;
use std::ops::Range;

const ORDER: Order = Order::Big;

/// The dimensions and variables of a file. No two of the variables overlap, and none ends beyond the file.
pub(super) struct Header {
    dimensions: Vec<(Vec<u8>, u64)>,
    pub(super) variables: Vec<Variable>,
    /// How many records there are, and how many bytes after one the next starts.
    pub(super) records: usize,
    stride: usize,
}

/// A variable of a netCDF file.
pub(super) struct Variable {
    pub(super) name: Vec<u8>,
    /// Its lengths, but for the record dimension.
    pub(super) shape: Vec<u64>,
    pub(super) is_record: bool,
    pub(super) number: Number,
    /// The content of its attribute `elem_type`.
    pub(super) element_type: Option<Vec<u8>>,
    /// Where it starts, and how many bytes it has, in each record if it is of records.
    begin: usize,
    size: usize,
}

/// The types of numbers that are told apart.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Number {
    Text,
    Whole(usize),
    Real(Precision),
}

impl Number {
    fn bytes(self) -> usize {
        match self {
            Number::Text => 1,
            Number::Whole(bytes) => bytes,
            Number::Real(precision) => precision.bytes(),
        }
    }
}

impl Variable {
    /// Its bytes in a record; all of them if it is not of records.
    pub(super) fn range(&self, header: &Header, record: usize) -> Range<usize> {
        let start = self.begin + record * header.stride;
        start..start + self.size
    }

    /// Where it starts.
    pub(super) fn begin(&self) -> usize {
        self.begin
    }

    /// Its whole numbers; none if it has others.
    pub(super) fn integers(&self, source: &Source) -> Option<Vec<i64>> {
        let Number::Whole(bytes) = self.number else { return None };
        let content = &source.bytes[self.begin..self.begin + self.size];
        Some(content.chunks_exact(bytes).map(|number| ORDER.signed(number)).collect())
    }

    /// Its texts, the rows of a table of letters, without what fills them up.
    pub(super) fn texts<'a>(&self, source: &'a Source) -> Vec<&'a [u8]> {
        let width = self.shape.last().map_or(1, |&width| width as usize).max(1);
        let content = &source.bytes[self.begin..self.begin + self.size];
        let is_table = self.number == Number::Text && !self.is_record;
        let rows = content.chunks_exact(width).map(|row| {
            let end = memchr::memchr(0, row).unwrap_or(row.len());
            row[..end].trim_ascii()
        });
        if is_table { rows.collect() } else { Vec::new() }
    }
}

impl Header {
    /// Reads the header and checks that all variables lie in the file, each by itself.
    pub(super) fn read(source: &Source) -> Result<Header, ReadError> {
        let mut reader = Reader { cursor: Cursor::new(source), count: 4, offset: 4 };
        match source.bytes.get(3) {
            Some(1) => {}
            Some(2) => reader.offset = 8,
            Some(5) => (reader.count, reader.offset) = (8, 8),
            _ => {
                let problem = "netCDF of an unknown version";
                let start = Cursor::at_byte_of(source, 0);
                return Err(start.error(problem, "Versions 1, 2 and 5 are read"));
            }
        }
        reader.take(4)?;
        let records = reader.number(reader.count)?;
        let mut dimensions = Vec::new();
        for _ in 0..reader.list(10)? {
            dimensions.push((reader.name()?, reader.number(reader.count)?));
        }
        for _ in 0..reader.list(12)? {
            reader.attribute()?;
        }
        let mut variables = Vec::new();
        for _ in 0..reader.list(11)? {
            variables.push(reader.variable(&dimensions)?);
        }
        let start = reader.cursor.at_byte();
        Header { dimensions, variables, records: 0, stride: 0 }
            .placed(source, start, records, &reader)
    }

    /// Finds how records lie, and checks the places of all variables.
    fn placed(
        mut self,
        source: &Source,
        start: usize,
        records: u64,
        reader: &Reader<'_>,
    ) -> Result<Header, ReadError> {
        let length = source.bytes.len();
        let of_records = || self.variables.iter().filter(|variable| variable.is_record);
        let padded = |variable: &Variable| variable.size.checked_next_multiple_of(4);
        self.stride = match of_records().count() {
            // The records of a single variable follow each other without a gap.
            1 => of_records().map(|variable| variable.size).sum(),
            _ => {
                let sum = of_records().try_fold(0, |sum: usize, v| sum.checked_add(padded(v)?));
                sum.unwrap_or(usize::MAX)
            }
        };
        let first = of_records().map(|variable| variable.begin).min().unwrap_or(length);
        // All bits set stand for as many as the file holds.
        let unknown = if reader.count == 8 { u64::MAX } else { u64::from(u32::MAX) };
        self.records = match records {
            _ if self.stride == 0 => 0,
            records if records == unknown => length.saturating_sub(first) / self.stride,
            records => usize::try_from(records).unwrap_or(usize::MAX),
        };
        let beyond = |variable: &Variable| {
            let problem =
                format!("{} ends beyond the file", String::from_utf8_lossy(&variable.name));
            Err(reader.cursor.error(problem, CUT_OFF))
        };
        let mut ranges = vec![(0..start, "the header".to_owned())];
        for variable in &self.variables {
            let last = if variable.is_record { self.records.saturating_sub(1) } else { 0 };
            let end = last.checked_mul(self.stride).and_then(|skipped| {
                variable.begin.checked_add(skipped)?.checked_add(variable.size)
            });
            let is_empty = variable.size == 0 || (variable.is_record && self.records == 0);
            if !is_empty && end.is_none_or(|end| end > length) {
                return beyond(variable);
            }
            if !is_empty {
                let name = String::from_utf8_lossy(&variable.name).into_owned();
                ranges.push((variable.begin..variable.begin + variable.size, name));
                if variable.is_record
                    && variable.begin.saturating_add(variable.size)
                        > first.saturating_add(self.stride)
                {
                    return Err(reader.cursor.error("its records overlap", "Write the mesh again"));
                }
            }
        }
        if self.records > 1 {
            let end = first.saturating_add(self.records.saturating_mul(self.stride));
            ranges.push((first.saturating_add(self.stride)..end, "the records".to_owned()));
        }
        ranges.sort_by_key(|(range, _)| (range.start, range.end));
        for pair in ranges.windows(2) {
            let [(one, name), (other, other_name)] = pair else { continue };
            if one.end > other.start {
                let problem = format!("{name} and {other_name} overlap");
                return Err(reader.cursor.error(problem, "Write the mesh again"));
            }
        }
        Ok(self)
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

/// Takes what a header consists of.
struct Reader<'a> {
    cursor: Cursor<'a>,
    /// How many bytes a count has, and an offset.
    count: usize,
    offset: usize,
}

impl<'a> Reader<'a> {
    fn take(&mut self, bytes: usize) -> Result<&'a [u8], ReadError> {
        let start = self.cursor.clone();
        let taken = self.cursor.take(bytes);
        taken.ok_or_else(|| start.error("the file ends within its header", CUT_OFF))
    }

    fn number(&mut self, bytes: usize) -> Result<u64, ReadError> {
        Ok(ORDER.whole(self.take(bytes)?))
    }

    /// Takes the tag and the length of a list.
    fn list(&mut self, tag: u64) -> Result<u64, ReadError> {
        let found = self.number(4)?;
        let count = self.number(self.count)?;
        match found {
            _ if found == tag || (found == 0 && count == 0) => Ok(count),
            _ => Err(self.cursor.error("the header is damaged", "Write the mesh again")),
        }
    }

    /// Takes bytes that are filled up to a multiple of four.
    fn padded(&mut self, bytes: u64) -> Result<&'a [u8], ReadError> {
        let bytes = usize::try_from(bytes).unwrap_or(usize::MAX);
        let taken = self.take(bytes)?;
        self.take((4 - bytes % 4) % 4)?;
        Ok(taken)
    }

    fn name(&mut self) -> Result<Vec<u8>, ReadError> {
        let bytes = self.number(self.count)?;
        Ok(self.padded(bytes)?.to_vec())
    }

    fn number_type(&mut self) -> Result<Number, ReadError> {
        Ok(match self.number(4)? {
            2 => Number::Text,
            1 | 7 => Number::Whole(1),
            3 | 8 => Number::Whole(2),
            4 | 9 => Number::Whole(4),
            10 | 11 => Number::Whole(8),
            5 => Number::Real(Precision::Single),
            6 => Number::Real(Precision::Double),
            other => {
                let problem = format!("numbers of the unknown type {other}");
                return Err(self.cursor.error(problem, "Write the mesh again"));
            }
        })
    }

    /// Takes an attribute. Returns its name and, if it is text, its content.
    fn attribute(&mut self) -> Result<(Vec<u8>, Option<Vec<u8>>), ReadError> {
        let name = self.name()?;
        let number = self.number_type()?;
        let count = self.number(self.count)?;
        let content = self.padded(count.saturating_mul(number.bytes() as u64))?;
        Ok((name, (number == Number::Text).then(|| content.to_vec())))
    }

    fn variable(&mut self, dimensions: &[(Vec<u8>, u64)]) -> Result<Variable, ReadError> {
        let name = self.name()?;
        let (mut shape, mut is_record) = (Vec::new(), false);
        for axis in 0..self.number(self.count)? {
            let number = self.number(self.count)?;
            let found = usize::try_from(number).ok().and_then(|number| dimensions.get(number));
            match found {
                // The record dimension has no length of its own.
                Some((_, 0)) if axis == 0 => is_record = true,
                Some((_, length)) => shape.push(*length),
                None => {
                    let problem = format!("a variable has dimension {number}, which is not listed");
                    return Err(self.cursor.error(problem, "Write the mesh again"));
                }
            }
        }
        let mut element_type = None;
        for _ in 0..self.list(12)? {
            let (name, content) = self.attribute()?;
            if name == b"elem_type" {
                element_type = content;
            }
        }
        let number = self.number_type()?;
        // Its size stands here too, but need not be right where it is large.
        self.number(self.count)?;
        let begin = usize::try_from(self.number(self.offset)?).unwrap_or(usize::MAX);
        let size = shape.iter().try_fold(number.bytes() as u64, |size, &n| size.checked_mul(n));
        let size = size.and_then(|size| usize::try_from(size).ok()).unwrap_or(usize::MAX);
        Ok(Variable { name, shape, is_record, number, element_type, begin, size })
    }
}
