//! Third coordinates and depths, which count as point data.

use crate::binary::number_field::NumberField;
use crate::edit::numbers::{NumberEncoding, Offsets};
use crate::error::ReadError;
use crate::precision::Precision;
use crate::text::cursor::Cursor;
use crate::text::cursor_numbers::NO_Z;
use crate::visit::items::PointNumbers;
use crate::visit::records::MIN_PARALLEL_RECORDS;
use crate::visit::storage::{ArrayLocation, ByteSpace};
use crate::visit::visitor::MeshVisitor;

/// Collector of third coordinates: detects whether the coordinates differ, and stores offsets and values if the visitor
/// asks for data.
pub(crate) struct ZValues {
    first: Option<f64>,
    differ: bool,
    collected: Option<(Vec<usize>, Vec<f64>)>,
    /// Whether some points have no third coordinate.
    is_partial: bool,
    /// The node id of each point; `None` if point `i` is node `i`.
    nodes: Option<Vec<u64>>,
}

impl ZValues {
    pub(crate) fn new(visitor: &dyn MeshVisitor) -> ZValues {
        let collected = visitor.asks_for_data().then(Default::default);
        ZValues { first: None, differ: false, collected, is_partial: false, nodes: None }
    }

    /// Adds the third coordinate of the next point, with its byte offset; [`NO_Z`] for a point without z.
    #[inline]
    pub(crate) fn push(&mut self, (at, z): (usize, f64)) {
        self.is_partial |= at == NO_Z.0;
        match self.first {
            None => self.first = Some(z),
            Some(first) => self.differ |= z != first,
        }
        if let Some((offsets, numbers)) = &mut self.collected {
            offsets.push(at);
            numbers.push(z);
        }
    }

    /// Adds the third coordinates of `count` records of a binary list. `at` is the byte offset of the first coordinate.
    pub(crate) fn push_records(&mut self, z: NumberField<'_>, count: usize, at: usize) {
        if self.collected.is_some() || count < MIN_PARALLEL_RECORDS {
            z.real(0..count).enumerate().for_each(|(index, z_of)| {
                self.push((at + index * z.stride(), z_of));
            });
        } else if let Some(own) = z.real(0..1).next() {
            let first = *self.first.get_or_insert(own);
            self.differ |= !z.all_real(count, |z| z == first);
        }
    }

    /// Sets the node id of each point, for files that repeat nodes. `nodes` is called if points are collected.
    pub(crate) fn of_nodes(self, nodes: impl FnOnce() -> Vec<u64>) -> ZValues {
        let nodes = self.collected.is_some().then(nodes);
        ZValues { nodes, ..self }
    }

    /// Announces third coordinates of the main file as an array `name`, and passes the numbers if the visitor wants
    /// them. Equal coordinates are announced only to visitors that ask for data.
    pub(crate) fn send(self, name: &str, encoding: NumberEncoding, visitor: &mut dyn MeshVisitor) {
        self.send_from(name, encoding, ByteSpace::File, 0, visitor);
    }

    /// Announces third coordinates as [`send`](Self::send) does, for numbers in the byte space `home` of the file with
    /// index `file_index`.
    pub(crate) fn send_from(
        self,
        name: &str,
        encoding: NumberEncoding,
        home: ByteSpace,
        file_index: usize,
        visitor: &mut dyn MeshVisitor,
    ) {
        let is_any = self.collected.is_some() && self.first.is_some() && !self.is_partial;
        let is_told = self.differ || is_any;
        if is_told
            && visitor.z_array(name.as_bytes())
            && let Some((offsets, mut numbers)) = self.collected
        {
            let precision = encoding.precision();
            numbers.iter_mut().for_each(|z| *z = precision.rounded(*z));
            // If some points lack z, the file has no bytes for their new values, and no number can be replaced.
            let stored = (!self.is_partial).then_some(ArrayLocation {
                offsets: Offsets::List(offsets),
                encoding,
                space: home,
                file_index,
                shared: None,
            });
            visitor.point_numbers(PointNumbers { numbers, nodes: self.nodes, location: stored });
        }
    }
}

/// Collector of the numbers of a text file, with their offsets.
#[derive(Default)]
pub(crate) struct TextNumbers {
    offsets: Vec<usize>,
    numbers: Vec<f64>,
}

impl TextNumbers {
    /// Reads the next token of the row as a number.
    pub(crate) fn read(&mut self, cursor: &mut Cursor<'_>) -> Result<(), ReadError> {
        let at = cursor.at();
        let number = cursor.real("a number of a point")?;
        self.offsets.push(at);
        self.numbers.push(number);
        Ok(())
    }

    /// Reads one number from each of `count` rows, after skipping `before` tokens of the row.
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

    /// Returns all numbers, rounded to `precision`. `nodes` holds the node id of each tuple; `None` if tuple `i`
    /// belongs to node `i`.
    pub(crate) fn finish(self, precision: Precision, nodes: Option<Vec<u64>>) -> PointNumbers {
        let Self { offsets, mut numbers } = self;
        numbers.iter_mut().for_each(|number| *number = precision.rounded(*number));
        let stored =
            ArrayLocation::in_place(Offsets::List(offsets), NumberEncoding::Text(precision));
        PointNumbers { numbers, nodes, location: stored }
    }
}
