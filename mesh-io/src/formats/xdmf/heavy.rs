//! Numbers outside of the XML: in HDF5 or raw companion files.

use super::document::{Content, Item};
use crate::binary::byte_order::{ByteOrder, IntegerType};
use crate::disk::source::{Companion, Source};
use crate::edit::numbers::{EncodedArrays, NumberEncoding, Offsets};
use crate::error::ReadError;
use crate::hdf5::{DatasetArray, Datatype, Hdf5, Hdf5Arrays};
use crate::text::cursor::{CUT_OFF, Cursor};
use crate::text::token::quoted;
use crate::visit::storage::{ArrayLocation, ByteSpace};
use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

/// The companion files of an XDMF file.
pub(super) struct HeavyData<'a> {
    /// Each companion, with its object tree if the file is HDF5.
    files: Vec<(&'a Companion, Option<Hdf5<'a>>)>,
}

/// Numbers of an item in a companion file.
pub(super) struct HeavyArray<'a> {
    /// The companion file.
    pub(super) source: &'a Source,
    /// Index of the file in the order of [`Source::files`], from 1 for companions.
    pub(super) file_index: usize,
    pub(super) number: Datatype,
    /// The numbers in binary, decoded.
    pub(super) bytes: Cow<'a, [u8]>,
    /// Offset of the first number. `None` if the file does not store the numbers as a single range of plain bytes.
    pub(super) start: Option<usize>,
    /// Offset that messages name: start of the numbers, or of the dataset's first chunk.
    at: usize,
    /// The HDF5 dataset, until [`HeavyData::encoding`] takes it; `None` in a raw file.
    array: Option<DatasetArray<'a>>,
    /// Index of the file in [`HeavyData::files`].
    file: usize,
}

impl<'a> HeavyData<'a> {
    /// Opens all companions of a source.
    ///
    /// # Errors
    /// If an HDF5 file is damaged.
    pub(super) fn open(source: &'a Source) -> Result<HeavyData<'a>, ReadError> {
        let mut files = Vec::new();
        for companion in &source.companions {
            files.push((companion, Hdf5::open_any(&companion.source)?));
        }
        Ok(HeavyData { files })
    }

    /// Returns the index of the companion that the XML calls `name`.
    fn file(&self, name: &str) -> Option<usize> {
        self.files.iter().position(|(companion, _)| companion.names.iter().any(|own| own == name))
    }

    /// Returns the number type of an item in a companion file. `None` if the XML contains the numbers, or if the
    /// dataset is missing or cannot be read.
    pub(super) fn number(&self, item: &Item) -> Option<Datatype> {
        match &item.content {
            Content::Text(_) => None,
            Content::Raw { number, .. } => Some(*number),
            Content::Hdf5 { file, path, .. } => {
                let file = self.files[self.file(file)?].1.as_ref()?;
                Some(file.dataset(file.find(path.as_bytes())?).ok()??.datatype)
            }
        }
    }

    /// Reads the numbers of an item; `None` if the XML contains the numbers. `cursor` is on the line of the item's tag.
    ///
    /// # Errors
    /// If the file or dataset is missing or damaged, or has fewer or more numbers than `Dimensions` announces.
    pub(super) fn read(
        &self,
        item: &Item,
        cursor: &Cursor<'_>,
    ) -> Result<Option<HeavyArray<'a>>, ReadError> {
        let name = match &item.content {
            Content::Text(_) => return Ok(None),
            Content::Hdf5 { file, .. } | Content::Raw { file, .. } => file,
        };
        let Some(index) = self.file(name) else {
            let shown = quoted(name.as_bytes());
            let problem = format!("its numbers are in {shown}, a file that was not read");
            return Err(cursor.error(problem, format!("Put {shown} beside the mesh file")));
        };
        let (companion, tree) = &self.files[index];
        let source = &companion.source;
        let (file_index, file) = (index + 1, index);
        let numbers = match (&item.content, tree) {
            (Content::Hdf5 { path, .. }, Some(tree)) => {
                let found = tree.find(path.as_bytes()).map(|object| tree.dataset(object));
                let Some(dataset) = found.transpose()?.flatten() else {
                    let problem =
                        format!("{} has no dataset {}", source.name(), quoted(path.as_bytes()));
                    return Err(cursor.error(problem, "Save the mesh again"));
                };
                let mut array = tree.array(&dataset)?;
                let (start, at) = (array.start(), array.byte_of(0));
                let bytes = std::mem::take(&mut array.bytes);
                let number = dataset.datatype;
                HeavyArray {
                    source,
                    file_index,
                    number,
                    bytes,
                    start,
                    at,
                    array: Some(array),
                    file,
                }
            }
            (Content::Raw { seek, number, .. }, _) => {
                let size = number.bytes() as u64;
                let end =
                    item.announced().and_then(|count| count.checked_mul(size)?.checked_add(*seek));
                let range = end
                    .and_then(|end| Some(usize::try_from(*seek).ok()?..usize::try_from(end).ok()?));
                let bytes = range.as_ref().and_then(|range| source.bytes.get(range.clone()));
                let (Some(bytes), Some(Range { start, .. })) = (bytes, range) else {
                    let problem =
                        format!("{} ends before the numbers of this item do", source.name());
                    return Err(cursor.error(problem, CUT_OFF));
                };
                let (number, bytes) = (*number, Cow::Borrowed(bytes));
                HeavyArray {
                    source,
                    file_index,
                    number,
                    bytes,
                    start: Some(start),
                    at: start,
                    array: None,
                    file,
                }
            }
            _ => {
                let problem = format!("{} is not HDF5", source.name());
                return Err(cursor.error(problem, "Save the mesh again"));
            }
        };
        let count = (numbers.bytes.len() / number_size(numbers.number)) as u64;
        match item.announced() {
            Some(announced) if announced != count => {
                let problem = format!(
                    "its Dimensions announce {announced} numbers, but {} has {count}",
                    source.name()
                );
                Err(cursor.error(problem, "Correct them, or save the mesh again"))
            }
            _ => Ok(Some(numbers)),
        }
    }

