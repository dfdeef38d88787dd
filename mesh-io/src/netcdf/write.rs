//! Writes netCDF's classic format with 64-bit offsets.
//!
//! The format: <https://docs.unidata.ucar.edu/nug/current/file_format_specifications.html>. Numbers are big-endian.
//! Variables with records follow all other variables; a file has at most one record.

use super::types::{ATTRIBUTES, CHAR, DIMENSIONS, DOUBLE, FLOAT, INT, VARIABLES};
use std::collections::HashMap;

/// Builder of a file in the classic netCDF format.
#[derive(Default)]
pub(crate) struct NetCdfWriter {
    dimensions: Vec<(String, usize)>,
    /// Index of each dimension by name. An Exodus file has dimensions for each block of elements, possibly as many
    /// blocks as elements, so a search of the list would be too slow.
    dimension_indices: HashMap<String, usize>,
    attributes: Vec<(&'static str, Values)>,
    variables: Vec<Variable>,
}

struct Variable {
    name: String,
    /// The indices of the variable's dimensions.
    dimensions: Vec<usize>,
    is_record: bool,
    attributes: Vec<(&'static str, Values)>,
    values: Values,
}

/// Values of a variable or an attribute, with a common type.
pub(crate) enum Values {
    Text(Vec<u8>),
    Whole(Vec<i32>),
    Single(f32),
    Real(Vec<f64>),
}

impl Values {
    /// Makes a text of names, each padded with zeros to `width` bytes.
    pub(crate) fn names<'n>(names: impl IntoIterator<Item = &'n str>, width: usize) -> Values {
        let mut text = Vec::new();
        for name in names {
            let end = text.len() + width;
            text.extend_from_slice(name.as_bytes());
            text.resize(end, 0);
        }
        Values::Text(text)
    }

    /// Returns the code of the type, the number of values, and the big-endian bytes of the values.
    fn encoded(&self) -> (u32, usize, Vec<u8>) {
        match self {
            Values::Text(text) => (CHAR, text.len(), text.clone()),
            Values::Whole(numbers) => {
                (INT, numbers.len(), numbers.iter().flat_map(|n| n.to_be_bytes()).collect())
            }
            Values::Single(number) => (FLOAT, 1, number.to_be_bytes().to_vec()),
            Values::Real(numbers) => {
                (DOUBLE, numbers.len(), numbers.iter().flat_map(|n| n.to_be_bytes()).collect())
            }
        }
    }
}

impl NetCdfWriter {
    pub(crate) fn attribute(&mut self, name: &'static str, values: Values) {
        self.attributes.push((name, values));
    }

    /// Adds a dimension. A dimension of length 0 is the record dimension.
    pub(crate) fn dimension(&mut self, name: impl Into<String>, length: usize) {
        let name = name.into();
        self.dimension_indices.insert(name.clone(), self.dimensions.len());
        self.dimensions.push((name, length));
    }

    pub(crate) fn has_dimension(&self, name: &str) -> bool {
        self.dimension_indices.contains_key(name)
    }

    /// Adds a variable over dimensions that were added before; without dimensions, the variable has a single value.
    pub(crate) fn variable(
        &mut self,
        name: impl Into<String>,
        dimensions: &[&str],
        attributes: Vec<(&'static str, Values)>,
        values: Values,
    ) {
        let place = |name: &&str| self.dimension_indices.get(*name).copied();
        let dimensions: Vec<usize> = dimensions.iter().filter_map(place).collect();
        let is_record = dimensions.first().is_some_and(|&first| self.dimensions[first].1 == 0);
        let name = name.into();
        self.variables.push(Variable { name, dimensions, is_record, attributes, values });
    }

    /// Returns the bytes of the file.
    pub(crate) fn bytes(mut self) -> Vec<u8> {
        // Variables with records come after all others.
        self.variables.sort_by_key(|variable| variable.is_record);
        let has_records =
            self.variables.iter().any(|v| v.is_record && !v.values.encoded().2.is_empty());
        let contents: Vec<Vec<u8>> = self.variables.iter().map(Variable::content).collect();
        let header = self.header(has_records, &contents, 0).len();
        let mut bytes = self.header(has_records, &contents, header);
        contents.iter().for_each(|content| bytes.extend_from_slice(content));
        bytes
    }

    /// Returns the header, for contents that start at byte `start`.
    fn header(&self, has_records: bool, contents: &[Vec<u8>], mut start: usize) -> Vec<u8> {
        let mut out = b"CDF\x02".to_vec();
        word(&mut out, usize::from(has_records));
        list(&mut out, DIMENSIONS, self.dimensions.len());
        for (dimension, length) in &self.dimensions {
            name(&mut out, dimension);
            word(&mut out, *length);
        }
        attributes(&mut out, &self.attributes);
        list(&mut out, VARIABLES, self.variables.len());
        for (variable, content) in self.variables.iter().zip(contents) {
            name(&mut out, &variable.name);
            word(&mut out, variable.dimensions.len());
            variable.dimensions.iter().for_each(|&dimension| word(&mut out, dimension));
            attributes(&mut out, &variable.attributes);
            out.extend_from_slice(&variable.values.encoded().0.to_be_bytes());
            word(&mut out, content.len());
            out.extend_from_slice(&(start as u64).to_be_bytes());
            start += content.len();
        }
        out
    }
}

impl Variable {
    /// Returns the bytes of the values, padded to a multiple of four.
    fn content(&self) -> Vec<u8> {
        let mut content = self.values.encoded().2;
        content.resize(content.len().next_multiple_of(4), 0);
        content
    }
}

/// Appends a number in 4 bytes. Larger numbers become `u32::MAX`: only the sizes of variables can be so large, and
/// readers compute sizes from the dimensions.
fn word(out: &mut Vec<u8>, number: usize) {
    out.extend_from_slice(&u32::try_from(number).unwrap_or(u32::MAX).to_be_bytes());
}

fn list(out: &mut Vec<u8>, tag: u32, count: usize) {
    word(out, if count == 0 { 0 } else { tag as usize });
    word(out, count);
}

fn name(out: &mut Vec<u8>, name: &str) {
    word(out, name.len());
    out.extend_from_slice(name.as_bytes());
    out.resize(out.len().next_multiple_of(4), 0);
}

fn attributes(out: &mut Vec<u8>, attributes: &[(&'static str, Values)]) {
    list(out, ATTRIBUTES, attributes.len());
    for (own, values) in attributes {
        name(out, own);
        let (number, count, bytes) = values.encoded();
        out.extend_from_slice(&number.to_be_bytes());
        word(out, count);
        out.extend_from_slice(&bytes);
        out.resize(out.len().next_multiple_of(4), 0);
    }
}
