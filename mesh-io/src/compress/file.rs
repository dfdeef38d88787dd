//! Files that are compressed as a whole, by gzip or zstd.

use flate2::read::MultiGzDecoder;
use flate2::write::GzEncoder;
use ruzstd::decoding::{BlockDecodingStrategy, FrameDecoder, StreamingDecoder};
use ruzstd::encoding::{CompressionLevel, compress_to_vec};
use std::io::{self, Read, Write};
use std::path::Path;

/// Limit on the decompressed size, in multiples of the compressed size. Meshes of regular grids reach 5 to 20; gzip
/// allows a thousand.
const MAX_RATIO: usize = 200;
/// Decompressed size in bytes that is allowed for any file, however small.
const MIN_LIMIT: usize = 1 << 20;

/// The compression of a whole file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Compression {
    Gzip,
    Zstd,
}

/// The bytes of a compressed file as they were read, and their compression.
pub(crate) struct CompressedFile {
    pub(crate) compression: Compression,
    pub(crate) bytes: Vec<u8>,
}

/// A problem that prevents decompression, and a remedy.
#[derive(Debug)]
pub(crate) struct DecompressError {
    pub(crate) problem: String,
    pub(crate) remedy: &'static str,
}

impl Compression {
    const ALL: [Compression; 2] = [Compression::Gzip, Compression::Zstd];

    /// Returns the extension of file names for the compression, without the dot.
    fn extension(self) -> &'static str {
        match self {
            Compression::Gzip => "gz",
            Compression::Zstd => "zst",
        }
    }

    fn name(self) -> &'static str {
        match self {
            Compression::Gzip => "gzip",
            Compression::Zstd => "zstd",
        }
    }

    /// Returns the first bytes of files with the compression.
    fn magic(self) -> &'static [u8] {
        match self {
            Compression::Gzip => b"\x1F\x8B",
            Compression::Zstd => b"\x28\xB5\x2F\xFD",
        }
    }

    /// Returns the compression of a path's extension, in capital or small letters; `None` for other extensions.
    pub(crate) fn of(path: &Path) -> Option<Compression> {
        let ending = path.extension()?;
        Self::ALL
            .into_iter()
            .find(|compression| ending.eq_ignore_ascii_case(compression.extension()))
    }

    /// Compresses the bytes that `write` writes, and writes them to `out`.
    pub(crate) fn compress(
        self,
        out: &mut (dyn Write + Send),
        write: impl Fn(&mut (dyn Write + Send)) -> io::Result<()>,
    ) -> io::Result<()> {
        match self {
            Compression::Gzip => {
                let mut encoder = GzEncoder::new(out, flate2::Compression::default());
                write(&mut encoder)?;
                encoder.finish().map(drop)
            }
            Compression::Zstd => {
                let mut content: Vec<u8> = Vec::new();
                write(&mut content)?;
                out.write_all(&compress_to_vec(content.as_slice(), CompressionLevel::Fastest))
            }
        }
    }
}

/// Returns a file name without the extension of a compression, or the name itself if it has none. `name` must be in
/// small letters.
pub(crate) fn inner_name(name: &str) -> &str {
    let inner =
        |compression: Compression| name.strip_suffix(compression.extension())?.strip_suffix('.');
    Compression::ALL.into_iter().find_map(inner).unwrap_or(name)
}

/// Decompresses the beginning of a file that is compressed by gzip or zstd, from the beginning of the compressed file.
/// `None` if the file is not compressed.
pub(crate) fn beginning(compressed: &[u8]) -> Option<Vec<u8>> {
    /// Largest number of decompressed bytes.
    const LENGTH: usize = 1 << 16;
    let found = Compression::ALL.into_iter().find(|own| compressed.starts_with(own.magic()))?;
    let mut content: Box<dyn Read + '_> = match found {
        Compression::Gzip => Box::new(MultiGzDecoder::new(compressed)),
        Compression::Zstd => Box::new(StreamingDecoder::new(compressed).ok()?),
    };
    let (mut head, mut bytes) = (Vec::new(), [0; 1 << 10]);
    // The end of the compressed bytes is an error within a block, after the content of earlier blocks.
    while let Ok(length @ 1..) = content.read(&mut bytes)
        && head.len() < LENGTH
    {
        head.extend_from_slice(&bytes[..length]);
    }
    Some(head)
}

