//! The header of a netCDF file in the classic format, with 64-bit offsets or as CDF-5, which locates each variable.
//!
//! The format: <https://docs.unidata.ucar.edu/nug/current/file_format_specifications.html>. All numbers are big-endian.
//! Variables with records come last: record 0 of each variable, then record 1 of each, and so on.

use super::attribute::Attribute;
use super::header::{Content, Header, Variable};
use super::types::{ATTRIBUTES, DIMENSIONS, NumberType, VARIABLES};
use crate::binary::byte_order::ByteOrder;
use crate::disk::source::Source;
use crate::error::ReadError;
use crate::text::cursor::{CUT_OFF, Cursor};

const ORDER: ByteOrder = ByteOrder::Big;

/// A variable as the header of the file describes it.
struct VariableEntry {
    name: Vec<u8>,
    shape: Vec<u64>,
    is_record: bool,
    number: NumberType,
    attributes: Vec<Attribute>,
    begin: usize,
    size: usize,
}

impl VariableEntry {
    /// Makes the variable, whose records are `stride` bytes apart.
    fn with(self, stride: usize) -> Variable {
        let VariableEntry { name, shape, is_record, number, attributes, begin, size } = self;
        let content = Content::Bytes { begin, stride };
        Variable { name, shape, is_record, number, order: ORDER, attributes, size, content }
    }
}

/// Reads the header, and checks that variables lie in the file and do not overlap.
pub(super) fn read(source: &Source) -> Result<Header<'_>, ReadError> {
    let mut reader = HeaderReader { cursor: Cursor::new(source), count: 4, offset: 4 };
    match source.bytes.get(3) {
        Some(1) => {}
        Some(2) => reader.offset = 8,
        Some(5) => (reader.count, reader.offset) = (8, 8),
        _ => {
            let problem = "the version of netCDF is not known";
            let start = Cursor::at_byte_offset(source, 0);
            return Err(start.error(problem, "Versions 1, 2 and 5 are read"));
        }
    }
    reader.take(4)?;
    let records = reader.number(reader.count)?;
    let mut dimensions = Vec::new();
    for _ in 0..reader.list(DIMENSIONS)? {
        dimensions.push((reader.name()?, reader.number(reader.count)?));
    }
    for _ in 0..reader.list(ATTRIBUTES)? {
        reader.attribute()?;
    }
    let mut variables = Vec::new();
    for _ in 0..reader.list(VARIABLES)? {
        variables.push(reader.variable(&dimensions)?);
    }
    let start = reader.cursor.at_byte();
    let (records, stride) = variable_entries(&variables, source, start, records, &reader)?;
    let variables = variables.into_iter().map(|variable| variable.with(stride)).collect();
    Ok(Header { source, dimensions, variables, records, hdf5: None })
}

/// Returns the number of records and their distance in bytes. Checks that variables lie in the file and do not overlap
/// each other or the header, which ends at offset `start`. `records` is the header's field for the number of records.
fn variable_entries(
    variables: &[VariableEntry],
    source: &Source,
    start: usize,
    records: u64,
    reader: &HeaderReader<'_>,
) -> Result<(usize, usize), ReadError> {
    let length = source.bytes.len();
    let of_records = || variables.iter().filter(|variable| variable.is_record);
    let padded = |variable: &VariableEntry| variable.size.checked_next_multiple_of(4);
    let stride = match of_records().count() {
        // Without other variables with records, records follow each other without padding.
        1 => of_records().map(|variable| variable.size).sum(),
        _ => {
            let sum = of_records().try_fold(0, |sum: usize, v| sum.checked_add(padded(v)?));
            sum.unwrap_or(usize::MAX)
        }
    };
    let first = of_records().map(|variable| variable.begin).min().unwrap_or(length);
    // All bits set mark a file of a streaming writer: the length of the file gives the number of records.
    let unknown = if reader.count == 8 { u64::MAX } else { u64::from(u32::MAX) };
    let records = match records {
        _ if stride == 0 => 0,
        records if records == unknown => length.saturating_sub(first) / stride,
        records => usize::try_from(records).unwrap_or(usize::MAX),
    };
    let beyond = |variable: &VariableEntry| {
        let problem = format!("{} ends beyond the file", String::from_utf8_lossy(&variable.name));
        Err(reader.cursor.error(problem, CUT_OFF))
    };
    let mut ranges = vec![(0..start, "the header".to_owned())];
    for variable in variables {
        let last = if variable.is_record { records.saturating_sub(1) } else { 0 };
        let end = last
            .checked_mul(stride)
            .and_then(|skipped| variable.begin.checked_add(skipped)?.checked_add(variable.size));
        let is_empty = variable.size == 0 || (variable.is_record && records == 0);
        if !is_empty && end.is_none_or(|end| end > length) {
            return beyond(variable);
        }
        if !is_empty {
            let name = String::from_utf8_lossy(&variable.name).into_owned();
            ranges.push((variable.begin..variable.begin + variable.size, name));
            if variable.is_record
                && variable.begin.saturating_add(variable.size) > first.saturating_add(stride)
            {
                return Err(reader.cursor.error("its records overlap", "Write the mesh again"));
            }
        }
    }
    if records > 1 {
        let end = first.saturating_add(records.saturating_mul(stride));
        ranges.push((first.saturating_add(stride)..end, "the records".to_owned()));
    }
    ranges.sort_by_key(|(range, _)| (range.start, range.end));
    for pair in ranges.windows(2) {
        let [(one, name), (other, other_name)] = pair else { continue };
        if one.end > other.start {
            let problem = format!("{name} and {other_name} overlap");
            return Err(reader.cursor.error(problem, "Write the mesh again"));
        }
    }
    Ok((records, stride))
}

