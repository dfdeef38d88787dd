//! Edits of a file that store new numbers in its datasets: chunks, index entries, checksums and the end address.

use super::checksum::Checksum;
use super::dataset::{DatasetArray, DatasetStorage};
use super::entry::{Chunk, Entry};
use super::file::Hdf5;
use super::file_bytes::EndAddress;
use super::filters;
use crate::edit::numbers::{ByteEdit, EncodedArrays};
use std::ops::Range;

/// Datasets of one file whose numbers may change, decoded and concatenated.
///
/// A changed chunk passes through its filters again. If its new length does not exceed the old one, the chunk keeps its
/// offset; else it is appended to the file. Chunks that already form the end of the file are instead rewritten one
/// after another, so repeated writes in place do not make the file grow without bound.
pub(crate) struct Hdf5Arrays {
    parts: Vec<DatasetBytes>,
    /// Decoded numbers of all datasets, in the order of `parts`.
    bytes: Vec<u8>,
    end: EndAddress,
    /// Width of an address in bytes.
    address: usize,
}

struct DatasetBytes {
    storage: DatasetStorage,
    /// Range of the dataset in the numbers of all datasets.
    own: Range<usize>,
}

impl Hdf5Arrays {
    /// Concatenates decoded datasets of `file`, in the given order.
    pub(crate) fn new(file: &Hdf5<'_>, arrays: Vec<DatasetArray<'_>>) -> Hdf5Arrays {
        let mut bytes = Vec::new();
        let mut parts = Vec::new();
        for array in arrays {
            let start = bytes.len();
            match bytes.is_empty() {
                true => bytes = array.bytes.into_owned(),
                false => bytes.extend_from_slice(&array.bytes),
            }
            parts.push(DatasetBytes { storage: array.storage, own: start..bytes.len() });
        }
        Hdf5Arrays { parts, bytes, end: file.raw.end.clone(), address: file.raw.widths.address }
    }

    /// Returns an offset near byte `at` of the numbers, for messages: the start of the dataset's first chunk, or 0
    /// without chunks.
    pub(crate) fn byte_of(&self, at: usize) -> usize {
        let part = self.parts.iter().find(|part| part.own.end > at);
        part.and_then(|part| part.storage.chunks.first()).map_or(0, |chunk| chunk.range.start)
    }

    /// Returns the decoded numbers of all datasets, in the order in which the datasets were given.
    pub(crate) fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    fn chunks(&self) -> impl Iterator<Item = &Chunk> {
        self.parts.iter().flat_map(|part| &part.storage.chunks)
    }

    /// Returns the checksums that cover index entries, items of compact datasets, or the end address.
    fn sums(&self) -> impl Iterator<Item = &Checksum> {
        let entries = self.chunks().filter_map(|chunk| chunk.entry.as_ref()?.sum.as_ref());
        let items = self.parts.iter().filter_map(|part| part.storage.sum.as_ref());
        entries.chain(items).chain(&self.end.sum)
    }

    fn address_of(&self, value: usize) -> Vec<u8> {
        (value as u64).to_le_bytes()[..self.address.min(8)].to_vec()
    }

    /// Rewrites the adjacent chunks at the end of the file, from the first chunk whose length changes. Takes the new
    /// bytes from `changed`, adds the edits, and sets `end` to the new length of the file. Does nothing if bytes were
    /// appended to the file before.
    fn rewrite_trailing_chunks(
        &self,
        changed: &mut [(&Chunk, Option<Vec<u8>>)],
        file: &[u8],
        end: &mut usize,
        edits: &mut Vec<ByteEdit>,
    ) {
        if *end != file.len() {
            return;
        }
        // Indices into `changed`, ascending by the offsets of the chunks.
        let mut by_start: Vec<usize> = (0..changed.len()).collect();
        by_start.sort_unstable_by_key(|&at| changed[at].0.range.start);
        let index_of = |chunk: &Chunk| {
            let found =
                by_start.binary_search_by_key(&chunk.range.start, |&at| changed[at].0.range.start);
            found.ok().map(|place| by_start[place])
        };
        let movable = self.chunks().filter(|chunk| chunk.entry.is_some());
        let mut chunks: Vec<(&Chunk, Option<usize>)> =
            movable.map(|chunk| (chunk, index_of(chunk))).collect();
        chunks.sort_unstable_by_key(|(chunk, _)| chunk.range.start);
        let (mut first, mut start) = (chunks.len(), file.len());
        while first > 0 && chunks[first - 1].0.range.end == start {
            first -= 1;
            start = chunks[first].0.range.start;
        }
        let keeps_length = |(chunk, at): &&(&Chunk, Option<usize>)| {
            let new = at.and_then(|at| changed[at].1.as_ref());
            new.is_none_or(|new| new.len() == chunk.range.len())
        };
        first += chunks[first..].iter().take_while(keeps_length).count();
        let Some(start) = chunks.get(first).map(|(chunk, _)| chunk.range.start) else { return };
        let mut bytes = Vec::new();
        for &(chunk, at) in &chunks[first..] {
            let new = at.and_then(|at| changed[at].1.take());
            let own = new.as_deref().unwrap_or(&file[chunk.range.clone()]);
            self.update_index(chunk, start + bytes.len(), own.len(), edits);
            bytes.extend_from_slice(own);
        }
        *end = start + bytes.len();
        edits.push(ByteEdit { range: start..file.len(), bytes });
    }

