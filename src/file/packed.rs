//! Files that are compressed as a whole, by gzip.

use flate2::Compression;
use flate2::read::MultiGzDecoder;
use flate2::write::GzEncoder;
use std::io::{self, Read, Write};
use std::path::Path;

/// The ending of the names of compressed files.
const ENDING: &str = ".gz";
/// How many bytes a compressed one may stand for. A lattice, as regular as meshes are, has 5 to 20 of them; gzip can do a
/// thousand.
const MOST: usize = 200;
/// So many bytes may be unpacked whatever the size of the compressed file.
const ALWAYS: usize = 1 << 20;

/// Why a compressed file is not read.
pub(crate) struct Unpackable {
    pub(crate) problem: String,
    pub(crate) remedy: &'static str,
}

/// Whether the name promises a compressed file.
pub(crate) fn has_ending(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("gz"))
}

/// The name of the file, in small letters, that is in a compressed one.
pub(crate) fn inner_name(name: &str) -> &str {
    name.strip_suffix(ENDING).unwrap_or(name)
}

/// The content of a file, if it is compressed.
pub(crate) fn unpack(bytes: &[u8]) -> Result<Option<Vec<u8>>, Unpackable> {
    /// What other programs open their files with.
    const OTHERS: [(&[u8], &str, &str); 4] = [
        (b"\x28\xB5\x2F\xFD", "zstd", "Decompress it first (unzstd), or compress it by gzip"),
        (b"\xFD7zXZ\0", "xz", "Decompress it first (unxz), or compress it by gzip"),
        (b"BZh", "bzip2", "Decompress it first (bunzip2), or compress it by gzip"),
        (b"PK\x03\x04", "zip", "Unpack it first (unzip), or compress it by gzip"),
    ];
    if let Some((_, name, remedy)) = OTHERS.iter().find(|(opens, ..)| bytes.starts_with(opens)) {
        return Err(Unpackable { problem: format!("it is compressed by {name}"), remedy });
    }
    if !bytes.starts_with(b"\x1F\x8B") {
        return Ok(None);
    }
    let most = bytes.len().saturating_mul(MOST).max(ALWAYS);
    let mut content = Vec::new();
    let limit = u64::try_from(most).unwrap_or(u64::MAX - 1) + 1;
    if let Err(error) = MultiGzDecoder::new(bytes).take(limit).read_to_end(&mut content) {
        let problem = format!("it is compressed by gzip, but damaged or cut off: {error}");
        return Err(Unpackable { problem, remedy: "Copy it again, or write the mesh again" });
    }
    if content.len() > most {
        let problem = format!("it unpacks to more than {MOST} times its size, which no mesh does");
        return Err(Unpackable { problem, remedy: "If it is one, decompress it first (gunzip)" });
    }
    Ok(Some(content))
}

/// Compresses what is written.
pub(crate) fn pack(
    out: &mut (dyn Write + Send),
    write: impl Fn(&mut (dyn Write + Send)) -> io::Result<()>,
) -> io::Result<()> {
    let mut encoder = GzEncoder::new(out, Compression::default());
    write(&mut encoder)?;
    encoder.finish().map(drop)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn packed(content: &[u8]) -> Vec<u8> {
        let mut out = Vec::new();
        pack(&mut out, |out| out.write_all(content)).unwrap();
        out
    }

    fn problem(bytes: &[u8]) -> String {
        unpack(bytes).err().map(|error| error.problem).unwrap_or_default()
    }

    #[test]
    fn what_is_packed_is_unpacked() {
        let content: Vec<u8> =
            (0..100_000_u32).flat_map(|n| n.wrapping_mul(n).to_le_bytes()).collect();
        assert_eq!(unpack(&packed(&content)).ok().flatten().as_deref(), Some(&content[..]));
        // Several in one, as parallel programs write them.
        let twice = [packed(b"$MeshFormat"), packed(b"\n4.1")].concat();
        assert_eq!(unpack(&twice).ok().flatten().as_deref(), Some(&b"$MeshFormat\n4.1"[..]));
        assert!(unpack(b"$MeshFormat").ok().flatten().is_none());
    }

    #[test]
    fn little_that_unpacks_to_much_is_no_mesh() {
        let bomb = packed(&vec![b' '; 50 << 20]);
        assert!(bomb.len() < 100_000);
        assert!(problem(&bomb).starts_with("it unpacks to more than 200 times its size"));
        assert!(problem(&packed(&[b' '; 1000])).is_empty());
    }

    #[test]
    fn damage_is_told() {
        let whole = packed(b"a mesh of some length, and more of it");
        for cut in 2..whole.len() {
            assert!(problem(&whole[..cut]).contains("damaged or cut off"), "{cut}");
        }
        let mut wrong = whole.clone();
        let checksum = whole.len() - 6;
        wrong[checksum] ^= 1;
        assert!(problem(&wrong).contains("damaged or cut off"));
        assert!(problem(b"\x28\xB5\x2F\xFDx").contains("by zstd"));
        assert!(problem(b"PK\x03\x04").contains("by zip"));
    }
}
