//! Numbers of a file that may be replaced, and by what.

use crate::file::numbers::{Form, Numbers, Places};
use crate::file::token::{number_end, skip_to_number};
use crate::mesh::Precision;
use std::io::Write;
use std::ops::Range;

/// A list of numbers of a file, in the order in which they stand there.
pub(crate) struct Column<'a> {
    at: At<'a>,
    form: Form,
    old: &'a [f64],
    new: &'a [f64],
    /// The number of item `i` is `first + step * i` of those lists.
    first: usize,
    step: usize,
    /// What counts as `i` for each item, if several items are one number.
    owners: Option<&'a [u32]>,
}

/// Where the items of a column start.
enum At<'a> {
    /// So many bytes after each of these places.
    After(&'a Places, usize),
    /// Each of these places, with a second number the token after the first.
    Pairs(&'a Places),
}

/// A number to be replaced.
pub(crate) struct Change {
    pub(crate) range: Range<usize>,
    pub(crate) value: f64,
    pub(crate) form: Form,
}

impl<'a> Column<'a> {
    /// The coordinates of vertices, whose x start at these places. A vertex may have several: then its index is given for each
    /// place.
    pub(crate) fn of_points(
        (x_at, owners): (&'a Places, Option<&'a [u32]>),
        numbers: Numbers,
        old: &'a [[f64; 2]],
        new: &'a [[f64; 2]],
    ) -> Vec<Column<'a>> {
        let column = |at, first| {
            let (old, new) = (old.as_flattened(), new.as_flattened());
            Column { at, form: numbers.into(), old, new, first, step: 2, owners }
        };
        match numbers {
            Numbers::Text { .. } => vec![column(At::Pairs(x_at), 0)],
            Numbers::Binary { y_after, .. } => {
                vec![column(At::After(x_at, 0), 0), column(At::After(x_at, y_after), 1)]
            }
        }
    }

    /// The numbers of an array.
    pub(crate) fn of_array(
        places: &'a Places,
        form: Form,
        old: &'a [f64],
        new: &'a [f64],
    ) -> Column<'a> {
        Column { at: At::After(places, 0), form, old, new, first: 0, step: 1, owners: None }
    }

    fn count(&self) -> usize {
        match (self.places(), self.owners) {
            (Places::List(list), _) => list.len(),
            (Places::Regular { .. }, Some(owners)) => owners.len(),
            (Places::Regular { .. }, None) => self.old.len() / self.step,
        }
    }

    fn start(&self, item: usize) -> usize {
        match self.at {
            At::After(places, shift) => places.at(item) + shift,
            At::Pairs(places) => places.at(item),
        }
    }

    fn places(&self) -> &'a Places {
        match self.at {
            At::After(places, _) | At::Pairs(places) => places,
        }
    }

    /// Where an item ends.
    pub(crate) fn end(&self, bytes: &[u8], item: usize) -> usize {
        let start = self.start(item);
        match (&self.at, self.form) {
            (_, Form::Binary(_, precision)) => start + precision.bytes(),
            (At::Pairs(_), _) => number_end(bytes, skip_to_number(bytes, number_end(bytes, start))),
            _ => number_end(bytes, start),
        }
    }

    /// The first item that starts at this byte or later.
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

    /// Adds the numbers of some items that are not as they were, in the digits of the file.
    pub(crate) fn changes(&self, bytes: &[u8], items: Range<usize>, changes: &mut Vec<Change>) {
        let form = self.form;
        let mut add = |number: usize, start: usize, end: Option<usize>| {
            let value = form.precision().rounded(self.new[number]);
            if value.to_bits() != self.old[number].to_bits() {
                let end = end.unwrap_or_else(|| match form {
                    Form::Binary(_, precision) => start + precision.bytes(),
                    Form::Text(_) => number_end(bytes, start),
                });
                changes.push(Change { range: start..end, value, form });
            }
        };
        for item in items {
            let index = self.owners.map_or(item, |owners| owners[item] as usize);
            let (start, number) = (self.start(item), self.first + self.step * index);
            match self.at {
                At::Pairs(_) => {
                    let end = number_end(bytes, start);
                    add(number, start, Some(end));
                    add(number + 1, skip_to_number(bytes, end), None);
                }
                _ => add(number, start, None),
            }
        }
    }
}

impl Form {
    /// Writes a number; as text, with the fewest digits that parse back to the same bits.
    pub(crate) fn write(self, value: f64, out: &mut Vec<u8>) {
        match self {
            Form::Text(Precision::Double) => {
                write!(out, "{value:?}").expect("memory takes what is written to it");
            }
            Form::Text(Precision::Single) => {
                write!(out, "{:?}", value as f32).expect("memory takes what is written to it");
            }
            Form::Binary(order, Precision::Double) => out.extend_from_slice(&order.bytes(value)),
            Form::Binary(order, Precision::Single) => {
                out.extend_from_slice(&order.single_bytes(value as f32));
            }
        }
    }
}