/// Decompresses a file if its first bytes are those of gzip or zstd. Returns the compression and the content; `None`
/// if the file is not compressed.
pub(crate) fn decompress(bytes: &[u8]) -> Result<Option<(Compression, Vec<u8>)>, DecompressError> {
    /// First bytes of files in unsupported compressions, with the name of the compression and a remedy.
    const OTHERS: [(&[u8], &str, &str); 3] = [
        (b"\xFD7zXZ\0", "xz", "Decompress it first (unxz), or compress it by gzip or zstd"),
        (b"BZh", "bzip2", "Decompress it first (bunzip2), or compress it by gzip or zstd"),
        (b"PK\x03\x04", "zip", "Unpack it first (unzip), or compress it by gzip or zstd"),
    ];
    if let Some((_, name, remedy)) = OTHERS.iter().find(|(opens, ..)| bytes.starts_with(opens)) {
        return Err(DecompressError { problem: format!("it is compressed by {name}"), remedy });
    }
    let opens = |compression: &Compression| bytes.starts_with(compression.magic());
    let Some(compression) = Compression::ALL.into_iter().find(opens) else { return Ok(None) };
    let most = bytes.len().saturating_mul(MAX_RATIO).max(MIN_LIMIT);
    let mut content = Vec::new();
    let decompressed = match compression {
        Compression::Gzip => decompress_gzip(bytes, most, &mut content),
        Compression::Zstd => decompress_zstd(bytes, most, &mut content),
    };
    let name = compression.name();
    if let Err(error) = decompressed {
        let problem = format!("it is compressed by {name}, but damaged or cut off: {error}");
        return Err(DecompressError { problem, remedy: "Copy it again, or write the mesh again" });
    }
    if content.len() > most {
        let problem =
            format!("it unpacks to more than {MAX_RATIO} times its size, which no mesh does");
        let remedy = match compression {
            Compression::Gzip => "If the file is a mesh, decompress the file first (gunzip)",
            Compression::Zstd => "If the file is a mesh, decompress the file first (unzstd)",
        };
        return Err(DecompressError { problem, remedy });
    }
    Ok(Some((compression, content)))
}

/// Decompresses all members of a gzip file, up to one byte more than `most`. The additional byte shows the caller that
/// the limit is exceeded.
fn decompress_gzip(bytes: &[u8], most: usize, content: &mut Vec<u8>) -> Result<(), String> {
    let limit = u64::try_from(most).unwrap_or(u64::MAX - 1) + 1;
    let read = MultiGzDecoder::new(bytes).take(limit).read_to_end(content);
    read.map(drop).map_err(|error| error.to_string())
}

/// Decompresses frame after frame of a zstd file, until the content has more than `most` bytes.
fn decompress_zstd(mut bytes: &[u8], most: usize, content: &mut Vec<u8>) -> Result<(), String> {
    /// Number of decompressed bytes after which the limit is checked.
    const STEP: usize = 1 << 20;
    let mut decoder = FrameDecoder::new();
    while !bytes.is_empty() {
        if let Some(rest) = after_skipped(bytes)? {
            bytes = rest;
            continue;
        }
        decoder.init(&mut bytes).map_err(|error| error.to_string())?;
        loop {
            let strategy = BlockDecodingStrategy::UptoBytes(STEP);
            decoder.decode_blocks(&mut bytes, strategy).map_err(|error| error.to_string())?;
            content.extend(decoder.collect().unwrap_or_default());
            if content.len() > most {
                return Ok(());
            }
            if decoder.is_finished() {
                break;
            }
        }
        let stored = decoder.get_checksum_from_data();
        if stored.is_some() && stored != decoder.get_calculated_checksum() {
            return Err("the checksum does not match".into());
        }
    }
    Ok(())
}

