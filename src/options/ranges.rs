//! The ranges of numbers in the options.

use crate::options::error::OptionError;

/// The range of a numeric option. The command line parses its values by the same ranges.
#[derive(Clone, Copy)]
pub struct OptionRange {
    /// The name of the option.
    pub option: &'static str,
    /// The numbers of the range, in words that follow "it must be".
    pub words: &'static str,
    contains: fn(f64) -> bool,
}

impl OptionRange {
    /// [`Stopping::Tolerance`](crate::Stopping::Tolerance).
    pub const TOLERANCE: Self =
        Self { option: "tolerance", words: "0 or above", contains: |t| t >= 0.0 && t.is_finite() };
    /// [`Goal::fraction`](crate::Goal::fraction).
    pub const FRACTION: Self = Self {
        option: "fraction",
        words: "above 0 and at most 1",
        contains: |share| share > 0.0 && share <= 1.0,
    };
    /// [`Goal::desired`](crate::Goal::desired).
    pub const DESIRED: Self =
        Self { option: "desired", words: "a finite number", contains: f64::is_finite };
    /// [`Relaxed::omega`](crate::options::Relaxed::omega).
    pub const OMEGA: Self = Self {
        option: "omega",
        words: "above 0 and below 2",
        contains: |omega| omega > 0.0 && omega < 2.0,
    };
    /// [`Paper::newton_steps`](crate::options::Paper::newton_steps).
    pub const NEWTON_STEPS: Self = Self {
        option: "newton steps",
        words: "a number from 1 to 1000",
        contains: |steps| (1.0..=1000.0).contains(&steps),
    };
    /// [`Options::max_move`](crate::Options::max_move).
    pub const MAX_MOVE: Self =
        Self { option: "max move", words: "above 0", contains: |m| m > 0.0 && m.is_finite() };
    /// [`PNormExponent::first`](crate::options::PNormExponent::first).
    pub const EXPONENT: Self = Self {
        option: "edge norm",
        words: "from 0 to 13, the log2 of the exponent, and the last not below the first",
        contains: |log2| (0.0..=13.0).contains(&log2),
    };
    /// The number of metrics in [`Options::scheme`](crate::Options::scheme).
    pub const SCHEME_LENGTH: Self = Self {
        option: "scheme length",
        words: "60 metrics at most",
        contains: |length| length <= crate::metric::Scheme::LONGEST as f64,
    };
    /// [`Slide::corner_angle`](crate::Slide::corner_angle).
    pub const CORNER_ANGLE: Self = Self {
        option: "corner angle",
        words: "an angle from 0 to 180 degrees",
        contains: |angle| (0.0..=180.0).contains(&angle),
    };
    /// [`Slide::hausdorff`](crate::Slide::hausdorff).
    pub const HAUSDORFF: Self = Self {
        option: "hausdorff",
        words: "a length above 0",
        contains: |length| length > 0.0 && length.is_finite(),
    };

    /// Whether a number is within the range. NaN is within none.
    pub fn contains(&self, value: f64) -> bool {
        (self.contains)(value)
    }

    /// Checks a number against the range.
    ///
    /// # Errors
    /// [`OptionError::OutOfRange`].
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
