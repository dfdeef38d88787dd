//! Ranges of bad values of a quantity.

use std::fmt;
use std::str::FromStr;

use gpu_smooth::measure::Better;

use crate::limits::quantity::Quantity;

/// A range of bad values of a quantity, as in `min-angle<20`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Threshold {
    pub(crate) quantity: Quantity,
    /// Whether values below `value` are in the range, and not values above.
    pub(crate) is_below: bool,
    or_equal: bool,
    value: f64,
}

impl Threshold {
    /// Parses the range of a quantity: `<`, `<=`, `>` or `>=`, and a number.
    ///
    /// # Errors
    /// A text for the user if the range has another form, or if its values are good ones.
    pub(crate) fn of(quantity: Quantity, range: &str) -> Result<Self, String> {
        let form = "it must be a measure, < or >, and a number, as in min-angle<20";
        let range = range.trim();
        let is_below = range.starts_with('<');
        let rest = range.strip_prefix(['<', '>']).ok_or(form)?;
        let number = rest.trim_start_matches('=');
        let or_equal = match rest.len() - number.len() {
            0 => false,
            1 => true,
            _ => return Err(form.into()),
        };
        let number = number.trim();
        let not_a_number = || format!("'{number}' is not a number");
        let value: f64 = number.parse().map_err(|_| not_a_number())?;
        if value.is_nan() {
            return Err(not_a_number());
        }
        let threshold = Self { quantity, is_below, or_equal, value };
        let (is_bad_below, bad) = match quantity.better() {
            Some(Better::Higher) => (true, "low"),
            Some(Better::Lower) => (false, "high"),
            None => return Ok(threshold),
        };
        if is_below != is_bad_below {
            // Most likely the user wrote the values that all parts of the mesh should have.
            let meant = Self { is_below: is_bad_below, ..threshold };
            let part = quantity.part().noun(true);
            return Err(format!(
                "a threshold names the values that no {part} may have, and {bad} values of {quantity} are bad: write '{meant}'"
            ));
        }
        Ok(threshold)
    }

    /// Returns an empty range of a quantity.
    pub(crate) fn none(quantity: Quantity) -> Self {
        let is_below = quantity.better() != Some(Better::Lower);
        Self { quantity, is_below, or_equal: false, value: f64::NAN }
    }

    /// Returns whether a value of the quantity is in the range.
    pub(crate) fn is_met(&self, value: f64) -> bool {
        self.is_worse(value, self.value) || self.or_equal && value == self.value
    }

    /// Returns whether the value `a` is worse than `b`.
    pub(crate) fn is_worse(&self, a: f64, b: f64) -> bool {
        if self.is_below { a < b } else { a > b }
    }

    /// Returns whether all values of another range of the quantity, with the direction of this one, are in this range.
    pub(crate) fn contains(&self, other: &Self) -> bool {
        self.is_worse(other.value, self.value)
            || other.value == self.value && (self.or_equal || !other.or_equal)
    }

    /// Returns the range without the name of the quantity, as in `< 20`.
    pub(crate) fn range(&self) -> String {
        format!("{} {}", self.sign(), self.value)
    }

    fn sign(&self) -> &'static str {
        match (self.is_below, self.or_equal) {
            (true, false) => "<",
            (true, true) => "<=",
            (false, false) => ">",
            (false, true) => ">=",
        }
    }
}

impl fmt::Display for Threshold {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}{}", self.quantity, self.sign(), self.value)
    }
}

impl FromStr for Threshold {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let at = text
            .find(['<', '>'])
            .ok_or("it must be a measure, < or >, and a number, as in min-angle<20")?;
        let (name, range) = text.split_at(at);
        Self::of(name.parse()?, range)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limits::Part;

    #[test]
    fn a_threshold_has_the_part_and_the_range_that_its_text_names() {
        let parse = |text: &str| text.parse::<Threshold>().unwrap();
        for (text, part, own) in [
            ("min-angle<20", Part::Triangle, "min-angle<20"),
            ("Flow_Link <= .1", Part::Edge, "flow-link<=0.1"),
            ("smoothness>3", Part::Edge, "smoothness>3"),
            ("neighbors>10", Part::Vertex, "neighbors>10"),
            ("neighbors<4", Part::Vertex, "neighbors<4"),
            ("boundary-corners>=3", Part::Triangle, "boundary-corners>=3"),
            ("hole-edges<7", Part::Hole, "hole-edges<7"),
            ("time_step < .5", Part::Triangle, "time-step<0.5"),
        ] {
            let threshold = parse(text);
            assert_eq!((threshold.quantity.part(), &*threshold.to_string()), (part, own));
        }
        let few = parse("neighbors<=4");
        assert_eq!([3.0, 4.0, 5.0].map(|count| few.is_met(count)), [true, true, false]);
        let wide = parse("orthogonality>0.5");
        assert_eq!([0.4, 0.5, 0.6].map(|cosine| wide.is_met(cosine)), [false, false, true]);
    }

    #[test]
    fn good_values_are_refused_with_the_bad_ones_as_remedy() {
        let error = |text: &str| text.parse::<Threshold>().unwrap_err();
        assert!(error("orthogonality<0.02").contains("no edge may have, and high values"));
        assert!(error("orthogonality<0.02").ends_with("write 'orthogonality>0.02'"));
        assert!(error("boundary-corners<3").ends_with("write 'boundary-corners>3'"));
        assert!(error("roundness<1").ends_with(", hole-edges, neighbors, time-step"));
    }
}
