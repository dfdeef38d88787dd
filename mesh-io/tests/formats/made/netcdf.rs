//! Makes files in the three classic forms of netCDF.

use mesh_io::Precision;
use std::ops::Range;
use support::Binary;

/// A variable: name, type, dimensions and content. With records, the content is a single record.
struct Variable {
    name: String,
    number: i32,
    dimensions: Vec<&'static str>,
    content: Vec<u8>,
    attributes: Vec<(&'static str, Attribute)>,
}

/// Value of an attribute.
#[derive(Clone, Copy)]
pub(crate) enum Attribute {
    Text(&'static str),
    Whole(i32),
    Real(f64),
}

/// Builder of a file. `version` is 1, 2 (64-bit offsets) or 5 (64-bit counts and offsets).
pub(crate) struct NetCdf {
    out: Binary,
    pub(crate) version: u8,
    variables: Vec<Variable>,
}

/// A finished file, with the byte ranges of its variables and of the lengths of its dimensions, by name.
pub(crate) struct Built {
    pub(crate) bytes: Vec<u8>,
    places: Vec<(String, Range<usize>)>,
    lengths: Vec<(&'static str, Range<usize>)>,
}

impl Built {
    /// Returns the byte range of a variable, of its first record if it has records.
    pub(crate) fn variable(&self, name: &str) -> Option<Range<usize>> {
        let found = self.places.iter().find(|(own, _)| own == name);
        found.map(|(_, range)| range.clone())
    }

    /// Returns the byte ranges of all variables, in all records.
    pub(crate) fn lists(&self) -> Vec<Range<usize>> {
        self.places.iter().map(|(_, range)| range.clone()).collect()
    }

    /// Returns the byte ranges of the lengths of some dimensions.
    pub(crate) fn lengths(&self, names: &[&str]) -> Vec<Range<usize>> {
        let wanted = self.lengths.iter().filter(|(name, _)| names.contains(name));
        wanted.map(|(_, range)| range.clone()).collect()
    }
}

/// Name of the record dimension.
pub(crate) const RECORDS: &str = "time_step";

impl NetCdf {
    pub(crate) fn new(version: u8) -> NetCdf {
        NetCdf { out: Binary::empty(true), version, variables: Vec::new() }
    }

    fn count(&mut self, number: u64) {
        match self.version {
            5 => self.out.sizes(&[number]),
            _ => self.out.ints(&[number as i32]),
        }
    }

    fn text(&mut self, text: &str) {
        self.count(text.len() as u64);
        self.out.text(text);
        pad(&mut self.out.bytes);
    }

    /// Adds a variable of the type `number`, with its content in the big byte order.
    pub(crate) fn add(
        &mut self,
        name: &str,
        number: i32,
        dimensions: &[&'static str],
        content: Vec<u8>,
    ) {
        let (name, dimensions) = (name.to_owned(), dimensions.to_vec());
        self.variables.push(Variable { name, number, dimensions, content, attributes: Vec::new() });
    }

    pub(crate) fn ints(&mut self, name: &str, dimensions: &[&'static str], numbers: &[i32]) {
        let mut content = Binary::empty(true);
        content.ints(numbers);
        self.add(name, 4, dimensions, content.bytes);
    }

    pub(crate) fn reals(
        &mut self,
        name: &str,
        precision: Precision,
        dimensions: &[&'static str],
        numbers: &[f64],
    ) {
        let mut content = Binary::empty(true);
        content.reals(precision, numbers);
        let number = if precision == Precision::Single { 5 } else { 6 };
        self.add(name, number, dimensions, content.bytes);
    }

    pub(crate) fn names(&mut self, name: &str, dimensions: &[&'static str], texts: &[&str]) {
        let content = texts.iter().flat_map(|text| {
            let mut row = text.as_bytes().to_vec();
            row.resize(16, 0);
            row
        });
        self.add(name, 2, dimensions, content.collect());
    }

    /// Adds an attribute to the variable that was added last.
    pub(crate) fn attribute(&mut self, name: &'static str, content: Attribute) {
        self.variables.last_mut().unwrap().attributes.push((name, content));
    }

    fn write_attribute(&mut self, name: &str, content: Attribute) {
        self.text(name);
        match content {
            Attribute::Text(text) => {
                self.out.ints(&[2]);
                self.text(text);
            }
            Attribute::Whole(number) => {
                self.out.ints(&[4]);
                self.count(1);
                self.out.ints(&[number]);
            }
            Attribute::Real(number) => {
                self.out.ints(&[6]);
                self.count(1);
                self.out.reals(Precision::Double, &[number]);
            }
        }
    }

    /// Finishes the file with `records` records.
    pub(crate) fn build(mut self, dimensions: &[(&'static str, usize)], records: usize) -> Built {
        let variables = std::mem::take(&mut self.variables);
        self.out.text("CDF");
        self.out.bytes.push(self.version);
        self.count(records as u64);
        self.out.ints(&[10]);
        self.count(dimensions.len() as u64);
        let mut lengths = Vec::new();
        for &(name, length) in dimensions {
            self.text(name);
            let start = self.out.bytes.len();
            self.count(length as u64);
            lengths.push((name, start..self.out.bytes.len()));
        }
        self.out.ints(&[12]);
        self.count(1);
        self.write_attribute("title", Attribute::Text("a bay of 3 islands"));
        self.out.ints(&[11]);
        self.count(variables.len() as u64);
        let mut begins = Vec::new();
        for variable in &variables {
            self.text(&variable.name);
            self.count(variable.dimensions.len() as u64);
            for dimension in &variable.dimensions {
                let place = dimensions.iter().position(|(own, _)| own == dimension).unwrap();
                self.count(place as u64);
            }
            self.out.ints(&[if variable.attributes.is_empty() { 0 } else { 12 }]);
            self.count(variable.attributes.len() as u64);
            for &(name, content) in &variable.attributes {
                self.write_attribute(name, content);
            }
            self.out.ints(&[variable.number]);
            self.count(variable.content.len() as u64);
            begins.push(self.out.bytes.len());
            let width = if self.version == 1 { 4 } else { 8 };
            self.out.bytes.resize(self.out.bytes.len() + width, 0);
        }
        let is_record = |variable: &Variable| variable.dimensions.first() == Some(&RECORDS);
        let mut places = Vec::new();
        for step in 0..=records {
            for (variable, &begin) in variables.iter().zip(&begins) {
                if is_record(variable) != (step > 0) {
                    continue;
                }
                let bytes = &mut self.out.bytes;
                let start = bytes.len();
                if step < 2 {
                    match self.version {
                        1 => bytes[begin..begin + 4].copy_from_slice(&(start as u32).to_be_bytes()),
                        _ => bytes[begin..begin + 8].copy_from_slice(&(start as u64).to_be_bytes()),
                    }
                }
                bytes.extend_from_slice(&variable.content);
                places.push((variable.name.clone(), start..bytes.len()));
                pad(bytes);
            }
        }
        Built { bytes: self.out.bytes, places, lengths }
    }
}

fn pad(bytes: &mut Vec<u8>) {
    bytes.resize(bytes.len().next_multiple_of(4), 0);
}
