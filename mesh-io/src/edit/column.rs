//! Columns of numbers in a file, with old and new values for a rewrite.

use crate::edit::numbers::{CoordinateEncoding, NumberEncoding, Offsets};
use std::ops::Range;

/// Old and new values of numbers that a file stores at ascending offsets.
pub(crate) struct EditableColumn<'a> {
    at: ItemOffsets<'a>,
    encoding: NumberEncoding,
    old: &'a [f64],
    new: &'a [f64],
    /// Item `i` has index `first + step * i` in `old` and `new`; with `owners`, index `first + step * owners[i]`.
    first: usize,
    step: usize,
    /// The vertex of each item in a file with repeated vertices; `None` if item `i` is vertex `i`.
    owners: Option<&'a [u32]>,
}

/// Offsets of the items of a column.
enum ItemOffsets<'a> {
    /// Each item is a number. It starts at an offset of the list plus a shift in bytes, which may be negative.
    After(&'a Offsets, isize),
    /// Each item is a pair of numbers: x starts at an offset of the list, and y is the next token.
    Pairs(&'a Offsets),
}

/// Replacement of a number: byte range in the file, new value and encoding.
pub(crate) struct NumberEdit {
    pub(crate) range: Range<usize>,
    pub(crate) value: f64,
    pub(crate) encoding: NumberEncoding,
    /// Least width of the new text in characters, reached by padding with blanks; 0 permits any length.
    pub(crate) width: usize,
}

impl<'a> EditableColumn<'a> {
    /// Makes columns for the coordinates of vertices, given the offset of each x: a column of pairs for text, a column
    /// per axis for binary numbers. In files with repeated vertices, `owners` holds the vertex of each offset.
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

    /// Makes a column for an array of numbers at `offsets`.
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

    /// Returns the exclusive end of an item in `bytes`.
    pub(crate) fn end(&self, bytes: &[u8], item: usize) -> usize {
        let (end, _) = self.encoding.extent(bytes, self.start(item));
        match self.at {
            ItemOffsets::Pairs(_) => self.encoding.extent(bytes, self.encoding.next(bytes, end)).0,
            ItemOffsets::After(..) => end,
        }
    }

    /// Returns the index of the first item that starts at or behind `at`; if all items start before, the item count.
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

    /// Appends an edit to `changes` for each new number in `items` that differs from its old number after rounding to
    /// the file's precision.
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
