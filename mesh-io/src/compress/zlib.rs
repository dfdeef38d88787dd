//! Blocks that are compressed by zlib within VTK XML and HDF5 files.

use flate2::Compression;
use flate2::read::{ZlibDecoder, ZlibEncoder};
use std::io::Read;

/// The level of compression that zlib uses if none is given.
pub(crate) const USUAL_LEVEL: u32 = 6;

/// The most bytes that one compressed byte may stand for. Deflate reaches 1032, LZ4 255.
const MAX_EXPANSION: usize = 1100;

/// Whether so many compressed bytes can stand for `length` bytes. If not, a length in the file is wrong.
pub(crate) fn can_expand(compressed: usize, length: usize) -> bool {
    length <= compressed.saturating_mul(MAX_EXPANSION)
}

/// Decompresses bytes up to a length of `limit`. Returns `None` if they are damaged.
pub(crate) fn decompress(bytes: &[u8], limit: usize) -> Option<Vec<u8>> {
    let mut whole = Vec::new();
    ZlibDecoder::new(bytes).take(limit as u64).read_to_end(&mut whole).ok()?;
    Some(whole)
}

pub(crate) fn compress(bytes: &[u8], level: u32) -> Vec<u8> {
    let mut compressed = Vec::new();
    let mut encoder = ZlibEncoder::new(bytes, Compression::new(level));
    encoder.read_to_end(&mut compressed).expect("memory can be read");
    compressed
}
