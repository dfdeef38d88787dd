//! Reads the arrays of a VTK XML file as numbers.

use super::blocks::{BlockEncoding, DecodedBlocks};
use super::document::{Array, ArrayFormat, Document};
use super::encoding::XmlArrays;
use crate::binary::int_array::IntArray;
use crate::disk::source::Source;
use crate::edit::numbers::{AppendedOffset, NumberEncoding, Offsets};
use crate::error::{Location, ReadError};
use crate::formats::vtk::bits_and_texts::bits;
use crate::precision::Precision;
use crate::text::cursor::{CUT_OFF, Cursor};
use crate::text::token::quoted;
use crate::visit::items::PointNumbers;
use crate::visit::shared::{SharedBytes, shared_bytes};
use crate::visit::storage::{ArrayLocation, ByteSpace};
use crate::visit::z_values::TextNumbers;
use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;

/// A VTK XML file with its parsed tags.
pub(super) struct File<'a> {
    pub(super) source: &'a Source,
    pub(super) document: Document,
    /// Offsets of the appended arrays, which a rewrite corrects.
    pub(super) offsets: Arc<[AppendedOffset]>,
    /// Appended arrays with bytes of other arrays, by the offsets of their tags.
    pub(super) shared: HashMap<usize, SharedBytes>,
}

impl<'a> File<'a> {
    /// Makes a file from its parsed tags, and finds arrays with common bytes: VTK reads files of which several arrays
    /// have one offset.
    pub(super) fn new(source: &'a Source, document: Document) -> File<'a> {
        let offsets = document.offsets().into();
        let mut file = File { source, document, offsets, shared: HashMap::new() };
        let arrays = &file.document.arrays;
        let ranges: Vec<_> =
            arrays.iter().map(|array| Some((0, file.appended_range(array)?))).collect();
        let name = |index: usize| match arrays[index].section.as_str() {
            "Points" if file.document.pieces.len() > 1 => {
                format!("the points of piece {}", arrays[index].piece + 1)
            }
            "Points" => "the points".to_owned(),
            "PointData" | "CellData" | "FieldData" => {
                format!("'{}'", quoted(arrays[index].name.as_bytes()))
            }
            _ => "the elements".to_owned(),
        };
        let shared = shared_bytes(&ranges, name);
        let shared = arrays.iter().zip(shared);
        file.shared = shared.filter_map(|(array, own)| Some((array.at, own?))).collect();
        file
    }

    /// Returns the range of an appended array in the file; `None` for other arrays, for damaged arrays, and for arrays
    /// without numbers, whose offset may be that of the next array.
    fn appended_range(&self, array: &Array) -> Option<Range<usize>> {
        let (appended, (offset, _)) = (self.document.appended?, array.offset.as_ref()?);
        if self.document.owners(array) == Some(0) {
            return None;
        }
        let start = appended.start.checked_add(*offset)?;
        let length = self.encoding(appended.base64).length(self.source.bytes.get(start..)?)?;
        Some(start..start + length)
    }

    fn encoding(&self, base64: bool) -> BlockEncoding {
        let Document { order, header, compressor, .. } = self.document;
        BlockEncoding { order, header, compressor, base64 }
    }

    /// Returns the array with a name, in any case, in a section of a piece; the section's first array if `name` is
    /// `None`.
    ///
    /// # Errors
    /// If the section has no such array.
    pub(super) fn array(
        &self,
        piece: usize,
        section: &str,
        name: Option<&str>,
    ) -> Result<&Array, ReadError> {
        let fits = |array: &&Array| {
            array.section == section
                && name.is_none_or(|name| array.name.eq_ignore_ascii_case(name))
        };
        self.document.arrays_of(piece).iter().find(fits).ok_or_else(|| {
            let name = name.unwrap_or(section);
            self.source.error(format!("it has no array of {name}"), CUT_OFF)
        })
    }

    #[cold]
    pub(super) fn damaged(&self, array: &Array) -> ReadError {
        let place = Location::Line(self.source.line_of(array.at));
        let problem = format!("the array {} is damaged or cut off", quoted(array.name.as_bytes()));
        self.source.error_at(place, problem, CUT_OFF)
    }

    /// Decodes a binary array. Returns its encoding, its decoded bytes, and its range in the file.
    pub(super) fn unwrap(
        &self,
        array: &Array,
    ) -> Result<(BlockEncoding, DecodedBlocks<'_>, Range<usize>), ReadError> {
        let wrapping = |base64| self.encoding(base64);
        let (wrapping, start, end) = match (&array.offset, self.document.appended) {
            (Some((offset, _)), Some(appended)) => {
                let start = appended.start.saturating_add(*offset);
                (wrapping(appended.base64), start, self.source.bytes.len())
            }
            (Some(_), None) => return Err(self.damaged(array)),
            (None, _) => {
                let content = &self.source.bytes[array.content.clone()];
                let blanks = content.iter().take_while(|&&byte| byte <= b' ').count();
                (wrapping(true), array.content.start + blanks, array.content.end)
            }
        };
        let found = self.source.bytes.get(start..end).and_then(|input| wrapping.unwrap(input));
        let found = found.ok_or_else(|| self.damaged(array))?;
        let range = start..start + found.encoded_length;
        Ok((wrapping, found, range))
    }

    /// Reads an array of whole numbers as unsigned integers.
    pub(super) fn integers(&self, array: &Array) -> Result<IntArray<'_>, ReadError> {
        if array.format == ArrayFormat::Ascii {
            let mut numbers = IntArray::with_capacity(array.content.len() / 8);
            let cursor = &mut Cursor::within(self.source, array.content.clone());
            while cursor.next_word() {
                numbers.push(cursor.integer("a number")?);
            }
            return Ok(numbers);
        }
        let (wrapping, found, _) = self.unwrap(array)?;
        let size = self.size_of_integer(array)?;
        Ok(IntArray::binary(found.bytes, size, wrapping.order))
    }

