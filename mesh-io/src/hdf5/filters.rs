//! Filters of chunks: compression, shuffled bytes and checksums, in both directions.

use super::bytes::{ByteReader, Hdf5Error};
use crate::compress::zlib;
use std::borrow::Cow;

/// A filter through which the chunks of a dataset pass before storage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Filter {
    /// Compression by zlib at a level from 0 to 9.
    Deflate(u32),
    /// Bytes of items of this size, regrouped: the bytes at index 0 of all items, then the bytes at index 1, and so on.
    Shuffle(usize),
    /// Fletcher32 checksum, in four bytes after the chunk.
    Fletcher,
}

/// Reads a filter pipeline message. Returns the filters in message order, which applies to compression; decompression
/// reverses the order. An unsupported filter is an error.
pub(super) fn read(mut bytes: ByteReader<'_>) -> Result<Vec<Filter>, Hdf5Error> {
    let version = bytes.byte()?;
    let count = bytes.byte()?;
    bytes.skip(if version == 1 { 6 } else { 0 })?;
    let mut filters = Vec::new();
    for _ in 0..count {
        let number = bytes.number(2)?;
        let name = if version == 1 || number >= 256 { bytes.count(2)? } else { 0 };
        bytes.skip(2)?;
        let values = bytes.count(2)?;
        bytes.skip(if version == 1 { name.next_multiple_of(8) } else { name })?;
        let first = bytes.clone().number(4);
        bytes.skip(4 * values)?;
        bytes.skip(if version == 1 && values % 2 == 1 { 4 } else { 0 })?;
        let value = if values > 0 { first? } else { 0 };
        filters.push(match number {
            1 => Filter::Deflate(value.min(9) as u32),
            2 => Filter::Shuffle(value as usize),
            3 => Filter::Fletcher,
            other => {
                return Err(bytes.unread(format!("a dataset compressed by {}", name_of(other))));
            }
        });
    }
    Ok(filters)
}

fn name_of(filter: u64) -> String {
    let name = match filter {
        4 => "szip",
        5 => "n-bit",
        6 => "scale and offset",
        32000 => "LZF",
        32001 => "Blosc",
        32004 => "LZ4",
        32015 => "Zstandard",
        other => return format!("filter {other}"),
    };
    name.to_owned()
}

/// Returns the `length` bytes of a chunk before filtering. Filters whose bits are set in `mask` were skipped. `None` if
/// the chunk is damaged.
pub(super) fn unfiltered<'a>(
    filters: &[Filter],
    mask: u32,
    stored: &'a [u8],
    length: usize,
) -> Option<Cow<'a, [u8]>> {
    let mut bytes = Cow::Borrowed(stored);
    for filter in used(filters, mask).rev() {
        bytes = match filter {
            Filter::Deflate(_) => {
                // Each checksum that was added before compression takes four bytes.
                let most = length.checked_add(4 * filters.len())?;
                if !zlib::can_expand(bytes.len(), length) {
                    return None;
                }
                zlib::decompress(&bytes, most + 1)?.into()
            }
            Filter::Shuffle(size) => shuffled(&bytes, *size, false).into(),
            Filter::Fletcher => {
                let (own, sum) = bytes.split_last_chunk::<4>()?;
                let stored = u32::from_le_bytes(*sum);
                let found = fletcher(own);
                // HDF5 before version 1.6.3 swapped the two bytes of each half of the checksum.
                let old = (found & 0x00FF_00FF) << 8 | (found >> 8) & 0x00FF_00FF;
                if stored != found && stored != old {
                    return None;
                }
                own.to_vec().into()
            }
        };
    }
    (bytes.len() == length).then_some(bytes)
}

