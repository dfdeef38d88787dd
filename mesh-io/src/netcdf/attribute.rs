//! Attributes of variables.

use super::types::NumberType;
use crate::binary::byte_order::ByteOrder;

/// An attribute of a variable: its name, its type, and its value as undecoded bytes.
pub(super) struct Attribute {
    pub(super) name: Vec<u8>,
    pub(super) number: NumberType,
    pub(super) order: ByteOrder,
    pub(super) bytes: Vec<u8>,
}

impl Attribute {
    /// Returns the text up to its first zero byte, without blanks around; `None` if the attribute is not text.
    pub(super) fn text(&self) -> Option<&[u8]> {
        let is_text = self.number == NumberType::Text;
        let text = self.bytes.split(|&byte| byte == 0).next().unwrap_or_default();
        is_text.then(|| text.trim_ascii())
    }

    /// Returns the first number; `None` if the attribute is empty, text, or of an unknown type.
    pub(super) fn real(&self) -> Option<f64> {
        let first = self.bytes.get(..self.number.bytes())?;
        match self.number {
            NumberType::Whole(number) => Some(self.order.integer_as_real(number, first)),
            NumberType::Real(precision) => Some(self.order.real(precision, first)),
            NumberType::Text | NumberType::Other(_) => None,
        }
    }

    /// Returns the first number as an integer; `None` for text, and for real numbers with a fraction or from 1e15 on.
    pub(super) fn whole(&self) -> Option<i64> {
        match self.number {
            NumberType::Whole(number) => {
                Some(self.order.integer(number, self.bytes.get(..number.bytes)?))
            }
            _ => self.real().filter(|x| x.fract() == 0.0 && x.abs() < 1e15).map(|x| x as i64),
        }
    }
}
