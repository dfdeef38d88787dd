//! Fixed arrays: the index of chunks of a dataset whose dimensions have limits.

use super::bytes::{ByteReader, Hdf5Error};
use super::checksum::Checksum;
use super::entry::Entry;
use super::file_bytes::FileBytes;

/// Fixed array: an entry with an address for each chunk of the dataset's largest shape.
pub(super) struct FixedArray {
    /// Number of entries.
    count: usize,
    /// Number of entries per page. If the entries exceed one page, each page has its own checksum.
    page: usize,
    /// Width of an entry in bytes.
    size: usize,
    /// Whether entries also hold the stored size and the filter mask, as in datasets with filters.
    has_sizes: bool,
    /// Offset of the first entry. Pages are adjacent, each followed by its checksum.
    first: usize,
    /// Bitmap of the pages that were written, the highest bit first; `None` if a single page holds all entries.
    pages: Option<Vec<u8>>,
    /// Checksum of all entries; `None` if several pages have checksums of their own.
    sum: Option<Checksum>,
}

/// Contents of an entry, with the locations of its fields.
pub(super) struct FixedArrayElement {
    pub(super) address: usize,
    /// Stored size of the chunk in bytes; `None` without filters.
    pub(super) length: Option<usize>,
    /// Mask of the filters that were skipped for the chunk.
    pub(super) mask: u32,
    pub(super) entry: Entry,
}

const OBJECT_NAME: &str = "the list of chunks of a dataset";

/// Reads the header and the data block of the fixed array at offset `at`. The array must have at least `least` entries.
/// `has_sizes` is whether the dataset has filters.
pub(super) fn read(
    raw: &FileBytes<'_>,
    at: usize,
    least: usize,
    has_sizes: bool,
) -> Result<FixedArray, Hdf5Error> {
    let mut bytes = raw.at(at, OBJECT_NAME);
    bytes.expect(b"FAHD\0")?;
    bytes.expect(&[u8::from(has_sizes)])?;
    let size = bytes.count(1)?;
    let bits = u32::from(bytes.byte()?);
    let count = bytes.length()?;
    let address = bytes.address()?.ok_or_else(|| bytes.damaged())?;
    Checksum::take(at, &mut bytes)?;
    raw.claim(at..bytes.at(), &bytes)?;
    let own = raw.widths.address + if has_sizes { 4 + 1 } else { 0 };
    let page = 1_usize.checked_shl(bits).filter(|_| (1..32).contains(&bits));
    let page = page.ok_or_else(|| bytes.damaged())?;
    if count < least || size < own || size > own + 7 || count > raw.bytes.len() {
        return Err(bytes.damaged());
    }
    let mut bytes = raw.at(address, OBJECT_NAME);
    bytes.expect(b"FADB\0")?;
    bytes.expect(&[u8::from(has_sizes)])?;
    bytes.address()?;
    let mut slots = FixedArray { count, page, size, has_sizes, first: 0, pages: None, sum: None };
    if count > page {
        let pages = bytes.take(count.div_ceil(page).div_ceil(8))?.to_vec();
        slots.pages = Some(pages);
        Checksum::take(address, &mut bytes)?;
        slots.first = bytes.at();
    } else {
        slots.first = bytes.at();
        bytes.skip(count * size)?;
        slots.sum = Some(Checksum::take(address, &mut bytes)?);
    }
    raw.claim(address..bytes.at(), &bytes)?;
    Ok(slots)
}

impl FixedArray {
    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// Returns the contents of entry `number`; `None` if the chunk was never written.
    pub(super) fn slot(
        &self,
        raw: &FileBytes<'_>,
        number: usize,
    ) -> Result<Option<FixedArrayElement>, Hdf5Error> {
        let (page, place) = (number / self.page, number % self.page);
        let mut sum = self.sum.clone();
        let mut start = self.first;
        if let Some(pages) = &self.pages {
            if pages.get(page / 8).is_none_or(|bits| bits & 0x80 >> (page % 8) == 0) {
                return Ok(None);
            }
            start += page * (self.page * self.size + 4);
            let own = self.page.min(self.count - page * self.page) * self.size;
            // The checksum of a page is verified once, with the page's first entry.
            match place {
                0 => sum = Some(self.page_sum(raw, &mut raw.at(start, OBJECT_NAME), own)?),
                _ => sum = Some(Checksum { covered: start..start + own }),
            }
        }
        let mut bytes: ByteReader<'_> = raw.at(start + place * self.size, OBJECT_NAME);
        let address_at = bytes.at();
        let Some(address) = bytes.address()? else { return Ok(None) };
        let mut entry = Entry { address: address_at, size: None, sum };
        if !self.has_sizes {
            return Ok(Some(FixedArrayElement { address, length: None, mask: 0, entry }));
        }
        let start = bytes.at();
        let length = bytes.count(self.size - raw.widths.address - 4)?;
        entry.size = Some(start..bytes.at());
        let mask = bytes.number(4)? as u32;
        Ok(Some(FixedArrayElement { address, length: Some(length), mask, entry }))
    }

    fn page_sum(
        &self,
        raw: &FileBytes<'_>,
        bytes: &mut ByteReader<'_>,
        own: usize,
    ) -> Result<Checksum, Hdf5Error> {
        let start = bytes.at();
        bytes.skip(own)?;
        let sum = Checksum::take(start, bytes)?;
        raw.claim(start..bytes.at(), bytes)?;
        Ok(sum)
    }
}
