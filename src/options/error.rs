//! The errors of options.

use crate::options::feature::Feature;

/// A number out of the range of an option, or two features that do not go together.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum OptionError {
    /// A number is out of its range.
    #[error("{option} is {value}: it must be {range}")]
    OutOfRange {
        /// The name of the option.
        option: &'static str,
        /// The value of the option.
        value: f64,
        /// The numbers that the option takes, in words.
        range: &'static str,
    },
    /// Two features do not go together in one run.
    #[error("{} does not go with {}: {why}", features[0], features[1])]
    Conflict {
        /// The two features.
        features: [Feature; 2],
        /// The reason, and a remedy other than dropping one of the features.
        why: &'static str,
    },
}