/// Returns the bytes to be stored for a chunk. Filters whose bits are set in `mask` are skipped.
pub(super) fn filtered(filters: &[Filter], mask: u32, chunk: Vec<u8>) -> Vec<u8> {
    used(filters, mask).fold(chunk, |mut bytes, filter| match filter {
        Filter::Deflate(level) => zlib::compress(&bytes, *level),
        Filter::Shuffle(size) => shuffled(&bytes, *size, true),
        Filter::Fletcher => {
            bytes.extend(fletcher(&bytes).to_le_bytes());
            bytes
        }
    })
}

fn used(filters: &[Filter], mask: u32) -> impl DoubleEndedIterator<Item = &Filter> {
    let numbered = filters.iter().enumerate();
    numbered.filter(move |(number, _)| mask >> (number % 32) & 1 == 0).map(|(_, filter)| filter)
}

/// Returns the bytes of items of `size` bytes, grouped by their position in the item, or with `forth` false the
/// inverse. Bytes after the last whole item keep their place.
fn shuffled(bytes: &[u8], size: usize, forth: bool) -> Vec<u8> {
    let mut out = bytes.to_vec();
    let count = if size > 1 { bytes.len() / size } else { 0 };
    for item in 0..count {
        for place in 0..size {
            let (mixed, plain) = (place * count + item, item * size + place);
            match forth {
                true => out[mixed] = bytes[plain],
                false => out[plain] = bytes[mixed],
            }
        }
    }
    out
}

/// Returns the Fletcher32 checksum of big-endian 16-bit words. An odd last byte is the high byte of a word.
fn fletcher(bytes: &[u8]) -> u32 {
    let fold = |sum: u32| (sum & 0xFFFF) + (sum >> 16);
    let (words, last) = bytes.as_chunks::<2>();
    let (mut a, mut b) = (0_u32, 0_u32);
    // The sums of 360 words do not overflow 32 bits.
    for part in words.chunks(360) {
        for word in part {
            a += u32::from(u16::from_be_bytes(*word));
            b += a;
        }
        (a, b) = (fold(a), fold(b));
    }
    if let [last] = last {
        a += u32::from(*last) << 8;
        b += a;
        (a, b) = (fold(a), fold(b));
    }
    (a, b) = (fold(a), fold(b));
    b << 16 | a
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn filtered_chunks_are_unfiltered_to_the_same_bytes() {
        let bytes: Vec<u8> = (0..10_003_u32).map(|n| (n * n / 7 % 251) as u8).collect();
        let all = [Filter::Shuffle(8), Filter::Deflate(6), Filter::Fletcher];
        for filters in [&all[..], &all[..1], &all[1..2], &all[2..], &[all[2], all[0], all[1]]] {
            for mask in 0..8 {
                for length in [0, 1, 7, 8, 10_003] {
                    let stored = filtered(filters, mask, bytes[..length].to_vec());
                    let back = unfiltered(filters, mask, &stored, length);
                    assert!(
                        back.as_deref() == Some(&bytes[..length]),
                        "{filters:?} {mask} {length}"
                    );
                    assert!(unfiltered(filters, mask, &stored, length + 1).is_none());
                }
            }
        }
    }

    #[test]
    fn a_changed_byte_shows_in_the_checksum() {
        let bytes: Vec<u8> = (0..2000_u32).map(|n| (n % 253) as u8).collect();
        let stored = filtered(&[Filter::Fletcher], 0, bytes.clone());
        for at in (0..stored.len()).step_by(7) {
            let mut stored = stored.clone();
            stored[at] ^= 4;
            assert!(unfiltered(&[Filter::Fletcher], 0, &stored, bytes.len()).is_none());
        }
    }

    #[test]
    fn wrong_lengths_in_a_file_allocate_no_memory() {
        let stored = filtered(&[Filter::Deflate(9)], 0, vec![0; 1 << 20]);
        assert!(unfiltered(&[Filter::Deflate(9)], 0, &stored, 1 << 40).is_none());
        assert!(unfiltered(&[Filter::Deflate(9)], 0, &stored, 1 << 10).is_none());
    }
}
