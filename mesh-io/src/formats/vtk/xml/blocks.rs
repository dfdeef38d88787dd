//! Decodes and encodes the binary arrays of a VTK XML file: base64 text and compressed blocks.

use crate::binary::byte_order::ByteOrder;
use crate::compress::zlib;
use crate::parallel::map_parts;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use std::borrow::Cow;

/// Compression of the blocks of an array.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Compressor {
    Zlib,
    Lz4,
}

/// Encoding of a binary array: byte order, width of header integers, compression and base64.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct BlockEncoding {
    pub(super) order: ByteOrder,
    /// Width of an integer of the header, in bytes: 4 or 8.
    pub(super) header: usize,
    pub(super) compressor: Option<Compressor>,
    pub(super) base64: bool,
}

/// A decoded array, with the block size and header form that an encoder needs to write the array again.
pub(super) struct DecodedBlocks<'a> {
    /// Decoded bytes; borrowed from the file if the array is raw and uncompressed.
    pub(super) bytes: Cow<'a, [u8]>,
    /// Length of the encoded array in the file, in bytes, header included.
    pub(super) encoded_length: usize,
    /// Size of a block before compression, in bytes; 0 for arrays without blocks.
    block: usize,
    /// Whether header and numbers are two base64 texts, each with its own padding. The value matters only for base64
    /// without compression.
    has_separate_header: bool,
}

impl<'a> DecodedBlocks<'a> {
    /// Moves the decoded bytes out. Returns them, and the rest with empty `bytes`.
    pub(super) fn split(self) -> (Cow<'a, [u8]>, DecodedBlocks<'static>) {
        let DecodedBlocks {
            bytes,
            encoded_length: taken,
            block,
            has_separate_header: header_apart,
        } = self;
        (
            bytes,
            DecodedBlocks {
                bytes: Cow::default(),
                encoded_length: taken,
                block,
                has_separate_header: header_apart,
            },
        )
    }
}

