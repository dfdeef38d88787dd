//! Datasets: type, shape, layout and filters from the object header, and the bytes of the items.

use super::bytes::{DAMAGED, Hdf5Error};
use super::checksum::Checksum;
use super::chunks::ChunkGrid;
use super::entry::Chunk;
use super::file::{Hdf5, Object};
use super::file_bytes::FileBytes;
use super::filters::{self, Filter};
use super::header::{FILTERS, Header, LAYOUT, SPACE, TYPE};
use super::layout::{Index, Layout};
use super::types::{Dataspace, Datatype};
use crate::error::ReadError;
use crate::parallel::map_parts;
use std::borrow::Cow;
use std::ops::Range;

/// A dataset as its object header describes it.
pub(crate) struct Dataset {
    /// Offset of the object header in the file.
    pub(crate) at: usize,
    pub(crate) datatype: Datatype,
    space: Dataspace,
    layout: Layout,
    filters: Vec<Filter>,
    /// Checksum that covers the layout message; `None` in object headers of version 1.
    sum: Option<Checksum>,
}

/// The decoded items of a dataset, with the location of its chunks in the file.
pub(crate) struct DatasetArray<'a> {
    /// Items one after another. The last dimension varies fastest.
    pub(crate) bytes: Cow<'a, [u8]>,
    pub(super) storage: DatasetStorage,
}

/// Chunks of a dataset with their filters. A compact or contiguous dataset has a single chunk without filters.
#[derive(Clone, Debug)]
pub(super) struct DatasetStorage {
    /// The grid of chunks; `None` if the dataset has no items.
    pub(super) grid: Option<ChunkGrid>,
    pub(super) chunks: Vec<Chunk>,
    pub(super) filters: Vec<Filter>,
    /// Checksum that covers the items of a compact dataset, which are part of the object header.
    pub(super) sum: Option<Checksum>,
}

/// Number of chunks that all threads decode before the items are copied to the array. The number limits the memory for
/// decoded chunks.
const CHUNKS_PER_BATCH: usize = 64;

impl Dataset {
    /// Returns the number of items in each dimension; empty for a single item.
    pub(crate) fn shape(&self) -> &[u64] {
        &self.space.shape
    }

    /// Returns whether the dataset may grow without limit in its first dimension.
    pub(crate) fn grows(&self) -> bool {
        self.space.max_shape.first() == Some(&u64::MAX)
    }
}

/// Reads the datatype message of an object. A shared message leads to the header of a named datatype.
fn type_of(raw: &FileBytes<'_>, header: &Header, at: usize) -> Result<Datatype, Hdf5Error> {
    let damaged = || Hdf5Error::damaged(at, "the type of a dataset");
    let message = header.of(TYPE).next().ok_or_else(damaged)?;
    let mut bytes = raw.at(message.content.start, "the type of a dataset");
    if !message.is_shared {
        return Datatype::read(bytes.within(message.content.clone()));
    }
    // A shared message holds the address of a named datatype's header.
    let (version, kind) = (bytes.byte()?, bytes.byte()?);
    bytes.skip(if version == 1 { 6 } else { 0 })?;
    if version == 3 && kind != 2 {
        return Err(bytes.unread("a dataset whose datatype is stored in a heap"));
    }
    let header = Header::read(raw, bytes.address()?.ok_or_else(damaged)?)?;
    let message = header.of(TYPE).find(|message| !message.is_shared).ok_or_else(damaged)?;
    Datatype::read(bytes.within(message.content.clone()))
}

impl<'a> Hdf5<'a> {
    /// Returns the dataset of an object; `None` if the object is a group or a named datatype.
    ///
    /// # Errors
    /// If the object header is damaged, or if it uses an unsupported feature.
    pub(crate) fn dataset(&self, object: &Object) -> Result<Option<Dataset>, ReadError> {
        self.dataset_of(object).map_err(|fault| self.error(fault))
    }

    fn dataset_of(&self, object: &Object) -> Result<Option<Dataset>, Hdf5Error> {
        let header = object.header.as_ref().map_err(Hdf5Error::clone)?;
        let (raw, at) = (&self.raw, object.at);
        let (Some(space), Some(layout)) = (header.of(SPACE).next(), header.of(LAYOUT).next())
        else {
            return Ok(None);
        };
        let within = |content: &Range<usize>| {
            raw.at(content.start, "a dataset of the HDF5 file").within(content.clone())
        };
        let own = &space.content;
        let space = Dataspace::read(within(own))?;
        let number = type_of(raw, header, at)?;
        let filters =
            header.of(FILTERS).next().map(|message| filters::read(within(&message.content)));
        let sum = layout.sum.and_then(|sum| header.sums.get(sum)).cloned();
        let layout = Layout::read(within(&layout.content), space.shape.len())?;
        let filters = filters.transpose()?.unwrap_or_default();
        Ok(Some(Dataset { at, datatype: number, space, layout, filters, sum }))
    }

    /// Returns the items of a dataset of integers. `None` if the object is anything else, or if the dataset cannot be
    /// read.
    pub(crate) fn integers(&self, object: &Object) -> Option<Vec<i64>> {
        let dataset = self.dataset(object).ok()??;
        let Datatype::Whole(number, order) = dataset.datatype else { return None };
        let array = self.array(&dataset).ok()?;
        Some(array.bytes.chunks_exact(number.bytes).map(|own| order.integer(number, own)).collect())
    }

