//! The label of a group: a number or a name.

use crate::content::decoded::decoded;

/// Number or name that identifies a group among groups of equal kind and dimension.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) enum GroupLabel {
    Tag(i64),
    Name(String),
}

impl GroupLabel {
    /// Makes a label from the bytes of a name: UTF-8, or else Windows-1252.
    pub(crate) fn name(name: &[u8]) -> GroupLabel {
        GroupLabel::Name(decoded(name))
    }

    /// Makes a label from a real number. Whole numbers up to 2^53 in size become tags, other numbers become names in
    /// decimal text.
    pub(crate) fn number(number: f64) -> GroupLabel {
        // 2^53: doubles represent every whole number up to this size.
        const LIMIT: f64 = 9_007_199_254_740_992.0;
        match number.fract() == 0.0 && number.abs() <= LIMIT {
            true => GroupLabel::Tag(number as i64),
            false => GroupLabel::Name(format!("{number:?}")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_numbers_are_tags() {
        for (number, label) in
            [(3.0, GroupLabel::Tag(3)), (-0.0, GroupLabel::Tag(0)), (-7.0, GroupLabel::Tag(-7))]
        {
            assert_eq!(GroupLabel::number(number), label);
        }
        for (number, name) in [(1.5, "1.5"), (f64::NAN, "NaN"), (1e300, "1e300")] {
            assert_eq!(GroupLabel::number(number), GroupLabel::Name(name.into()));
        }
    }
}