    /// Adds the edits that store `bytes` as the chunk: at the chunk's offset if the bytes fit, else at the end of the
    /// file. `end` is the file's length including all previous edits.
    fn stored(
        &self,
        chunk: &Chunk,
        bytes: Vec<u8>,
        file: &[u8],
        end: &mut usize,
        edits: &mut Vec<ByteEdit>,
    ) {
        let (range, length) = (&chunk.range, bytes.len());
        let (mut start, mut place) = (range.start, range.start..range.start + length);
        if length > range.len() {
            (start, place) = (*end, file.len()..file.len());
            *end += length;
        }
        self.update_index(chunk, start, length, edits);
        edits.push(ByteEdit { range: place, bytes });
    }

    /// Adds the edits of the index entry of a chunk that moves to offset `start` or changes its stored length.
    fn update_index(&self, chunk: &Chunk, start: usize, length: usize, edits: &mut Vec<ByteEdit>) {
        let Chunk { range, entry, .. } = chunk;
        if let Some(Entry { address, size, .. }) = entry {
            if start != range.start {
                let place = *address..*address + self.address;
                edits.push(ByteEdit { range: place, bytes: self.address_of(start) });
            }
            if let Some(place) = size.as_ref().filter(|_| length != range.len()) {
                let value = (length as u64).to_le_bytes()[..place.len()].to_vec();
                edits.push(ByteEdit { range: place.clone(), bytes: value });
            }
        }
    }
}

impl EncodedArrays for Hdf5Arrays {
    fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    fn ranges(&self) -> Vec<Range<usize>> {
        let mut ranges: Vec<Range<usize>> =
            self.chunks().map(|chunk| chunk.range.clone()).collect();
        for entry in self.chunks().filter_map(|chunk| chunk.entry.as_ref()) {
            ranges.push(entry.address..entry.address + self.address);
            ranges.extend(entry.size.clone());
        }
        ranges.push(self.end.range.clone());
        ranges.extend(self.sums().map(Checksum::stored_range));
        ranges
    }

    fn edits(&self, file: &[u8], new: &[u8], end: &mut usize) -> Vec<ByteEdit> {
        let mut changed: Vec<(&Chunk, Option<Vec<u8>>)> = Vec::new();
        for DatasetBytes { storage, own } in &self.parts {
            let (old, new) = (&self.bytes[own.clone()], &new[own.clone()]);
            let Some(grid) = storage.grid.as_ref().filter(|_| old != new) else { continue };
            for chunk in &storage.chunks {
                let mut is_same = true;
                grid.runs(chunk.number, |at, _, length| {
                    is_same &= old[at..at + length] == new[at..at + length];
                });
                // The chunk was decoded when the file was read, so it can be decoded again.
                let Some(mut bytes) = storage.chunk(file, chunk).filter(|_| !is_same) else {
                    continue;
                };
                // Bytes of the chunk beyond the edge of the dataset stay as they were.
                grid.runs(chunk.number, |at, to, length| {
                    bytes.to_mut()[to..to + length].copy_from_slice(&new[at..at + length]);
                });
                let stored = filters::filtered(&storage.filters, chunk.mask, bytes.into_owned());
                changed.push((chunk, Some(stored)));
            }
        }
        let mut edits = Vec::new();
        self.rewrite_trailing_chunks(&mut changed, file, end, &mut edits);
        for (chunk, stored) in changed {
            if let Some(stored) = stored {
                self.stored(chunk, stored, file, end, &mut edits);
            }
        }
        edits
    }

    fn dependent_edits(&self, file: &[u8], edits: &[ByteEdit], end: usize) -> Vec<ByteEdit> {
        let mut more = Vec::new();
        if end != file.len() {
            more.push(ByteEdit { range: self.end.range.clone(), bytes: self.address_of(end) });
        }
        let mut sums: Vec<&Checksum> = self.sums().collect();
        sums.dedup();
        for sum in sums {
            if more.iter().all(|edit| edit.range != sum.stored_range()) {
                more.extend(sum.update(file, edits.iter().chain(&more)));
            }
        }
        more
    }

    fn dependent_ranges(&self, _first: usize) -> Vec<Range<usize>> {
        Vec::new()
    }

    fn preserves_offsets(&self) -> bool {
        true
    }
}
