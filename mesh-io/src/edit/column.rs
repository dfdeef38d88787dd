//! Numbers of a file that may be replaced, with their new values.

use crate::edit::numbers::{CoordinateEncoding, NumberEncoding, Offsets};
use std::ops::Range;

/// Old and new values of numbers that a file stores at ascending offsets.
pub(crate) struct EditableColumn<'a> {
    at: ItemOffsets<'a>,
    encoding: NumberEncoding,
    old: &'a [f64],
    new: &'a [f64],
    /// Item `i` is number `first + step * i` of `old` and `new`.
    first: usize,
    step: usize,
    /// The `i` of each item, if several items have the same number.
    owners: Option<&'a [u32]>,
}

/// Offsets of the items of a column.
enum ItemOffsets<'a> {
    /// Each item starts this many bytes after one of these places; before it, if that is negative.
    After(&'a Offsets, isize),
    /// Each item is two numbers: one at one of these places, and the next token after it.
    Pairs(&'a Offsets),
}

/// A number to be replaced, with its range in the file.
pub(crate) struct NumberEdit {
    pub(crate) range: Range<usize>,
    pub(crate) value: f64,
    pub(crate) encoding: NumberEncoding,
    /// How many characters the number must have at least, with blanks.
    pub(crate) width: usize,
}

impl<'a> EditableColumn<'a> {
    /// Makes columns for the coordinates of vertices, from the places of x. If a vertex has several places, `owners`
    /// gives the vertex of each place.
    pub(crate) fn of_points(
        x_at: &'a Offsets,
        owners: Option<&'a [u32]>,
        numbers: CoordinateEncoding,
        old: &'a [[f64; 2]],
        new: &'a [[f64; 2]],
    ) -> Vec<EditableColumn<'a>> {
        let column = |at, first| {
            let (old, new) = (old.as_flattened(), new.as_flattened());
            EditableColumn { at, encoding: numbers.into(), old, new, first, step: 2, owners }
        };
        match numbers {
            CoordinateEncoding::Text { .. } | CoordinateEncoding::Fields { .. } => {
                vec![column(ItemOffsets::Pairs(x_at), 0)]
            }
            CoordinateEncoding::Binary { y_after, .. } => {
                vec![
                    column(ItemOffsets::After(x_at, 0), 0),
                    column(ItemOffsets::After(x_at, y_after), 1),
                ]
            }
        }
    }

    /// Makes a column for the numbers of an array.
    pub(crate) fn of_array(
        offsets: &'a Offsets,
        encoding: NumberEncoding,
        old: &'a [f64],
        new: &'a [f64],
    ) -> EditableColumn<'a> {
        EditableColumn {
            at: ItemOffsets::After(offsets, 0),
            encoding,
            old,
            new,
            first: 0,
            step: 1,
            owners: None,
        }
    }

    fn count(&self) -> usize {
        match (self.offsets(), self.owners) {
            (Offsets::List(list), _) => list.len(),
            (Offsets::Regular { .. }, Some(owners)) => owners.len(),
            (Offsets::Regular { .. }, None) => self.old.len() / self.step,
        }
    }

    fn start(&self, item: usize) -> usize {
        match self.at {
            ItemOffsets::After(offsets, shift) => offsets.at(item).saturating_add_signed(shift),
            ItemOffsets::Pairs(offsets) => offsets.at(item),
        }
    }

    fn offsets(&self) -> &'a Offsets {
        match self.at {
            ItemOffsets::After(offsets, _) | ItemOffsets::Pairs(offsets) => offsets,
        }
    }

    /// Returns the byte after an item.
    pub(crate) fn end(&self, bytes: &[u8], item: usize) -> usize {
        let (end, _) = self.encoding.extent(bytes, self.start(item));
        match self.at {
            ItemOffsets::Pairs(_) => self.encoding.extent(bytes, self.encoding.next(bytes, end)).0,
            ItemOffsets::After(..) => end,
        }
    }

    /// Returns the first item that starts at this byte or later.
    pub(crate) fn first_from(&self, at: usize) -> usize {
        let (mut low, mut high) = (0, self.count());
        while low < high {
            let middle = low + (high - low) / 2;
            match self.start(middle) < at {
                true => low = middle + 1,
                false => high = middle,
            }
        }
        low
    }

    /// Adds the numbers of some items that have changed, rounded to the precision of the file.
    pub(crate) fn changes(&self, bytes: &[u8], items: Range<usize>, changes: &mut Vec<NumberEdit>) {
        let encoding = self.encoding;
        let mut add = |number: usize, start: usize, extent: Option<(usize, usize)>| {
            let value = encoding.precision().rounded(self.new[number]);
            if value.to_bits() != self.old[number].to_bits() {
                let (end, width) = extent.unwrap_or_else(|| encoding.extent(bytes, start));
                changes.push(NumberEdit { range: start..end, value, encoding, width });
            }
        };
        for item in items {
            let index = self.owners.map_or(item, |owners| owners[item] as usize);
            let (start, number) = (self.start(item), self.first + self.step * index);
            match self.at {
                ItemOffsets::Pairs(_) => {
                    let extent = encoding.extent(bytes, start);
                    add(number, start, Some(extent));
                    add(number + 1, encoding.next(bytes, extent.0), None);
                }
                _ => add(number, start, None),
            }
        }
    }
}
