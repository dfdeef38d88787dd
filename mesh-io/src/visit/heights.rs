//! Third coordinates and depths, which are data of points.

use crate::binary::number_field::Field;
use crate::edit::numbers::{Form, Places};
use crate::error::ReadError;
use crate::precision::Precision;
use crate::text::cursor::Cursor;
use crate::text::cursor_numbers::NO_HEIGHT;
use crate::visit::items::PointNumbers;
use crate::visit::records::LONG;
use crate::visit::sink::Sink;
use crate::visit::storage::{Home, Stored};

/// Collects the third coordinates of points as they are read: whether they differ, and all numbers if the sink asks for
/// data.
pub(crate) struct Heights {
    first: Option<f64>,
    differ: bool,
    collected: Option<(Vec<usize>, Vec<f64>)>,
    /// Whether some points have no third coordinate.
    is_partial: bool,
}

impl Heights {
    pub(crate) fn new(sink: &dyn Sink) -> Heights {
        let collected = sink.asks_for_data().then(Default::default);
        Heights { first: None, differ: false, collected, is_partial: false }
    }

    /// Takes the third coordinate of the next point, with its offset in the file.
    #[inline]
    pub(crate) fn see(&mut self, (at, z): (usize, f64)) {
        self.is_partial |= at == NO_HEIGHT.0;
        match self.first {
            None => self.first = Some(z),
            Some(first) => self.differ |= z != first,
        }
        if let Some((places, numbers)) = &mut self.collected {
            places.push(at);
            numbers.push(z);
        }
    }

    /// Takes the third coordinates of all records of a binary list. `at` is the offset of the first.
    pub(crate) fn see_all(&mut self, z: Field<'_>, count: usize, at: usize) {
        if self.collected.is_some() || count < LONG {
            z.real(0..count).enumerate().for_each(|(index, z_of)| {
                self.see((at + index * z.stride(), z_of));
            });
        } else if let Some(own) = z.real(0..1).next() {
            let first = *self.first.get_or_insert(own);
            self.differ |= !z.all_real(count, |z| z == first);
        }
    }

    /// Hands the numbers to the sink under this name, if they differ or if the sink asks for data.
    pub(crate) fn send(self, name: &str, form: Form, sink: &mut dyn Sink) {
        self.send_from(name, form, Home::File, 0, sink);
    }

    /// The same, if they stand elsewhere than in the file itself, or in this one of the files of the mesh.
    pub(crate) fn send_from(
        self,
        name: &str,
        form: Form,
        home: Home,
        part: usize,
        sink: &mut dyn Sink,
    ) {
        let is_any = self.collected.is_some() && self.first.is_some() && !self.is_partial;
        let is_told = self.differ || is_any;
        if is_told
            && sink.height_array(name.as_bytes())
            && let Some((places, mut numbers)) = self.collected
        {
            let precision = form.precision();
            numbers.iter_mut().for_each(|z| *z = precision.rounded(*z));
            // There is no place for those that a file does not have.
            let stored = (!self.is_partial).then_some(Stored {
                places: Places::List(places),
                form,
                home,
                part,
            });
            sink.point_numbers(PointNumbers { numbers, nodes: None, stored });
        }
    }
}

/// Collects numbers of a text with their offsets.
#[derive(Default)]
pub(crate) struct TextNumbers {
    places: Vec<usize>,
    numbers: Vec<f64>,
}

impl TextNumbers {
    /// Reads the next token of the row as a number.
    pub(crate) fn read(&mut self, cursor: &mut Cursor<'_>) -> Result<(), ReadError> {
        let at = cursor.at();
        let number = cursor.real("a number of a point")?;
        self.places.push(at);
        self.numbers.push(number);
        Ok(())
    }

    /// Reads one number of each of `count` rows, after skipping `before` tokens.
    pub(crate) fn column(
        &mut self,
        mut cursor: Cursor<'_>,
        count: u64,
        before: u64,
    ) -> Result<(), ReadError> {
        for done in 0..count {
            cursor.row(done, count, "points")?;
            cursor.tokens(before);
            self.read(&mut cursor)?;
        }
        Ok(())
    }

    /// Returns all numbers. `nodes` are the nodes they belong to; `None` if they belong to all nodes in order.
    pub(crate) fn finish(self, precision: Precision, nodes: Option<Vec<u64>>) -> PointNumbers {
        let Self { places, mut numbers } = self;
        numbers.iter_mut().for_each(|number| *number = precision.rounded(*number));
        let stored = Stored::in_place(Places::List(places), Form::Text(precision));
        PointNumbers { numbers, nodes, stored }
    }
}
