//! The features of a run for which the table of conflicts has rules.

use std::fmt;

/// A feature of a run. Some pairs of features are mutually exclusive; see
/// [`Options::check_with`](crate::Options::check_with). Displayed as the library's name of the feature.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Feature {
    /// A scheme of several metrics, or of edge, in which some sweeps may raise f.
    UnevenScheme,
    /// A base metric whose sweeps cannot be corrected from coarser levels.
    UncorrectedScheme,
    /// [`Method::Multilevel`](crate::Method::Multilevel).
    Multilevel,
    /// [`Derivatives::FiniteDifference`](crate::options::Derivatives::FiniteDifference).
    FiniteDifferences,
    /// [`Stopping::Goal`](crate::Stopping::Goal).
    Goal,
    /// [`Guard::Worst`](crate::Guard::Worst).
    WorstGuard,
    /// [`Options::max_move`](crate::Options::max_move).
    MaxMove,
    /// [`Options::keep_altitude`](crate::Options::keep_altitude).
    KeepAltitude,
    /// [`Options::improve_worst`](crate::Options::improve_worst).
    ImproveWorst,
    /// Vertices that slide along curves; see [`Smoother::set_slide`](crate::Smoother::set_slide).
    Slide,
    /// Targets of vertices or of places; see [`Smoother::set_targets`](crate::Smoother::set_targets).
    Targets,
    /// Targets of places; see [`Smoother::set_target_field`](crate::Smoother::set_target_field).
    TargetField,
    /// [`Untangle`](crate::Untangle) before the run.
    Untangle,
    /// Sweeps that an application encodes, in place of a run.
    Encoded,
    /// Sweeps that an application encodes with [`Method::Multilevel`](crate::Method::Multilevel).
    EncodedCorrections,
}

impl Feature {
    /// Returns the features whose condition is true, in the given order.
    pub fn present(conditions: impl IntoIterator<Item = (Self, bool)>) -> Vec<Self> {
        let is_present = |(feature, holds): (Self, bool)| holds.then_some(feature);
        conditions.into_iter().filter_map(is_present).collect()
    }

    /// Every feature, in the order of the variants.
    pub const ALL: [Self; 15] = [
        Self::UnevenScheme,
        Self::UncorrectedScheme,
        Self::Multilevel,
        Self::FiniteDifferences,
        Self::Goal,
        Self::WorstGuard,
        Self::MaxMove,
        Self::KeepAltitude,
        Self::ImproveWorst,
        Self::Slide,
        Self::Targets,
        Self::TargetField,
        Self::Untangle,
        Self::Encoded,
        Self::EncodedCorrections,
    ];
}

impl fmt::Display for Feature {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::UnevenScheme => "a scheme of several metrics, or of edge",
            Self::UncorrectedScheme => "a base metric without corrections",
            Self::Multilevel => "Method::Multilevel",
            Self::FiniteDifferences => "Derivatives::FiniteDifference",
            Self::Goal => "Stopping::Goal",
            Self::WorstGuard => "Guard::Worst",
            Self::MaxMove => "max_move",
            Self::KeepAltitude => "keep_altitude",
            Self::ImproveWorst => "improve_worst",
            Self::Slide => "a Slide",
            Self::Targets => "Targets",
            Self::TargetField => "a TargetField",
            Self::Untangle => "untangling",
            Self::Encoded => "encoding sweeps",
            Self::EncodedCorrections => "encoding corrected sweeps",
        })
    }
}
