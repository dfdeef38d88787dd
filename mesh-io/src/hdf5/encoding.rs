//! What becomes of a file when numbers of its datasets change.

use super::checksum::Checksum;
use super::dataset::{DatasetArray, DatasetStorage};
use super::entry::{Chunk, Entry};
use super::file::Hdf5;
use super::file_bytes::EndAddress;
use super::filters;
use crate::edit::numbers::{ByteEdit, EncodedArrays};
use std::ops::Range;

/// Datasets whose numbers may change, one after another. A chunk that is compressed anew and is no longer than before takes the
/// place it had, else it goes to the end of the file. Chunks of these datasets that lie at the end of the file already are put
/// there one after another again, so that a file that is written in place many times does not grow without bound.
pub(crate) struct Hdf5Arrays {
    parts: Vec<DatasetBytes>,
    /// The numbers of all of them.
    bytes: Vec<u8>,
    end: EndAddress,
    /// How many bytes an address has.
    address: usize,
}

struct DatasetBytes {
    storage: DatasetStorage,
    /// Its bytes among those of all.
    own: Range<usize>,
}

impl Hdf5Arrays {
    /// Of some datasets of a file.
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

    /// The byte of the file near which one of the bytes stands, for messages.
    pub(crate) fn byte_of(&self, at: usize) -> usize {
        let part = self.parts.iter().find(|part| part.own.end > at);
        part.and_then(|part| part.storage.chunks.first()).map_or(0, |chunk| chunk.range.start)
    }

    /// The numbers of all of them.
    pub(crate) fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    fn chunks(&self) -> impl Iterator<Item = &Chunk> {
        self.parts.iter().flat_map(|part| &part.storage.chunks)
    }

    /// The checksums that may change with what they cover.
    fn sums(&self) -> impl Iterator<Item = &Checksum> {
        let entries = self.chunks().filter_map(|chunk| chunk.entry.as_ref()?.sum.as_ref());
        let items = self.parts.iter().filter_map(|part| part.storage.sum.as_ref());
        entries.chain(items).chain(&self.end.sum)
    }

    fn address_of(&self, value: usize) -> Vec<u8> {
        (value as u64).to_le_bytes()[..self.address.min(8)].to_vec()
    }

    /// Rewrites the chunks at the end of the file that are adjacent, from the first one on that changes its length.
    /// New bytes come from `changed`. Does nothing if bytes were appended to the file before.
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
        // Each chunk of the file with its index in `changed`.
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

    /// What replaces a chunk that becomes these bytes; `end` is where the file ends so far.
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

    /// Changes what the index says of a chunk that gets another place or length.
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
                // What was read once can be read again.
                let Some(mut bytes) = storage.chunk(file, chunk).filter(|_| !is_same) else {
                    continue;
                };
                // What a chunk at the edge has beside the items stays.
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
