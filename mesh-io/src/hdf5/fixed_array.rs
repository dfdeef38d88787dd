//! Fixed arrays, in which datasets that do not grow have the places of their chunks.

use super::bytes::{ByteReader, Hdf5Error};
use super::checksum::Checksum;
use super::entry::Entry;
use super::file_bytes::FileBytes;

/// The index of the chunks of a dataset that does not grow: a fixed array of addresses.
pub(super) struct FixedArray {
    /// How many there are, and how many stand together under a checksum.
    count: usize,
    page: usize,
    /// How many bytes each has.
    size: usize,
    has_sizes: bool,
    /// Where the first slot stands; the pages follow each other.
    first: usize,
    /// Which pages there are, a bit for each from the highest on; none if the slots are all on one.
    pages: Option<Vec<u8>>,
    /// The checksum of all, if they are on one page.
    sum: Option<Checksum>,
}

/// The entry of one chunk in a fixed array.
pub(super) struct FixedArrayElement {
    pub(super) address: usize,
    /// How many bytes it has, if that is told.
    pub(super) length: Option<usize>,
    /// The filters that were left out.
    pub(super) mask: u32,
    pub(super) entry: Entry,
}

const OBJECT_NAME: &str = "the list of chunks of a dataset";

/// Reads the array at an address, of at least so many slots.
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

    /// What a slot says of its chunk; none if there is no chunk.
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
            // Once for each page.
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
