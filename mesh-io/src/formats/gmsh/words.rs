//! Binary numbers of a file, between its lines of text.

use crate::binary::byte_order::ByteOrder;
use crate::error::ReadError;
use crate::text::cursor::{CUT_OFF, Cursor};
use std::fmt::Display;

/// Remedy for a number outside of its valid range.
const DAMAGED: &str = "The file is damaged: copy it again as binary, or save the mesh again";

/// Position in a section, for messages.
#[derive(Clone, Copy)]
pub(super) struct Progress<'w> {
    /// Number of items read so far.
    pub(super) done: u64,
    /// Number of items in the section.
    pub(super) count: u64,
    /// Name of the items in the plural, such as `nodes`.
    pub(super) what: &'w str,
}

impl<'w> Progress<'w> {
    pub(super) fn new(done: u64, count: u64, what: &'w str) -> Progress<'w> {
        Progress { done, count, what }
    }
}

/// Bytes of a binary file with numbers, read from front to back. Reading beyond the last byte panics.
pub(super) struct Words<'a> {
    order: ByteOrder,
    bytes: &'a [u8],
}

impl<'a> Words<'a> {
    /// Takes the next `size` bytes of the file, which contain the next item.
    ///
    /// # Errors
    /// If the file ends first.
    #[inline]
    pub(super) fn take(
        cursor: &mut Cursor<'a>,
        order: ByteOrder,
        size: usize,
        progress: Progress<'_>,
    ) -> Result<Words<'a>, ReadError> {
        match cursor.take(size) {
            Some(bytes) => Ok(Words { order, bytes }),
            None => {
                let Progress { done, count, what } = progress;
                let problem = format!("the file ends after {done} of {count} {what}");
                Err(cursor.error(problem, CUT_OFF))
            }
        }
    }

    /// Returns the next `N` bytes. The caller must have taken as many bytes as it reads.
    #[inline]
    fn next<const N: usize>(&mut self) -> [u8; N] {
        let (next, rest) = self.bytes.split_first_chunk().expect("as many words as were taken");
        self.bytes = rest;
        *next
    }

    /// Returns the bytes that are still unread.
    pub(super) fn left(&self) -> &'a [u8] {
        self.bytes
    }

    pub(super) fn skip(&mut self, size: usize) {
        self.bytes = &self.bytes[size..];
    }

    /// Reads gmsh's `int`.
    #[inline]
    pub(super) fn int(&mut self) -> i32 {
        self.order.i32(self.next())
    }

    /// Reads an `int`, called `what` in messages. A negative one is an error.
    #[inline]
    pub(super) fn natural(
        &mut self,
        cursor: &Cursor<'_>,
        what: impl Display,
    ) -> Result<u64, ReadError> {
        let number = self.int();
        u64::try_from(number).map_err(|_| {
            cursor.error(format!("{what} is {number}, not a whole number from 0"), DAMAGED)
        })
    }

    /// Reads gmsh's `size_t`.
    #[inline]
    pub(super) fn size(&mut self) -> u64 {
        self.order.u64(self.next())
    }

    /// Reads a number of double precision.
    pub(super) fn double(&mut self) -> f64 {
        self.order.f64(self.next())
    }

    /// Reads the coordinates of a node. x and y must be finite, z need not be.
    #[inline]
    pub(super) fn point(&mut self, cursor: &Cursor<'_>, tag: u64) -> Result<[f64; 3], ReadError> {
        let point: [f64; 3] = std::array::from_fn(|_| self.order.f64(self.next()));
        for (axis, x) in "xy".chars().zip(point) {
            if !x.is_finite() {
                let problem = format!("{axis} of node {tag} is {x}, not a finite number");
                return Err(cursor.error(problem, DAMAGED));
            }
        }
        Ok(point)
    }
}

/// Reads gmsh's byte-order mark, the `int` 1, and returns the byte order.
pub(super) fn byte_order(cursor: &mut Cursor<'_>) -> Result<ByteOrder, ReadError> {
    match cursor.take(4) {
        Some([1, 0, 0, 0]) => Ok(ByteOrder::Little),
        Some([0, 0, 0, 1]) => Ok(ByteOrder::Big),
        Some(_) => {
            let problem = "the byte-order mark is not the number 1 in either byte order";
            Err(cursor.error(problem, DAMAGED))
        }
        None => Err(cursor.error("the file ends before its byte-order mark", CUT_OFF)),
    }
}
