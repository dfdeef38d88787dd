//! The label of a group: a number or a name.

/// Number or name of a group, unique among groups of one kind.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) enum GroupLabel {
    Tag(i64),
    Name(String),
}

impl GroupLabel {
    /// Makes a label from a name in a file, which may be in any encoding.
    pub(crate) fn name(name: &[u8]) -> GroupLabel {
        GroupLabel::Name(String::from_utf8_lossy(name).into_owned())
    }

    /// Makes a label from a number: a tag if it is whole, else a name.
    pub(crate) fn number(number: f64) -> GroupLabel {
        // A double represents every whole number up to this one.
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
