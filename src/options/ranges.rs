//! Ranges of the numbers in the options.

use crate::metric::Scheme;
use crate::options::error::OptionError;
use crate::options::method::Paper;
use crate::options::norm::PNormExponent;

/// Range of a numeric option. The command line parses its values by the same ranges.
#[derive(Clone, Copy)]
pub struct OptionRange {
    /// Name of the option.
    pub option: &'static str,
    /// The accepted numbers, in words that follow "it must be".
    pub words: &'static str,
    contains: fn(f64) -> bool,
}

impl OptionRange {
    /// [`Stopping::Tolerance`](crate::Stopping::Tolerance).
    pub const TOLERANCE: Self =
        Self::new("tolerance", "a finite number, 0 or above", |t| t >= 0.0 && t.is_finite());
    /// [`Goal::fraction`](crate::Goal::fraction).
    pub const FRACTION: Self =
        Self::new("fraction", "above 0 and at most 1", |share| share > 0.0 && share <= 1.0);
    /// [`Goal::desired`](crate::Goal::desired).
    pub const DESIRED: Self = Self::new("desired", "a finite number", f64::is_finite);
    /// [`Relaxed::omega`](crate::options::Relaxed::omega).
    pub const OMEGA: Self = Self::new("omega", "above 0 and below 2", |w| w > 0.0 && w < 2.0);
    /// [`Paper::newton_steps`](crate::options::Paper::newton_steps).
    pub const NEWTON_STEPS: Self = Self::new("newton steps", "a number from 1 to 1000", |steps| {
        (1.0..=f64::from(Paper::MAX_NEWTON_STEPS)).contains(&steps)
    });
    /// [`Options::max_move`](crate::Options::max_move).
    pub const MAX_MOVE: Self = Self::new("max move", "a finite number above 0", is_positive);
    /// [`PNormExponent::first`](crate::options::PNormExponent::first).
    pub const EXPONENT: Self = Self::new(
        "edge norm",
        "from 0 to 13, the log2 of the exponent, and no decrease from first to last",
        |log2| (0.0..=f64::from(PNormExponent::MAX)).contains(&log2),
    );
    /// Number of metrics in [`Options::scheme`](crate::Options::scheme).
    pub const SCHEME_LENGTH: Self =
        Self::new("scheme length", "60 metrics at most", |n| n <= f64::from(Scheme::LONGEST));
    /// [`Slide::corner_angle`](crate::Slide::corner_angle).
    pub const CORNER_ANGLE: Self =
        Self::new("corner angle", "an angle from 0 to 180 degrees", |angle| {
            (0.0..=180.0).contains(&angle)
        });
    /// Inverse mean ratio of a triangle.
    pub const RATIO: Self =
        Self::new("ratio", "a number of at least 1", |ratio| ratio >= 1.0 && ratio.is_finite());
    /// [`Slide::hausdorff`](crate::Slide::hausdorff).
    pub const HAUSDORFF: Self = Self::new("hausdorff", "a finite length above 0", is_positive);

    const fn new(option: &'static str, words: &'static str, contains: fn(f64) -> bool) -> Self {
        Self { option, words, contains }
    }

    /// Returns whether a number is within the range. NaN is in no range.
    pub fn contains(&self, value: f64) -> bool {
        (self.contains)(value)
    }

    /// Checks a number against the range.
    ///
    /// # Errors
    /// [`OptionError::OutOfRange`] if `value` is not within the range.
    pub fn check(&self, value: f64) -> Result<(), OptionError> {
        match self.contains(value) {
            true => Ok(()),
            false => Err(self.refuse(value)),
        }
    }

    pub(super) fn refuse(&self, value: f64) -> OptionError {
        let Self { option, words, .. } = *self;
        OptionError::OutOfRange { option, value, range: words }
    }
}

fn is_positive(number: f64) -> bool {
    number > 0.0 && number.is_finite()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The words are typed by hand and must agree with the constants.
    #[test]
    fn the_words_of_a_range_have_its_limits() {
        for (range, limit) in [
            (OptionRange::NEWTON_STEPS, Paper::MAX_NEWTON_STEPS),
            (OptionRange::EXPONENT, PNormExponent::MAX),
            (OptionRange::SCHEME_LENGTH, Scheme::LONGEST),
        ] {
            let limit = limit.to_string();
            assert!(range.words.split([' ', ',']).any(|word| word == limit), "{}", range.words);
        }
    }
}
