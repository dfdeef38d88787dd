//! Compression by gzip, Zstandard and zlib, with limits on the decompressed size.

pub(crate) mod file;
pub(crate) mod zlib;