    /// Reads an array of whole numbers as signed integers. Unsigned types keep their bits.
    pub(super) fn signed_integers(&self, array: &Array) -> Result<Vec<i64>, ReadError> {
        if array.format == ArrayFormat::Ascii {
            return self.words(array, |cursor| cursor.signed("a number"));
        }
        if array.number.starts_with('U') {
            let numbers = self.integers(array)?;
            return Ok(numbers.range(0..numbers.len()).map(u64::cast_signed).collect());
        }
        let (wrapping, found, _) = self.unwrap(array)?;
        let size = self.size_of_integer(array)?;
        Ok(found.bytes.chunks_exact(size).map(|number| wrapping.order.signed(number)).collect())
    }

    /// Reads an array of any number type as real numbers. Only `Float32` and `Float64` arrays can be rewritten, so
    /// other types get no location.
    pub(super) fn numbers(&self, array: &Array) -> Result<PointNumbers, ReadError> {
        let precision = precision_of(array);
        if array.format == ArrayFormat::Ascii {
            let cursor = &mut Cursor::within(self.source, array.content.clone());
            let mut numbers = TextNumbers::default();
            while cursor.next_word() {
                numbers.read(cursor)?;
            }
            let numbers = numbers.finish(precision.unwrap_or_default(), None);
            let stored = numbers.location.filter(|_| precision.is_some());
            return Ok(PointNumbers { location: stored, ..numbers });
        }
        if array.number == "Bit" {
            let (_, found, _) = self.unwrap(array)?;
            let count =
                self.document.owners(array).and_then(|own| own.checked_mul(array.components));
            let numbers = count.and_then(|count| bits(&found.bytes, count));
            let numbers = numbers.ok_or_else(|| self.damaged(array))?;
            return Ok(PointNumbers { numbers, nodes: None, location: None });
        }
        let Some(precision) = precision else {
            let numbers: Vec<f64> = match array.number.starts_with('U') {
                true => {
                    let numbers = self.integers(array)?;
                    numbers.range(0..numbers.len()).map(|number| number as f64).collect()
                }
                false => {
                    self.signed_integers(array)?.into_iter().map(|number| number as f64).collect()
                }
            };
            return Ok(PointNumbers { numbers, nodes: None, location: None });
        };
        let (wrapping, old, range) = self.unwrap(array)?;
        let stride = precision.bytes();
        let numbers = old.bytes.chunks_exact(stride);
        let numbers = numbers.map(|number| wrapping.order.real(precision, number)).collect();
        let encoding = NumberEncoding::Binary(wrapping.order, precision);
        // Appended raw bytes without compression are replaced in place. All other arrays are encoded again.
        let (start, home) = match !wrapping.base64 && wrapping.compressor.is_none() {
            true => (range.end - old.bytes.len(), ByteSpace::File),
            false => {
                let offsets = Arc::clone(&self.offsets);
                (
                    0,
                    ByteSpace::Encoded(Arc::new(XmlArrays::new(
                        vec![(wrapping, old, range)],
                        offsets,
                    ))),
                )
            }
        };
        let offsets = Offsets::Regular { start, stride };
        let shared = self.shared.get(&array.at).cloned();
        let stored = Some(ArrayLocation { offsets, encoding, space: home, file_index: 0, shared });
        Ok(PointNumbers { numbers, nodes: None, location: stored })
    }

    /// Reads each word of an array of text by `read`.
    fn words<T>(
        &self,
        array: &Array,
        read: impl Fn(&mut Cursor<'_>) -> Result<T, ReadError>,
    ) -> Result<Vec<T>, ReadError> {
        let cursor = &mut Cursor::within(self.source, array.content.clone());
        let mut words = Vec::new();
        while cursor.next_word() {
            words.push(read(cursor)?);
        }
        Ok(words)
    }

    /// Returns the width in bytes of an array's integer type.
    ///
    /// # Errors
    /// If the type is not an integer type.
    fn size_of_integer(&self, array: &Array) -> Result<usize, ReadError> {
        match array.number.as_str() {
            "Int8" | "UInt8" => Ok(1),
            "Int16" | "UInt16" => Ok(2),
            "Int32" | "UInt32" => Ok(4),
            "Int64" | "UInt64" => Ok(8),
            other => {
                let place = Location::Line(self.source.line_of(array.at));
                let problem =
                    format!("whole numbers of the type {} are not read", quoted(other.as_bytes()));
                Err(self.source.error_at(place, problem, "Save the mesh again"))
            }
        }
    }
}

/// Returns the precision of an array's numbers; `None` for whole numbers.
pub(super) fn precision_of(array: &Array) -> Option<Precision> {
    match array.number.as_str() {
        "Float32" => Some(Precision::Single),
        "Float64" => Some(Precision::Double),
        _ => None,
    }
}
