//! The table of mutually exclusive features.

use crate::options::error::OptionError;
use crate::options::feature::Feature;

/// Two features that exclude each other in one run.
pub(crate) struct Conflict {
    pub(crate) features: [Feature; 2],
    why: &'static str,
}

const fn row(a: Feature, b: Feature, why: &'static str) -> Conflict {
    Conflict { features: [a, b], why }
}

// Targets of sizes refuse imr, which sees no sizes. tmop-94 suits every target.
const ONE_METRIC: &str = "each of its periods must lower f, as sweeps by one metric other than edge do; take one metric, \
     such as tmop-94, or targets of vertices";
const ANALYTIC: &str = "it needs analytic derivatives";
const CHANGING: &str =
    "targets of places change during the run; drop one of the two, or take targets of vertices";
const WHOLE_RUN: &str = "only a whole run can do this; drop it, or do a whole run";
const TANGLED: [&str; 2] = [
    "inverted triangles have no least altitude; untangle the mesh in a separate run",
    "untangling moves vertices as far as it must; untangle the mesh in a separate run",
];

/// All conflicts. A run with several conflicts reports the first matching row.
pub(crate) const CONFLICTS: &[Conflict] = &[
    row(Feature::TargetField, Feature::Slide, CHANGING),
    row(Feature::TargetField, Feature::MaxMove, CHANGING),
    row(Feature::TargetField, Feature::KeepAltitude, CHANGING),
    row(Feature::TargetField, Feature::Goal, CHANGING),
    row(Feature::TargetField, Feature::UnevenScheme, ONE_METRIC),
    row(Feature::KeepAltitude, Feature::Untangle, TANGLED[0]),
    row(Feature::MaxMove, Feature::Untangle, TANGLED[1]),
    row(Feature::Slide, Feature::FiniteDifferences, ANALYTIC),
    row(Feature::Targets, Feature::FiniteDifferences, ANALYTIC),
    row(
        Feature::Multilevel,
        Feature::UncorrectedScheme,
        "sweeps by this metric cannot be corrected from coarser levels; take another metric, such as imr for shapes or \
         soft-size for sizes",
    ),
    row(
        Feature::EncodedCorrections,
        Feature::UnevenScheme,
        "corrections cannot follow these sweeps; take Method::Auto, one metric other than edge, or a whole run",
    ),
    row(Feature::Encoded, Feature::WorstGuard, WHOLE_RUN),
    row(Feature::Encoded, Feature::MaxMove, WHOLE_RUN),
    row(Feature::Encoded, Feature::KeepAltitude, WHOLE_RUN),
    row(Feature::Encoded, Feature::ImproveWorst, WHOLE_RUN),
    row(Feature::Encoded, Feature::Goal, WHOLE_RUN),
];

/// Returns the error of the first row of the table whose two features are both in `features`.
pub(super) fn check(features: &[Feature]) -> Result<(), OptionError> {
    let meets = |row: &&Conflict| row.features.iter().all(|feature| features.contains(feature));
    match CONFLICTS.iter().find(meets) {
        Some(&Conflict { features, why }) => Err(OptionError::Conflict { features, why }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_row_repeats_or_hides_another() {
        for (i, row) in CONFLICTS.iter().enumerate() {
            assert_ne!(row.features[0], row.features[1]);
            let error = check(&row.features).unwrap_err();
            let OptionError::Conflict { features, .. } = error else { panic!("{error}") };
            assert_eq!(features, row.features, "row {i} is hidden by another row");
        }
    }

    #[test]
    fn the_documentation_of_encoded_sweeps_names_every_option_that_they_refuse() {
        let text = include_str!("../gpu/embed/sweeps.rs");
        let comment =
            text.split("impl Sweeps {").nth(1).unwrap().split("pub fn new(").next().unwrap();
        for row in CONFLICTS.iter().filter(|row| row.features[0] == Feature::Encoded) {
            let option = row.features[1];
            assert!(comment.contains(&format!("{option}`]")), "Sweeps::new refuses {option}");
        }
    }

    #[test]
    fn every_feature_but_those_that_go_with_all_is_in_a_row() {
        for feature in Feature::ALL {
            let is_listed = CONFLICTS.iter().any(|row| row.features.contains(&feature));
            assert!(is_listed, "{feature} is in no row: drop the feature");
        }
    }
}
