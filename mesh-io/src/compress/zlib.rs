//! Compression of blocks by zlib, for VTK XML and HDF5 files.

use flate2::Compression;
use flate2::read::{ZlibDecoder, ZlibEncoder};
use std::io::Read;

/// Default compression level of zlib.
pub(crate) const USUAL_LEVEL: u32 = 6;

/// Limit on the decompressed bytes per compressed byte. Deflate reaches 1032, LZ4 255.
const MAX_EXPANSION: usize = 1100;

/// Returns whether `compressed` bytes can decompress to `length` bytes. Otherwise the file gives a wrong length.
pub(crate) fn can_expand(compressed: usize, length: usize) -> bool {
    length <= compressed.saturating_mul(MAX_EXPANSION)
}

/// Decompresses at most `limit` bytes. Returns `None` if the compressed bytes are damaged.
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