impl BlockEncoding {
    /// Decodes the array at the start of `input`. `None` if the array is damaged or `input` ends too early.
    pub(super) fn unwrap<'a>(&self, input: &'a [u8]) -> Option<DecodedBlocks<'a>> {
        match self.compressor {
            None => self.unwrap_plain(input),
            Some(compressor) => self.unwrap_compressed(compressor, input),
        }
    }

    /// Returns the length of the encoded array at the start of `input` by its header, without decoding the array. `None`
    /// if the header is damaged or `input` ends too early.
    pub(super) fn length(&self, input: &[u8]) -> Option<usize> {
        let length = match (self.compressor, self.base64) {
            (None, false) => self.header.checked_add(self.number(input.get(..self.header)?)?)?,
            (None, true) => {
                let (length, has_separate_header) = self.base64_header(input)?;
                match has_separate_header {
                    true => encoded(self.header).checked_add(encoded(length))?,
                    false => encoded(self.header.checked_add(length)?),
                }
            }
            (Some(_), base64) => {
                let blocks = self.numbers(input, 3)?[0];
                let counts = self.numbers(input, blocks.checked_add(3)?)?;
                let header = self.header * counts.len();
                let compressed = counts[3..].iter().try_fold(0_usize, |a, &b| a.checked_add(b))?;
                match base64 {
                    false => header.checked_add(compressed)?,
                    true => encoded(header).checked_add(encoded(compressed))?,
                }
            }
        };
        (length <= input.len()).then_some(length)
    }

    /// Returns the number of bytes of an uncompressed array that the header of its base64 text gives, and whether the
    /// header is a text of its own.
    fn base64_header(&self, input: &[u8]) -> Option<(usize, bool)> {
        let apart = encoded(self.header);
        // Padding of a header that is encoded alone. A header followed by numbers in the same base64 text has less
        // padding, or none.
        let padding = 3 - self.header % 3;
        let has_separate_header = input.get(apart - padding..apart)? == &b"=="[..padding];
        let first = decode(input.get(..apart)?)?;
        Some((self.number(first.get(..self.header)?)?, has_separate_header))
    }

    fn unwrap_plain<'a>(&self, input: &'a [u8]) -> Option<DecodedBlocks<'a>> {
        if !self.base64 {
            let length = self.number(input.get(..self.header)?)?;
            let bytes = input.get(self.header..)?.get(..length)?.into();
            let taken = self.header + length;
            return Some(DecodedBlocks {
                bytes,
                encoded_length: taken,
                block: 0,
                has_separate_header: false,
            });
        }
        let apart = encoded(self.header);
        let (length, header_apart) = self.base64_header(input)?;
        let (mut bytes, taken) = match header_apart {
            true => (decode(input.get(apart..)?.get(..encoded(length))?)?, apart + encoded(length)),
            false => {
                let taken = encoded(self.header.checked_add(length)?);
                (decode(input.get(..taken)?)?.split_off(self.header), taken)
            }
        };
        bytes.truncate(length);
        Some(DecodedBlocks {
            bytes: bytes.into(),
            encoded_length: taken,
            block: 0,
            has_separate_header: header_apart,
        })
    }

    fn unwrap_compressed(
        &self,
        compressor: Compressor,
        input: &[u8],
    ) -> Option<DecodedBlocks<'static>> {
        let counts = self.numbers(input, 3)?;
        let [blocks, size, last] = [counts[0], counts[1], counts[2]];
        // The header lists the number of blocks, the block size, the size of a partial last block (or 0), and the
        // compressed size of each block.
        let counts = self.numbers(input, blocks.checked_add(3)?)?;
        let header = self.header * counts.len();
        let compressed: usize = counts[3..].iter().try_fold(0_usize, |a, &b| a.checked_add(b))?;
        let (content, taken) = match self.base64 {
            false => {
                let content = input.get(header..)?.get(..compressed)?;
                (Cow::Borrowed(content), header + compressed)
            }
            true => {
                let content = input.get(encoded(header)..)?.get(..encoded(compressed))?;
                (decode(content)?.into(), encoded(header) + encoded(compressed))
            }
        };
        let mut left = content.get(..compressed)?;
        let mut packed = Vec::with_capacity(blocks);
        for (index, &length) in counts[3..].iter().enumerate() {
            let (block, rest) = left.split_at_checked(length)?;
            left = rest;
            let expected = if index + 1 == blocks && last > 0 { last } else { size };
            if !zlib::can_expand(length, expected) {
                return None;
            }
            packed.push((block, expected));
        }
        let unpacked = map_parts(packed, |_, (block, expected)| {
            let bytes = decompress(compressor, block, expected)?;
            (bytes.len() == expected).then_some(bytes)
        });
        let bytes = unpacked.into_iter().collect::<Option<Vec<_>>>()?.concat();
        Some(DecodedBlocks {
            bytes: bytes.into(),
            encoded_length: taken,
            block: size,
            has_separate_header: true,
        })
    }

    /// Encodes the bytes of an array in a new file, in blocks of VTK's usual size.
    pub(super) fn wrap_new(&self, bytes: &[u8]) -> Vec<u8> {
        const BLOCK: usize = 1 << 15;
        let (block, has_separate_header) = (BLOCK, false);
        let old =
            DecodedBlocks { bytes: Cow::default(), encoded_length: 0, block, has_separate_header };
        self.wrap(&old, bytes)
    }

    /// Encodes new bytes in the form of `old`: block size and header.
    pub(super) fn wrap(&self, old: &DecodedBlocks<'_>, bytes: &[u8]) -> Vec<u8> {
        let Some(compressor) = self.compressor else {
            let header = self.bytes_of(bytes.len());
            return match (self.base64, old.has_separate_header) {
                (false, _) => [header.as_slice(), bytes].concat(),
                (true, false) => STANDARD.encode([header.as_slice(), bytes].concat()).into_bytes(),
                (true, true) => (STANDARD.encode(header) + &STANDARD.encode(bytes)).into_bytes(),
            };
        };
        let size = old.block.max(1);
        let blocks = map_parts(bytes.chunks(size), |_, block| compress(compressor, block));
        let last = bytes.len() % size;
        let counts = [blocks.len(), old.block, last];
        let counts = counts.into_iter().chain(blocks.iter().map(Vec::len));
        let header: Vec<u8> = counts.flat_map(|count| self.bytes_of(count)).collect();
        match self.base64 {
            false => [header, blocks.concat()].concat(),
            true => (STANDARD.encode(header) + &STANDARD.encode(blocks.concat())).into_bytes(),
        }
    }

    /// Reads the first `count` integers of a header. In base64, the header must be a separate text.
    fn numbers(&self, input: &[u8], count: usize) -> Option<Vec<usize>> {
        let length = count.checked_mul(self.header)?;
        let decoded;
        let bytes = match self.base64 {
            false => input.get(..length)?,
            true => {
                decoded = decode(input.get(..encoded(length))?)?;
                decoded.get(..length)?
            }
        };
        bytes.chunks_exact(self.header).map(|number| self.number(number)).collect()
    }

    fn number(&self, bytes: &[u8]) -> Option<usize> {
        usize::try_from(self.order.whole(bytes)).ok()
    }

    fn bytes_of(&self, number: usize) -> Vec<u8> {
        let number = number as u64;
        match self.order {
            ByteOrder::Big => number.to_be_bytes()[8 - self.header..].to_vec(),
            ByteOrder::Little => number.to_le_bytes()[..self.header].to_vec(),
        }
    }
}

