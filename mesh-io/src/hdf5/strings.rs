//! Texts of variable length, which h5py and h5netcdf write for attributes: objects in a collection of a global heap.

use super::bytes::{ByteReader, Hdf5Error};
use super::file_bytes::FileBytes;

const OBJECT_NAME: &str = "a text in the HDF5 file";

/// Returns the text to which the reference at `place` leads: a length, a collection's address, and an object's number.
pub(super) fn read<'a>(
    raw: &FileBytes<'a>,
    mut place: ByteReader<'_>,
) -> Result<&'a [u8], Hdf5Error> {
    let length = place.count(4)?;
    let collection = place.address()?;
    let number = place.count(4)?;
    match collection {
        // An empty text has no object in a collection.
        None | Some(0) if length == 0 => Ok(&[]),
        None => Err(place.damaged()),
        Some(at) => object(raw, at, number)?.take(length),
    }
}

/// Returns a reader of object `number` in the collection at offset `at`.
fn object<'a>(raw: &FileBytes<'a>, at: usize, number: usize) -> Result<ByteReader<'a>, Hdf5Error> {
    let mut bytes = raw.at(at, OBJECT_NAME);
    bytes.expect(b"GCOL\x01")?;
    bytes.skip(3)?;
    let size = bytes.length()?;
    let end = at.checked_add(size).ok_or_else(|| bytes.damaged())?;
    let start = bytes.at();
    raw.claim(at..start, &bytes)?;
    let mut bytes = bytes.within(start..end);
    loop {
        let start = bytes.at();
        let own = bytes.count(2)?;
        bytes.skip(2 + 4)?;
        let length = bytes.length()?;
        // Object 0 is the free space, which ends the collection.
        if own == 0 {
            return Err(bytes.damaged());
        }
        let content = bytes.at()..bytes.at().saturating_add(length);
        if own == number {
            raw.claim(start..content.end, &bytes)?;
            return Ok(bytes.within(content));
        }
        raw.count_metadata(bytes.at() - start, &bytes)?;
        bytes.skip(length)?;
        bytes.align(content.start, 8)?;
    }
}
