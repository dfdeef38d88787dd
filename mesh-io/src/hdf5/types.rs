//! Datatype and dataspace messages: the type of a dataset's items, and the dataset's shape.

use super::bytes::{ByteReader, Hdf5Error};
use crate::binary::byte_order::{ByteOrder, IntegerType};
use crate::precision::Precision;

/// The type of the items of a dataset or attribute.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Datatype {
    /// Text of this many bytes per item.
    Text(usize),
    Whole(IntegerType, ByteOrder),
    /// IEEE floating-point numbers of single or double precision.
    Real(Precision, ByteOrder),
    /// Reference to a text of variable length. The reference itself has this many bytes.
    VariableText(usize),
    /// Any other type, with the item size in bytes.
    Other(usize),
}

impl Datatype {
    /// Returns the size of an item in bytes.
    pub(crate) fn bytes(self) -> usize {
        match self {
            Datatype::Whole(number, _) => number.bytes,
            Datatype::Text(bytes) | Datatype::VariableText(bytes) | Datatype::Other(bytes) => bytes,
            Datatype::Real(precision, _) => precision.bytes(),
        }
    }

    /// Reads a datatype message.
    pub(super) fn read(mut bytes: ByteReader<'_>) -> Result<Datatype, Hdf5Error> {
        let class = bytes.byte()? & 15;
        let bits = bytes.number(3)?;
        let size = bytes.count(4)?;
        let order = if bits & 1 == 0 { ByteOrder::Little } else { ByteOrder::Big };
        Ok(match (class, size) {
            (0, 1 | 2 | 4 | 8) => {
                let (offset, precision) = (bytes.count(2)?, bytes.count(2)?);
                match (offset, precision) == (0, 8 * size) {
                    true => {
                        let number = IntegerType { bytes: size, is_signed: bits & 8 != 0 };
                        Datatype::Whole(number, order)
                    }
                    false => Datatype::Other(size),
                }
            }
            (1, 4 | 8) if bits & 64 == 0 => {
                // Bit offset and precision, location and size of the exponent and of the mantissa, and the exponent
                // bias.
                let own = bytes.take(12)?;
                let single = [0, 0, 32, 0, 23, 8, 0, 23, 127, 0, 0, 0];
                let double = [0, 0, 64, 0, 52, 11, 0, 52, 255, 3, 0, 0];
                match size {
                    4 if own == single => Datatype::Real(Precision::Single, order),
                    8 if own == double => Datatype::Real(Precision::Double, order),
                    _ => Datatype::Other(size),
                }
            }
            (3, 1..) => Datatype::Text(size),
            (9, 1..) if bits & 15 == 1 => Datatype::VariableText(size),
            _ => Datatype::Other(size),
        })
    }
}

/// The dimensions of a dataset or attribute.
#[derive(Clone, Debug, Default)]
pub(super) struct Dataspace {
    /// Number of items in each dimension; empty for a single item.
    pub(super) shape: Vec<u64>,
    /// Largest number of items in each dimension; `u64::MAX` without a limit.
    pub(super) max_shape: Vec<u64>,
    /// Whether the dataspace is null: a dataset without any item.
    pub(super) is_null: bool,
}

impl Dataspace {
    /// Reads a dataspace message.
    pub(super) fn read(mut bytes: ByteReader<'_>) -> Result<Dataspace, Hdf5Error> {
        let widths = bytes.widths();
        let version = bytes.byte()?;
        let rank = usize::from(bytes.byte()?);
        let flags = bytes.byte()?;
        let is_null = match version {
            1 => {
                bytes.skip(5)?;
                false
            }
            2 => bytes.byte()? == 2,
            _ => return Err(bytes.unread(format!("a dataspace of version {version}"))),
        };
        // A null dataspace has no dimensions.
        if rank > 32 || (is_null && rank > 0) {
            return Err(bytes.damaged());
        }
        let lengths = |bytes: &mut ByteReader<'_>| -> Result<Vec<u64>, Hdf5Error> {
            (0..rank).map(|_| Ok(bytes.length()? as u64)).collect()
        };
        let shape = lengths(&mut bytes)?;
        let unlimited = |most: &mut u64| {
            // A dimension without a limit has all bits of its length field set.
            let has_limit = *most != u64::MAX >> (64 - 8 * widths.length.min(8));
            *most = if has_limit { *most } else { u64::MAX };
        };
        let mut most = if flags & 1 == 1 { lengths(&mut bytes)? } else { shape.clone() };
        most.iter_mut().for_each(unlimited);
        Ok(Dataspace { shape, max_shape: most, is_null })
    }

    /// Returns the number of items; `None` if the number exceeds `u64`.
    pub(super) fn count(&self) -> Option<u64> {
        match self.is_null {
            true => Some(0),
            false => self.shape.iter().try_fold(1_u64, |count, &n| count.checked_mul(n)),
        }
    }
}