/// Returns the length of the base64 text for this many bytes.
fn encoded(bytes: usize) -> usize {
    bytes.div_ceil(3).saturating_mul(4)
}

/// Decodes base64. `None` if the text is not base64.
fn decode(text: &[u8]) -> Option<Vec<u8>> {
    STANDARD.decode(text).ok()
}

fn decompress(compressor: Compressor, block: &[u8], expected: usize) -> Option<Vec<u8>> {
    match compressor {
        Compressor::Zlib => zlib::decompress(block, expected),
        Compressor::Lz4 => lz4_flex::block::decompress(block, expected).ok(),
    }
}

fn compress(compressor: Compressor, block: &[u8]) -> Vec<u8> {
    match compressor {
        Compressor::Zlib => zlib::compress(block, zlib::USUAL_LEVEL),
        Compressor::Lz4 => lz4_flex::block::compress(block),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrapped_arrays_are_unwrapped_to_the_same_bytes() {
        let bytes: Vec<u8> = (0..10_007_u32).map(|n| (n * n / 7 % 251) as u8).collect();
        for order in [ByteOrder::Little, ByteOrder::Big] {
            for header in [4, 8] {
                for base64 in [false, true] {
                    for compressor in [None, Some(Compressor::Zlib), Some(Compressor::Lz4)] {
                        for header_apart in [false, true] {
                            let wrapping = BlockEncoding { order, header, compressor, base64 };
                            let old = DecodedBlocks {
                                bytes: Cow::default(),
                                encoded_length: 0,
                                block: 1000,
                                has_separate_header: header_apart,
                            };
                            for bytes in [&bytes[..], &bytes[..3000], &bytes[..1]] {
                                let mut wrapped = wrapping.wrap(&old, bytes);
                                let length = wrapped.len();
                                wrapped.extend_from_slice(b"   </DataArray>");
                                let back = wrapping.unwrap(&wrapped).unwrap();
                                assert!(back.bytes == bytes, "{wrapping:?} {header_apart}");
                                assert_eq!(
                                    back.encoded_length, length,
                                    "{wrapping:?} {header_apart}"
                                );
                                assert!(wrapping.unwrap(&wrapped[..length - 1]).is_none());
                                assert_eq!(wrapping.length(&wrapped), Some(length));
                                assert_eq!(wrapping.length(&wrapped[..length - 1]), None);
                            }
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn wrong_lengths_in_a_file_allocate_no_memory() {
        for compressor in [None, Some(Compressor::Zlib), Some(Compressor::Lz4)] {
            for base64 in [false, true] {
                let wrapping =
                    BlockEncoding { order: ByteOrder::Little, header: 8, compressor, base64 };
                for byte in [b'/', b'A', 0xFF, 1] {
                    assert!(
                        wrapping.unwrap(&[byte; 64]).is_none_or(|found| found.bytes.len() < 64)
                    );
                }
            }
        }
    }
}
