//! The bytes of an HDF5 file, the ranges that were read, and a limit on reads of metadata.

use super::bytes::{ByteReader, FieldWidths, Hdf5Error};
use super::checksum::Checksum;
use std::cell::{Cell, RefCell};
use std::ops::Range;

/// Signature of the superblock: the first eight bytes of a file.
pub(crate) const SIGNATURE: &[u8] = b"\x89HDF\r\n\x1A\n";

/// The bytes of an HDF5 file, with the contents of its superblock.
pub(super) struct FileBytes<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) widths: FieldWidths,
    pub(super) end: EndAddress,
    /// Byte ranges read so far, each with the offset of the object that owns the range. Ranges of two owners must not
    /// overlap, or an edit of one would damage the other.
    claimed: RefCell<Vec<(Range<usize>, usize)>>,
    /// Remaining number of metadata bytes that may be read. Without this limit, structures that refer to each other in
    /// a circle would be read forever.
    left: Cell<usize>,
}

/// Remedy for a file that is shorter than its superblock says.
const COPY_AGAIN: &str = "Copy it again, or write the mesh again";

/// Remedy for a file that starts with data of a program instead of HDF5.
pub(crate) const REMOVE_USER_BLOCK: &str =
    "Remove the user block with `h5unjam -i IN -o OUT --delete`";

/// Returns the size in bytes of the user block, data of a program that precede the superblock; `None` if no superblock
/// follows. The size is 512, 1024, 2048 and so on.
pub(crate) fn user_block(bytes: &[u8]) -> Option<usize> {
    let mut sizes = std::iter::successors(Some(512_usize), |size| size.checked_mul(2))
        .take_while(|&size| size < bytes.len());
    match bytes.starts_with(SIGNATURE) {
        true => None,
        false => sizes.find(|&size| bytes[size..].starts_with(SIGNATURE)),
    }
}

/// Limit on metadata reads after the object tree is built, in multiples of the file length. The limit stops files
/// whose structures refer to each other in a circle.
const MAX_REREADS: usize = 64;

/// Location of the end-of-file address in the superblock, which changes with the length of the file.
#[derive(Clone, Debug)]
pub(super) struct EndAddress {
    pub(super) range: Range<usize>,
    pub(super) sum: Option<Checksum>,
}

impl<'a> FileBytes<'a> {
    /// Reads the superblock. Returns the file with its field widths, and the offset of the root group's header.
    pub(super) fn new(bytes: &'a [u8]) -> Result<(FileBytes<'a>, usize), Hdf5Error> {
        let what = "the superblock of the HDF5 file";
        let none = FieldWidths { address: 8, length: 8 };
        let mut own = ByteReader::new(bytes, 0, none, what);
        if let Some(size) = user_block(bytes) {
            let problem = format!("cannot read HDF5 behind a user block of {size} bytes");
            return Err(Hdf5Error { at: size, problem, remedy: REMOVE_USER_BLOCK });
        }
        own.expect(SIGNATURE)?;
        let version = own.byte()?;
        own.skip(match version {
            0 | 1 => 4,
            2 | 3 => 0,
            _ => return Err(own.unread(format!("HDF5 with a superblock of version {version}"))),
        })?;
        let widths = FieldWidths { address: own.byte()?.into(), length: own.byte()?.into() };
        if ![widths.address, widths.length].iter().all(|width| [2, 4, 8].contains(width)) {
            return Err(own.damaged());
        }
        // A reserved byte, the ranks (K) of the B-trees, and the consistency flags.
        own.skip(match version {
            0 => 1 + 4 + 4,
            1 => 1 + 4 + 4 + 4,
            _ => 1,
        })?;
        let mut own = ByteReader::new(bytes, own.at(), widths, what);
        if own.address()? != Some(0) {
            return Err(own.unread("HDF5 that does not start with the file"));
        }
        own.skip(widths.address)?;
        let place = own.at()..own.at() + widths.address;
        // A file may be longer than its end address. If the file is shorter, some dataset is cut off, which is perhaps
        // not read, and the written file would be as short as this one.
        if let Some(end) = own.address()?.filter(|&end| end > bytes.len()) {
            let problem = format!("the file is cut off: {} of {end} bytes", bytes.len());
            return Err(Hdf5Error { at: bytes.len(), problem, remedy: COPY_AGAIN });
        }
        let sum;
        let root;
        if version < 2 {
            // The address of the driver information, and the offset of the root group's name.
            own.skip(2 * widths.address)?;
            (root, sum) = (own.address()?, None);
        } else {
            root = own.address()?;
            sum = Some(Checksum::take(0, &mut own)?);
        }
        let root = root.ok_or_else(|| own.damaged())?;
        let taken = RefCell::new(vec![(0..own.at(), 0)]);
        let left = Cell::new(bytes.len());
        Ok((
            FileBytes {
                bytes,
                widths,
                end: EndAddress { range: place, sum },
                claimed: taken,
                left,
            },
            root,
        ))
    }

    /// Returns a reader at offset `at`. Errors call the metadata object `what`.
    pub(super) fn at(&self, at: usize, what: &'static str) -> ByteReader<'a> {
        ByteReader::new(self.bytes, at, self.widths, what)
    }

    /// Records a range of metadata as read, owned by the object at its start, and counts its bytes.
    ///
    /// # Errors
    /// If the range ends beyond the file, or if more metadata was read than the limit allows.
    pub(super) fn claim(&self, range: Range<usize>, of: &ByteReader<'_>) -> Result<(), Hdf5Error> {
        if range.end > self.bytes.len() {
            return Err(of.damaged());
        }
        self.count_metadata(range.len(), of)?;
        self.claimed.borrow_mut().push((range.clone(), range.start));
        Ok(())
    }

    /// Counts `bytes` bytes of metadata as read.
    ///
    /// # Errors
    /// If more metadata was read than the limit allows.
    pub(super) fn count_metadata(
        &self,
        bytes: usize,
        of: &ByteReader<'_>,
    ) -> Result<(), Hdf5Error> {
        let left = self.left.get().checked_sub(bytes);
        self.left.set(left.ok_or_else(|| of.damaged())?);
        Ok(())
    }

    /// Records byte ranges with the items of the dataset whose header is at offset `object`.
    pub(super) fn claim_data(&self, ranges: impl Iterator<Item = Range<usize>>, object: usize) {
        self.claimed.borrow_mut().extend(ranges.map(|range| (range, object)));
    }

    /// Resets the limit on metadata reads to [`MAX_REREADS`] times the file length. Called once the object tree is
    /// built.
    pub(super) fn allow_rereads(&self) {
        self.left.set(self.bytes.len().saturating_mul(MAX_REREADS));
    }

    /// Returns the start of a range that overlaps the range sorted before it; `None` if no ranges overlap.
    pub(super) fn first_overlap(&self) -> Option<usize> {
        let mut taken = self.claimed.borrow_mut();
        taken.retain(|(range, _)| !range.is_empty());
        taken.sort_by_key(|(range, owner)| (range.start, range.end, *owner));
        taken.dedup();
        let shared = taken.windows(2).find(|pair| pair[0].0.end > pair[1].0.start);
        shared.map(|pair| pair[1].0.start)
    }
}
