//! The errors of options.

use crate::options::feature::Feature;

/// Error of options: numbers outside their ranges, or mutually exclusive features.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum OptionError {
    /// An option has a number outside its range.
    #[error("{option} is {value}: it must be {range}")]
    OutOfRange {
        /// Name of the option.
        option: &'static str,
        /// Value that was given.
        value: f64,
        /// The accepted numbers, in words that follow "it must be".
        range: &'static str,
    },
    /// Two features of the run are mutually exclusive.
    #[error("{} does not go with {}: {why}", features[0], features[1])]
    Conflict {
        /// The two features.
        features: [Feature; 2],
        /// Reason of the conflict, and a remedy other than dropping one of the features.
        why: &'static str,
    },
}
