//! Checksums of metadata: Jenkins' lookup3.

use super::bytes::{ByteReader, Hdf5Error};
use crate::edit::numbers::ByteEdit;
use std::ops::Range;

/// A checksummed range of a file. The checksum is stored in the four bytes after the range.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Checksum {
    /// The range that the checksum covers.
    pub(super) covered: Range<usize>,
}

impl Checksum {
    /// Returns the range of the checksum itself: the four bytes after the covered range.
    pub(super) fn stored_range(&self) -> Range<usize> {
        self.covered.end..self.covered.end + 4
    }

    /// Takes the checksum of the bytes from offset `start` to the reader's position. A wrong checksum is an error,
    /// except in tests and under a fuzzer: random damage would almost never get past a checksum.
    pub(super) fn take(start: usize, bytes: &mut ByteReader<'_>) -> Result<Checksum, Hdf5Error> {
        let range = start..bytes.at();
        let own = bytes.within(range.clone()).take(range.len())?;
        let stored = bytes.number(4)?;
        match cfg!(any(fuzzing, test)) || u64::from(lookup3(own)) == stored {
            true => Ok(Checksum { covered: range }),
            false => Err(bytes.damaged()),
        }
    }

    /// Returns the edit of the checksum after `edits`, which keep their lengths; `None` if no edit lies in the
    /// covered range.
    pub(super) fn update<'s>(
        &self,
        file: &[u8],
        edits: impl Iterator<Item = &'s ByteEdit>,
    ) -> Option<ByteEdit> {
        let own = |edit: &&ByteEdit| {
            edit.range.start >= self.covered.start && edit.range.end <= self.covered.end
        };
        let mut bytes = file.get(self.covered.clone())?.to_vec();
        let mut is_touched = false;
        for edit in edits.filter(own) {
            let at = edit.range.start - self.covered.start;
            bytes.get_mut(at..at + edit.bytes.len())?.copy_from_slice(&edit.bytes);
            is_touched = true;
        }
        let bytes = lookup3(&bytes).to_le_bytes().to_vec();
        is_touched.then(|| ByteEdit { range: self.stored_range(), bytes })
    }
}

/// Returns Bob Jenkins' hash lookup3 (2006) of bytes, with the initial value 0.
pub(super) fn lookup3(bytes: &[u8]) -> u32 {
    let start = 0xDEAD_BEEF_u32.wrapping_add(bytes.len() as u32);
    let [mut a, mut b, mut c] = [start; 3];
    let words = |bytes: &[u8]| {
        let mut padded = [0; 12];
        padded[..bytes.len()].copy_from_slice(bytes);
        [0, 4, 8].map(|at| {
            u32::from_le_bytes([padded[at], padded[at + 1], padded[at + 2], padded[at + 3]])
        })
    };
    let mut rest = bytes;
    while rest.len() > 12 {
        let (head, tail) = rest.split_at(12);
        let [x, y, z] = words(head);
        (a, b, c) = (a.wrapping_add(x), b.wrapping_add(y), c.wrapping_add(z));
        for (turn, by) in [4, 6, 8, 16, 19, 4].into_iter().enumerate() {
            // Each word in turn, with the word before and the word after.
            let [one, other, next] = match turn % 3 {
                0 => [&mut a, &mut c, &mut b],
                1 => [&mut b, &mut a, &mut c],
                _ => [&mut c, &mut b, &mut a],
            };
            *one = one.wrapping_sub(*other) ^ other.rotate_left(by);
            *other = other.wrapping_add(*next);
        }
        rest = tail;
    }
    if rest.is_empty() {
        return c;
    }
    let [x, y, z] = words(rest);
    (a, b, c) = (a.wrapping_add(x), b.wrapping_add(y), c.wrapping_add(z));
    for (turn, by) in [14, 11, 25, 16, 4, 14, 24].into_iter().enumerate() {
        let (one, other) = match turn % 3 {
            0 => (&mut c, b),
            1 => (&mut a, c),
            _ => (&mut b, a),
        };
        *one = (*one ^ other).wrapping_sub(other.rotate_left(by));
    }
    c
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The values are from the self-test of Jenkins' source file lookup3.c.
    #[test]
    fn hashes_match_the_published_values_of_their_author() {
        assert_eq!(lookup3(b""), 0xDEAD_BEEF);
        assert_eq!(lookup3(b"Four score and seven years ago"), 0x1777_0551);
    }
}
