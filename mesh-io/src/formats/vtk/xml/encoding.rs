//! Encoded arrays (base64 or compressed), and their encoding with new numbers.

use super::blocks::{Unwrapped, Wrapping};
use crate::edit::numbers::{Encoded, Offset, Splice};
use std::ops::Range;
use std::sync::Arc;

/// Arrays of points or of their data that are encoded, one for each piece of the mesh.
pub(super) struct Encoding {
    parts: Vec<Part>,
    /// The decoded bytes of all arrays, one after the other.
    bytes: Vec<u8>,
    offsets: Arc<[Offset]>,
}

struct Part {
    wrapping: Wrapping,
    /// How the array was encoded, without its bytes.
    old: Unwrapped<'static>,
    /// The range of the array in the file.
    range: Range<usize>,
    /// The range of this array in the decoded bytes of all arrays.
    own: Range<usize>,
}

impl Encoding {
    pub(super) fn new(
        arrays: Vec<(Wrapping, Unwrapped<'_>, Range<usize>)>,
        offsets: Arc<[Offset]>,
    ) -> Encoding {
        let mut bytes = Vec::new();
        let mut parts = Vec::new();
        for (wrapping, old, range) in arrays {
            let start = bytes.len();
            let (own, old) = old.split();
            match bytes.is_empty() {
                true => bytes = own.into_owned(),
                false => bytes.extend_from_slice(&own),
            }
            parts.push(Part { wrapping, old, range, own: start..bytes.len() });
        }
        Encoding { parts, bytes, offsets }
    }
}

impl Encoded for Encoding {
    fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    fn ranges(&self) -> Vec<Range<usize>> {
        self.parts.iter().map(|part| part.range.clone()).collect()
    }

    fn splices(&self, _: &[u8], new: &[u8], _: &mut usize) -> Vec<Splice> {
        let changed = self.parts.iter().filter(|part| {
            let own = part.own.clone();
            new[own.clone()] != self.bytes[own]
        });
        let splice = |part: &Part| {
            let bytes = part.wrapping.wrap(&part.old, &new[part.own.clone()]);
            Splice { range: part.range.clone(), bytes }
        };
        changed.map(splice).collect()
    }

    /// The offsets that are others once arrays before them have other lengths.
    fn follow(&self, _: &[u8], splices: &[Splice], _: usize) -> Vec<Splice> {
        let corrected = self.offsets.iter().filter_map(|offset| {
            let before = splices.iter().filter(|splice| splice.range.end <= offset.array_at);
            let (removed, added) = before.fold((0, 0), |(removed, added), splice| {
                (removed + splice.range.len(), added + splice.bytes.len())
            });
            let value = (offset.value + added).saturating_sub(removed);
            let bytes = value.to_string().into_bytes();
            (value != offset.value).then(|| Splice { range: offset.place.clone(), bytes })
        });
        corrected.collect()
    }

    /// The offsets of what stands after an array that may have another length.
    fn followers(&self, first: usize) -> Vec<Range<usize>> {
        let later = self.offsets.iter().filter(|offset| offset.array_at >= first);
        later.map(|offset| offset.place.clone()).collect()
    }

    fn keeps_places(&self) -> bool {
        false
    }
}
