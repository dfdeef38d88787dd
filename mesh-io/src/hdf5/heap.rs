//! Fractal heaps, which hold the links or attributes of an object with many of them.

use super::bytes::{ByteReader, Hdf5Error};
use super::file_bytes::FileBytes;

/// A fractal heap with the addresses of its direct blocks.
pub(super) struct FractalHeap {
    /// Offset of the heap header in the file.
    at: usize,
    /// Widths in bytes of the offset and of the length in a heap ID.
    widths: [usize; 2],
    /// Direct blocks, ascending: offset in the heap, size in bytes, address in the file.
    blocks: Vec<(usize, usize, usize)>,
}

/// Doubling table of a fractal heap: the sizes and the number of blocks per row.
struct DoublingTable {
    /// Number of blocks in a row.
    width: usize,
    /// Size in bytes of the blocks in the first two rows. Blocks of each later row are twice as large.
    first: usize,
    /// Number of rows of direct blocks, which hold objects. Later rows hold indirect blocks, which are tables of
    /// blocks.
    direct: usize,
    /// Width in bytes of an offset in the heap.
    place: usize,
}

const OBJECT_NAME: &str = "a heap of the HDF5 file";

impl FractalHeap {
    /// Reads the heap header at offset `at`, and finds the direct blocks.
    pub(super) fn read(raw: &FileBytes<'_>, at: usize) -> Result<FractalHeap, Hdf5Error> {
        let mut bytes = raw.at(at, OBJECT_NAME);
        bytes.expect(b"FRHP\0")?;
        bytes.skip(2)?;
        let filters = bytes.count(2)?;
        bytes.skip(1)?;
        let most = bytes.count(4)?;
        let (address, length) = (raw.widths.address, raw.widths.length);
        // Fields about huge objects, free space and the numbers of objects.
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
        // A length in a heap ID is as wide as an offset in the largest direct block, or as the largest object's size if
        // narrower.
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

    /// Adds the direct blocks below the indirect block at address `root`, which has `rows` rows.
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
                                // An indirect block has as many rows as cover its size.
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

    /// Returns a reader of the object with a heap ID.
    pub(super) fn object<'a>(
        &self,
        raw: &FileBytes<'a>,
        id: &[u8],
    ) -> Result<ByteReader<'a>, Hdf5Error> {
        let damaged = || Hdf5Error::damaged(self.at, OBJECT_NAME);
        let mut own = ByteReader::new(id, 0, raw.widths, OBJECT_NAME);
        match own.byte().map_err(|_| damaged())? >> 4 & 3 {
            0 => {}
            // Huge objects are larger than a block, and tiny objects are stored in the heap ID itself.
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
    /// Returns the size in bytes of the blocks in a row; `None` if it overflows.
    fn size(&self, row: usize) -> Option<usize> {
        self.first.checked_shl(row.saturating_sub(1) as u32).filter(|&size| size >= self.first)
    }
}