    /// Reads the items of a dataset.
    ///
    /// # Errors
    /// If items were never written or lie beyond the file, or if a chunk is damaged.
    pub(crate) fn array(&self, dataset: &Dataset) -> Result<DatasetArray<'a>, ReadError> {
        let array = dataset.storage(&self.raw).and_then(|storage| {
            // The items of a compact dataset are part of the object header, which is claimed already.
            if !matches!(dataset.layout, Layout::Compact(_)) {
                let ranges = storage.chunks.iter().map(|chunk| chunk.range.clone());
                self.raw.claim_data(ranges, dataset.at);
            }
            let bytes = storage.items(self.raw.bytes, dataset.at)?;
            Ok(DatasetArray { bytes, storage })
        });
        array.map_err(|fault| self.error(fault))
    }
}

impl Dataset {
    /// Returns the chunks of the dataset with their byte ranges in the file.
    fn storage(&self, raw: &FileBytes<'_>) -> Result<DatasetStorage, Hdf5Error> {
        let Dataset { space, filters, at, .. } = self;
        let damaged = || Hdf5Error::damaged(*at, "a dataset of the HDF5 file");
        let absent = || Hdf5Error {
            at: *at,
            problem: "a dataset whose numbers were never written".into(),
            remedy: "Write the mesh again",
        };
        let size = self.datatype.bytes();
        let mut storage =
            DatasetStorage { grid: None, chunks: Vec::new(), filters: Vec::new(), sum: None };
        if space.count() == Some(0) {
            return Ok(storage);
        }
        let lengths = match &self.layout {
            Layout::Chunked { lengths, .. } => lengths,
            _ => &space.shape,
        };
        let grid =
            ChunkGrid::new(&space.shape, &space.max_shape, lengths, size).ok_or_else(damaged)?;
        let one = |start: usize, length: usize| {
            let range = start..start.saturating_add(length);
            let is_inside = range.end <= raw.bytes.len();
            is_inside.then(|| vec![Chunk { number: 0, range, mask: 0, entry: None }])
        };
        storage.chunks = match &self.layout {
            Layout::Compact(range) => {
                storage.sum = self.sum.clone();
                let fits = range.len() >= grid.bytes();
                fits.then(|| one(range.start, grid.bytes())).flatten().ok_or_else(damaged)?
            }
            Layout::Contiguous(address) => {
                one(address.ok_or_else(absent)?, grid.bytes()).ok_or_else(damaged)?
            }
            Layout::Chunked { index, address, .. } => {
                let address = address.ok_or_else(absent)?;
                if matches!(index, Index::Implicit) && !filters.is_empty() {
                    return Err(damaged());
                }
                storage.filters.clone_from(filters);
                grid.chunks(raw, index, address, filters, self.sum.as_ref(), *at)?
            }
        };
        storage.grid = Some(grid);
        Ok(storage)
    }
}

impl DatasetStorage {
    /// Returns the items, decoded from the bytes of the file, or borrowed if the file holds them as they are. Errors
    /// report the offset `at` of the object header.
    fn items<'a>(&self, file: &'a [u8], at: usize) -> Result<Cow<'a, [u8]>, Hdf5Error> {
        let Some(grid) = &self.grid else { return Ok(Cow::default()) };
        if let Some(range) = self.whole() {
            return Ok(Cow::Borrowed(&file[range]));
        }
        let damaged =
            || Hdf5Error { at, problem: "a dataset with a damaged chunk".into(), remedy: DAMAGED };
        let mut all: Vec<u8> = Vec::new();
        for (wave, chunks) in self.chunks.chunks(CHUNKS_PER_BATCH).enumerate() {
            let unpacked = map_parts(chunks, |_, chunk| self.chunk(file, chunk));
            if wave == 0 {
                // Memory for all items is allocated only after the first chunks proved to be sound.
                unpacked.iter().all(Option::is_some).then_some(()).ok_or_else(damaged)?;
                all = vec![0; grid.bytes()];
            }
            for (chunk, own) in chunks.iter().zip(unpacked) {
                let own = own.ok_or_else(damaged)?;
                grid.runs(chunk.number, |to, from, length| {
                    all[to..to + length].copy_from_slice(&own[from..from + length]);
                });
            }
        }
        Ok(all.into())
    }

    /// Returns the range of the file that holds all items as they are. `None` if the items are in several chunks,
    /// filtered, or under a checksum.
    pub(super) fn whole(&self) -> Option<Range<usize>> {
        let length = self.grid.as_ref()?.bytes();
        match &self.chunks[..] {
            [chunk] if self.filters.is_empty() && chunk.range.len() == length => {
                self.sum.is_none().then(|| chunk.range.clone())
            }
            _ => None,
        }
    }

    /// Returns the decoded bytes of a chunk; `None` if the chunk is damaged.
    pub(super) fn chunk<'a>(&self, file: &'a [u8], chunk: &Chunk) -> Option<Cow<'a, [u8]>> {
        let length = self.grid.as_ref()?.chunk_bytes();
        let stored = file.get(chunk.range.clone())?;
        filters::unfiltered(&self.filters, chunk.mask, stored, length)
    }
}

impl DatasetArray<'_> {
    /// Returns the offset of the first item, if the file holds all items as they are; else `None`.
    pub(crate) fn start(&self) -> Option<usize> {
        self.storage.whole().map(|range| range.start)
    }

    /// Returns the offset in the file of byte `at` of the items, for messages. If the items are filtered or in several
    /// chunks, returns the start of the first chunk, or 0 without chunks.
    pub(crate) fn byte_of(&self, at: usize) -> usize {
        match (self.start(), self.storage.chunks.first()) {
            (Some(start), _) => start + at,
            (None, Some(chunk)) => chunk.range.start,
            (None, None) => 0,
        }
    }
}