/// Returns the bytes after a skippable frame; `None` if `bytes` start with another frame.
fn after_skipped(bytes: &[u8]) -> Result<Option<&[u8]>, String> {
    match bytes {
        [0x50..=0x5F, 0x2A, 0x4D, 0x18, rest @ ..] => {
            let after = rest.split_first_chunk().and_then(|(&size, rest)| {
                rest.get(usize::try_from(u32::from_le_bytes(size)).ok()?..)
            });
            after.map(Some).ok_or_else(|| "a frame is cut off".into())
        }
        _ => Ok(None),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn packed(compression: Compression, content: &[u8]) -> Vec<u8> {
        let mut out = Vec::new();
        compression.compress(&mut out, |out| out.write_all(content)).unwrap();
        out
    }

    fn problem(bytes: &[u8]) -> String {
        decompress(bytes).err().map(|error| error.problem).unwrap_or_default()
    }

    #[test]
    fn compressed_bytes_are_decompressed_to_the_same() {
        let content: Vec<u8> =
            (0..100_000_u32).flat_map(|n| n.wrapping_mul(n).to_le_bytes()).collect();
        let text: String = (0..60_000).map(|n| format!("{n} {:?}\n", f64::from(n) * 0.1)).collect();
        for compression in Compression::ALL {
            let decompressed = |bytes: &[u8]| {
                let (found, content) = decompress(bytes).unwrap().unwrap();
                assert_eq!(found, compression);
                content
            };
            for content in [&content[..], text.as_bytes(), b"", b"a", &[7; 4000]] {
                assert!(decompressed(&packed(compression, content)) == content, "{compression:?}");
            }
            // Parallel programs write several compressed parts, one after the other.
            let twice =
                [packed(compression, b"$MeshFormat"), packed(compression, b"\n4.1")].concat();
            assert_eq!(decompressed(&twice), b"$MeshFormat\n4.1");
        }
        let skipped =
            [&packed(Compression::Zstd, b"a")[..], b"\x53\x2A\x4D\x18\x02\0\0\0xy"].concat();
        assert_eq!(decompress(&skipped).unwrap().unwrap().1, b"a");
        assert!(problem(&skipped[..skipped.len() - 1]).contains("a frame is cut off"));
        assert!(decompress(b"$MeshFormat").ok().flatten().is_none());
    }

    /// A file that the zstd command has written, with a checksum.
    #[test]
    fn files_compressed_by_other_programs_are_decompressed() {
        // printf 'mesh mesh mesh mesh mesh mesh mesh mesh\n' | zstd
        let file =
            b"\x28\xb5\x2f\xfd\x04\x58\x65\x00\x00\x30\x6d\x65\x73\x68\x20\x0a\x01\x00\x70\x8a\x16\x9f\xd2\x6b\x88";
        match decompress(file) {
            Ok(Some((_, content))) => {
                assert_eq!(content, b"mesh mesh mesh mesh mesh mesh mesh mesh\n")
            }
            other => panic!("{other:?}"),
        }
        let mut wrong = file.to_vec();
        *wrong.last_mut().unwrap() ^= 1;
        assert!(problem(&wrong).contains("the checksum does not match"));
    }

    #[test]
    fn a_decompression_bomb_is_refused() {
        for compression in Compression::ALL {
            let bomb = packed(compression, &vec![b' '; 50 << 20]);
            assert!(bomb.len() < 100_000);
            assert!(problem(&bomb).starts_with("it unpacks to more than 200 times its size"));
            assert!(problem(&packed(compression, &[b' '; 1000])).is_empty());
        }
    }

    #[test]
    fn damaged_or_cut_off_compressed_bytes_are_an_error() {
        for compression in Compression::ALL {
            let whole =
                packed(compression, b"a mesh of some length, and more of it, and more of it");
            for cut in 4..whole.len() {
                assert!(
                    problem(&whole[..cut]).contains("damaged or cut off"),
                    "{compression:?} {cut}"
                );
            }
            for at in 4..whole.len() {
                for byte in [0, 1, 0x7F, 0xFF] {
                    let mut wrong = whole.clone();
                    wrong[at] = byte;
                    // Damage must cause an error or no harm, but never a panic or a large use of memory.
                    let _ = decompress(&wrong);
                }
            }
        }
        let mut wrong = packed(Compression::Gzip, b"a mesh of some length, and more of it");
        let checksum = wrong.len() - 6;
        wrong[checksum] ^= 1;
        assert!(problem(&wrong).contains("damaged or cut off"));
        assert!(problem(b"BZh9").contains("by bzip2"));
        assert!(problem(b"PK\x03\x04").contains("by zip"));
    }
}
