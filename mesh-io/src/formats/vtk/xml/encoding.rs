//! Encoded arrays (base64 or compressed), and their encoding with new numbers.

use super::blocks::{BlockEncoding, DecodedBlocks};
use crate::edit::numbers::{AppendedOffset, ByteEdit, EncodedArrays};
use std::ops::Range;
use std::sync::Arc;

/// Encoded arrays of points or point data, one for each piece of the mesh.
pub(super) struct XmlArrays {
    parts: Vec<ArrayBytes>,
    /// The decoded bytes of all arrays, one after the other.
    bytes: Vec<u8>,
    offsets: Arc<[AppendedOffset]>,
}

/// The encoded and decoded bytes of one array.
struct ArrayBytes {
    encoding: BlockEncoding,
    /// How the array was encoded, without its bytes.
    old: DecodedBlocks<'static>,
    /// The range of the array in the file.
    range: Range<usize>,
    /// The range of this array in the decoded bytes of all arrays.
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

    /// The offsets that are others once arrays before them have other lengths.
    fn dependent_edits(&self, _: &[u8], edits: &[ByteEdit], _: usize) -> Vec<ByteEdit> {
        let corrected = self.offsets.iter().filter_map(|offset| {
            let before = edits.iter().filter(|edit| edit.range.end <= offset.array_start);
            let (removed, added) = before.fold((0, 0), |(removed, added), edit| {
                (removed + edit.range.len(), added + edit.bytes.len())
            });
            let value = (offset.value + added).saturating_sub(removed);
            let bytes = value.to_string().into_bytes();
            (value != offset.value).then(|| ByteEdit { range: offset.range.clone(), bytes })
        });
        corrected.collect()
    }

    /// The offsets of what stands after an array that may have another length.
    fn dependent_ranges(&self, first: usize) -> Vec<Range<usize>> {
        let later = self.offsets.iter().filter(|offset| offset.array_start >= first);
        later.map(|offset| offset.range.clone()).collect()
    }

    fn preserves_offsets(&self) -> bool {
        false
    }
}