/// Reader of the fields of the header.
struct HeaderReader<'a> {
    cursor: Cursor<'a>,
    /// Width of a count in bytes: 8 in CDF-5, else 4.
    count: usize,
    /// Width of an offset in bytes: 4 in the classic format (version 1), else 8.
    offset: usize,
}

impl<'a> HeaderReader<'a> {
    fn take(&mut self, bytes: usize) -> Result<&'a [u8], ReadError> {
        let start = self.cursor.clone();
        let taken = self.cursor.take(bytes);
        taken.ok_or_else(|| start.error("the file ends within its header", CUT_OFF))
    }

    fn number(&mut self, bytes: usize) -> Result<u64, ReadError> {
        Ok(ORDER.whole(self.take(bytes)?))
    }

    /// Takes the tag and the length of a list, and returns the length. An absent list has two zeros instead.
    fn list(&mut self, tag: u32) -> Result<u64, ReadError> {
        let found = self.number(4)? as u32;
        let count = self.number(self.count)?;
        match found {
            _ if found == tag || (found == 0 && count == 0) => Ok(count),
            _ => Err(self.cursor.error("the header is damaged", "Write the mesh again")),
        }
    }

    /// Takes `bytes` bytes and their padding to a multiple of four. Returns the bytes without padding.
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

    fn number_type(&mut self) -> Result<NumberType, ReadError> {
        let number = self.number(4)? as u32;
        NumberType::of_type(number).ok_or_else(|| {
            let problem = format!("numbers of the unknown type {number}");
            self.cursor.error(problem, "Write the mesh again")
        })
    }

    fn attribute(&mut self) -> Result<Attribute, ReadError> {
        let name = self.name()?;
        let number = self.number_type()?;
        let count = self.number(self.count)?;
        let bytes = self.padded(count.saturating_mul(number.bytes() as u64))?.to_vec();
        Ok(Attribute { name, number, order: ORDER, bytes })
    }

    fn variable(&mut self, dimensions: &[(Vec<u8>, u64)]) -> Result<VariableEntry, ReadError> {
        let name = self.name()?;
        let (mut shape, mut is_record) = (Vec::new(), false);
        for axis in 0..self.number(self.count)? {
            let number = self.number(self.count)?;
            let found = usize::try_from(number).ok().and_then(|number| dimensions.get(number));
            match found {
                // Length 0 marks the record dimension.
                Some((_, 0)) if axis == 0 => is_record = true,
                Some((_, length)) => shape.push(*length),
                None => {
                    let problem = format!("a variable has dimension {number}, which is not listed");
                    return Err(self.cursor.error(problem, "Write the mesh again"));
                }
            }
        }
        let mut attributes = Vec::new();
        for _ in 0..self.list(ATTRIBUTES)? {
            attributes.push(self.attribute()?);
        }
        let number = self.number_type()?;
        // The size in the header is ignored: its field is too narrow for the largest variables.
        self.number(self.count)?;
        let begin = usize::try_from(self.number(self.offset)?).unwrap_or(usize::MAX);
        let size = shape.iter().try_fold(number.bytes() as u64, |size, &n| size.checked_mul(n));
        let size = size.and_then(|size| usize::try_from(size).ok()).unwrap_or(usize::MAX);
        Ok(VariableEntry { name, shape, is_record, number, attributes, begin, size })
    }
}
