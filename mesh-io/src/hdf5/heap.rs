//! Fractal heaps, which hold the links and attributes of objects that have many.

use super::bytes::{ByteReader, Hdf5Error};
use super::file_bytes::FileBytes;

/// A fractal heap, with the addresses of its blocks.
pub(super) struct FractalHeap {
    at: usize,
    /// How many bytes the place of an object has, and its length.
    widths: [usize; 2],
    /// The place of each block in the heap, its size, and its address, by place.
    blocks: Vec<(usize, usize, usize)>,
}

/// Sizes of the blocks in each row of a fractal heap.
struct DoublingTable {
    width: usize,
    first: usize,
    /// The number of rows of blocks that hold objects; those after it hold tables of blocks.
    direct: usize,
    /// How many bytes a place in the heap has.
    place: usize,
}

const OBJECT_NAME: &str = "a heap of the HDF5 file";

impl FractalHeap {
    /// Reads where the blocks of a heap stand.
    pub(super) fn read(raw: &FileBytes<'_>, at: usize) -> Result<FractalHeap, Hdf5Error> {
        let mut bytes = raw.at(at, OBJECT_NAME);
        bytes.expect(b"FRHP\0")?;
        bytes.skip(2)?;
        let filters = bytes.count(2)?;
        bytes.skip(1)?;
        let most = bytes.count(4)?;
        let (address, length) = (raw.widths.address, raw.widths.length);
        // What is known of objects that are huge or tiny, and of free space.
        bytes.skip(2 * length + 2 * address + 8 * length)?;
        let width = bytes.count(2)?;
        let (first, largest) = (bytes.length()?, bytes.length()?);
        let bits = bytes.count(2)?;
        bytes.skip(2)?;
        let root = bytes.address()?;
        let rows = bytes.count(2)?;
        if filters > 0 {
            return Err(bytes.unread("a group whose links are compressed"));
        }
        let is_sound = first.is_power_of_two()
            && largest.is_power_of_two()
            && first <= largest
            && largest.ilog2() < 32
            && width.is_power_of_two()
            && (1..=64).contains(&bits);
        if !is_sound {
            return Err(bytes.damaged());
        }
        raw.claim(at..bytes.at(), &bytes)?;
        let direct = (largest.ilog2() - first.ilog2()) as usize + 2;
        let place = bits.div_ceil(8);
        let table = DoublingTable { width, first, direct, place };
        let mut heap = FractalHeap { at, widths: [place, 0], blocks: Vec::new() };
        // The length of an object has as many bytes as places in the largest block, or as the size of the largest object.
        let of_place = largest.ilog2().div_ceil(8);
        heap.widths[1] = of_place.min(most.max(1).ilog2() / 8 + 1) as usize;
        match (root, rows) {
            (None, _) => {}
            (Some(root), 0) => heap.blocks.push((0, first, root)),
            (Some(root), rows) => heap.indirect(raw, &table, root, rows)?,
        }
        heap.blocks.sort_unstable();
        Ok(heap)
    }

    /// Reads tables of blocks, from the one with so many rows on.
    fn indirect(
        &mut self,
        raw: &FileBytes<'_>,
        table: &DoublingTable,
        root: usize,
        rows: usize,
    ) -> Result<(), Hdf5Error> {
        let mut left = vec![(root, rows, 0)];
        while let Some((at, rows, start)) = left.pop() {
            let mut bytes = raw.at(at, OBJECT_NAME);
            if rows > 64 {
                return Err(bytes.damaged());
            }
            bytes.expect(b"FHIB\0")?;
            bytes.skip(raw.widths.address + table.place)?;
            let mut place = start;
            for row in 0..rows {
                let size = table.size(row).ok_or_else(|| bytes.damaged())?;
                for _ in 0..table.width {
                    if let Some(child) = bytes.address()? {
                        match row < table.direct {
                            true => self.blocks.push((place, size, child)),
                            false => {
                                // As many rows as make up the size of the block.
                                let rows = size.ilog2() + 1;
                                let less = table.first.ilog2() + table.width.ilog2();
                                let rows = rows.checked_sub(less).ok_or_else(|| bytes.damaged())?;
                                left.push((child, rows as usize, place));
                            }
                        }
                    }
                    place = usize::saturating_add(place, size);
                }
            }
            raw.claim(at..bytes.at(), &bytes)?;
        }
        Ok(())
    }

    /// The object of an identifier.
    pub(super) fn object<'a>(
        &self,
        raw: &FileBytes<'a>,
        id: &[u8],
    ) -> Result<ByteReader<'a>, Hdf5Error> {
        let damaged = || Hdf5Error::damaged(self.at, OBJECT_NAME);
        let mut own = ByteReader::new(id, 0, raw.widths, OBJECT_NAME);
        match own.byte().map_err(|_| damaged())? >> 4 & 3 {
            0 => {}
            // Objects beyond the size of a block, and some that stand in their identifiers.
            _ => return Err(Hdf5Error::unread(self.at, "a group with names longer than a block")),
        }
        let mut number = |width| own.count(width).map_err(|_| damaged());
        let (place, length) = (number(self.widths[0])?, number(self.widths[1])?);
        let after = self.blocks.partition_point(|&(start, ..)| start <= place);
        let block = after.checked_sub(1).map(|block| self.blocks[block]);
        let (start, size, at) = block.ok_or_else(damaged)?;
        let from = place - start;
        if from.checked_add(length).is_none_or(|end| end > size) {
            return Err(damaged());
        }
        let at = at.saturating_add(from);
        Ok(raw.at(at, "a link or an attribute").within(at..at.saturating_add(length)))
    }
}

impl DoublingTable {
    /// The size of the blocks of a row.
    fn size(&self, row: usize) -> Option<usize> {
        self.first.checked_shl(row.saturating_sub(1) as u32).filter(|&size| size >= self.first)
    }
}
