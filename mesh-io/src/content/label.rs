//! The label of a group: a number or a name.

/// The number or name of a group, which tells it from others of the same kind.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Label {
    Tag(i64),
    Name(String),
}

impl Label {
    /// Makes a label from a name in a file, which may be in any encoding.
    pub(crate) fn name(name: &[u8]) -> Label {
        Label::Name(String::from_utf8_lossy(name).into_owned())
    }

    /// Makes a label from a number: a tag if it is whole, else a name.
    pub(crate) fn number(number: f64) -> Label {
        // A double represents every whole number up to this one.
        const LIMIT: f64 = 9_007_199_254_740_992.0;
        match number.fract() == 0.0 && number.abs() <= LIMIT {
            true => Label::Tag(number as i64),
            false => Label::Name(format!("{number:?}")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_numbers_are_tags() {
        for (number, label) in [(3.0, Label::Tag(3)), (-0.0, Label::Tag(0)), (-7.0, Label::Tag(-7))]
        {
            assert_eq!(Label::number(number), label);
        }
        for (number, name) in [(1.5, "1.5"), (f64::NAN, "NaN"), (1e300, "1e300")] {
            assert_eq!(Label::number(number), Label::Name(name.into()));
        }
    }
}