    /// Returns file index and byte range that identify an item's numbers: in a raw file the bytes of the numbers, in
    /// HDF5 the first byte of the dataset's header. `None` if the XML contains the numbers, which no other item has, or
    /// if the item cannot be located.
    pub(super) fn range_of(&self, item: &Item) -> Option<(usize, Range<usize>)> {
        let (Content::Hdf5 { file, .. } | Content::Raw { file, .. }) = &item.content else {
            return None;
        };
        let index = self.file(file)?;
        let range = match &item.content {
            Content::Raw { seek, number, .. } => {
                let length = item.announced()?.checked_mul(number.bytes() as u64)?;
                let end = seek.checked_add(length)?;
                usize::try_from(*seek).ok()?..usize::try_from(end).ok()?
            }
            Content::Hdf5 { path, .. } => {
                let at = self.files[index].1.as_ref()?.find(path.as_bytes())?.at;
                at..at + 1
            }
            Content::Text(_) => return None,
        };
        Some((index + 1, range))
    }

    /// Makes the encoding of changed numbers of an HDF5 dataset, to which the numbers move. `None` for raw files.
    pub(super) fn encoding(&self, numbers: &mut HeavyArray<'_>) -> Option<Hdf5Arrays> {
        let mut array = numbers.array.take()?;
        array.bytes = std::mem::take(&mut numbers.bytes);
        let tree = self.files[numbers.file].1.as_ref()?;
        Some(Hdf5Arrays::new(tree, vec![array]))
    }

    /// Checks that no two objects of an HDF5 file share bytes, as an edit of one would damage the other.
    pub(super) fn check_no_overlaps(&self) -> Result<(), ReadError> {
        self.files
            .iter()
            .filter_map(|(_, tree)| tree.as_ref())
            .try_for_each(Hdf5::check_no_overlaps)
    }
}

fn number_size(number: Datatype) -> usize {
    number.bytes().max(1)
}

impl<'a> HeavyArray<'a> {
    /// Returns a cursor at the byte `at` of the decoded numbers, for messages. Numbers that are not plain bytes have
    /// the cursor of their dataset.
    pub(super) fn cursor(&self, at: usize) -> Cursor<'a> {
        let at = if self.start.is_some() { self.at + at } else { self.at };
        Cursor::at_byte_offset(self.source, at)
    }

    /// Returns all numbers as real ones; `None` for a type that is neither real nor whole.
    pub(super) fn reals(&self) -> Option<Vec<f64>> {
        match self.number {
            Datatype::Real(precision, order) => {
                let each = self.bytes.chunks_exact(precision.bytes());
                Some(each.map(|number| order.real(precision, number)).collect())
            }
            _ => {
                let (number, order) = self.whole()?;
                let each = self.bytes.chunks_exact(number.bytes);
                Some(each.map(|own| order.integer_as_real(number, own)).collect())
            }
        }
    }

    /// Returns all numbers as integers; `None` for other types than integers.
    pub(super) fn integers(&self) -> Option<Vec<i64>> {
        let (number, order) = self.whole()?;
        let each = self.bytes.chunks_exact(number.bytes);
        Some(each.map(|own| order.integer(number, own)).collect())
    }

    /// Returns type and byte order of integers; `None` for other types.
    pub(super) fn whole(&self) -> Option<(IntegerType, ByteOrder)> {
        match self.number {
            Datatype::Whole(number, order) => Some((number, order)),
            _ => None,
        }
    }
}

/// Returns the location of real numbers of data, by which a rewrite replaces them; `None` for other types.
pub(super) fn stored(numbers: &mut HeavyArray<'_>, heavy: &HeavyData<'_>) -> Option<ArrayLocation> {
    let Datatype::Real(precision, order) = numbers.number else { return None };
    let (encoding, file_index, stride) =
        (NumberEncoding::Binary(order, precision), numbers.file_index, precision.bytes());
    let (start, home) = match numbers.start {
        Some(start) => (start, ByteSpace::File),
        None => {
            let encoding = heavy.encoding(numbers)?;
            (0, ByteSpace::Encoded(Arc::new(encoding) as Arc<dyn EncodedArrays>))
        }
    };
    Some(ArrayLocation {
        offsets: Offsets::Regular { start, stride },
        encoding,
        space: home,
        file_index,
        shared: None,
    })
}
