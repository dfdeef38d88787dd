//! Arrays of a VTK XML file in base64 or with compression, and their encoding with new numbers.

use super::blocks::{BlockEncoding, DecodedBlocks};
use crate::edit::numbers::{AppendedOffset, ByteEdit, EncodedArrays};
use std::ops::Range;
use std::sync::Arc;

/// Encoded arrays: the points of all pieces, or a single array of point data.
pub(super) struct XmlArrays {
    parts: Vec<ArrayBytes>,
    /// Decoded bytes of all arrays, array after array.
    bytes: Vec<u8>,
    /// Offsets of all appended arrays of the file.
    offsets: Arc<[AppendedOffset]>,
}

/// The encoded and decoded bytes of one array.
struct ArrayBytes {
    encoding: BlockEncoding,
    /// Block size and header form of the array, without its decoded bytes.
    old: DecodedBlocks<'static>,
    /// Range of the encoded array in the file.
    range: Range<usize>,
    /// Range of the array in the decoded bytes of all arrays.
    own: Range<usize>,
}

impl XmlArrays {
    pub(super) fn new(
        arrays: Vec<(BlockEncoding, DecodedBlocks<'_>, Range<usize>)>,
        offsets: Arc<[AppendedOffset]>,
    ) -> XmlArrays {
        let mut bytes = Vec::new();
        let mut parts = Vec::new();
        for (encoding, old, range) in arrays {
            let start = bytes.len();
            let (own, old) = old.split();
            match bytes.is_empty() {
                true => bytes = own.into_owned(),
                false => bytes.extend_from_slice(&own),
            }
            parts.push(ArrayBytes { encoding, old, range, own: start..bytes.len() });
        }
        XmlArrays { parts, bytes, offsets }
    }
}

impl EncodedArrays for XmlArrays {
    fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    fn ranges(&self) -> Vec<Range<usize>> {
        self.parts.iter().map(|part| part.range.clone()).collect()
    }

    fn edits(&self, _: &[u8], new: &[u8], _: &mut usize) -> Vec<ByteEdit> {
        let changed = self.parts.iter().filter(|part| {
            let own = part.own.clone();
            new[own.clone()] != self.bytes[own]
        });
        let edit = |part: &ArrayBytes| {
            let bytes = part.encoding.wrap(&part.old, &new[part.own.clone()]);
            ByteEdit { range: part.range.clone(), bytes }
        };
        changed.map(edit).collect()
    }

    /// Corrects the offsets of appended arrays that lie after an edited array whose length changes.
    fn dependent_edits(&self, _: &[u8], edits: &[ByteEdit], _: usize) -> Vec<ByteEdit> {
        let corrected = self.offsets.iter().filter_map(|offset| {
            // Arrays within their tags precede all appended arrays.
            let appended = offset.array_start.saturating_sub(offset.value);
            let before = edits.iter().filter(|edit| {
                appended <= edit.range.start && edit.range.end <= offset.array_start
            });
            let (removed, added) = before.fold((0, 0), |(removed, added), edit| {
                (removed + edit.range.len(), added + edit.bytes.len())
            });
            let value = (offset.value + added).saturating_sub(removed);
            let bytes = value.to_string().into_bytes();
            (value != offset.value).then(|| ByteEdit { range: offset.range.clone(), bytes })
        });
        corrected.collect()
    }

    /// Returns the offset attributes of all appended arrays that start at byte `first` or later.
    fn dependent_ranges(&self, first: usize) -> Vec<Range<usize>> {
        let later = self.offsets.iter().filter(|offset| offset.array_start >= first);
        later.map(|offset| offset.range.clone()).collect()
    }

    fn preserves_offsets(&self) -> bool {
        false
    }
}
