//! The table of options that exclude each other, and the checks of options against the target of a mesh.

use gpu_smooth::options::{Feature, OptionError, Precision};
use gpu_smooth::{Metric, Scheme};

use crate::options::given::GivenOptions;
use crate::options::spelling::Spelling;
use crate::options::table::OPTIONS;
use crate::target::TargetKind;

/// Two options, or values of options, that exclude each other.
struct Conflict {
    options: [&'static str; 2],
    why: &'static str,
}

const fn row(a: &'static str, b: &'static str, why: &'static str) -> Conflict {
    Conflict { options: [a, b], why }
}

const OF_PAPER: &str = "it is a setting of {method=paper}";
const OF_RELAXED: &str = "it is a setting of {method=relaxed}";
const TWO_METHODS: &str = "each selects another method";

/// All pairs, in the order of the search. The library has further pairs, for options of any program.
const CONFLICTS: &[Conflict] = &[
    row("method=multilevel", "derivatives=finite-difference", OF_PAPER),
    row("method=multilevel", "inner", OF_PAPER),
    row("method=relaxed", "derivatives=finite-difference", OF_PAPER),
    row("method=relaxed", "inner", OF_PAPER),
    row("method=multilevel", "omega", OF_RELAXED),
    row("method=paper", "omega", OF_RELAXED),
    row("omega", "derivatives=finite-difference", TWO_METHODS),
    row("omega", "inner", TWO_METHODS),
    row("engine=cpu", "adapter", "it names a GPU"),
];

impl GivenOptions {
    /// Checks for options that need another option, exclude each other, or have no effect. `target` is the kind of the target,
    /// and `more` has the features of the mesh: [`GivenOptions::features`].
    ///
    /// # Errors
    /// A text for the user, in the words of a front end.
    pub fn check(
        &self,
        target: TargetKind,
        more: &[Feature],
        spelling: Spelling,
    ) -> Result<(), String> {
        self.check_rows(spelling)?;
        self.check_effects(target, spelling)?;
        let options = self.settings().run.options(target.default_metric(), Precision::Double);
        options.check_with(more).map_err(|error| self.refusal(&error, spelling))
    }

    fn check_rows(&self, spelling: Spelling) -> Result<(), String> {
        let spelled = |option: &str| spelling.option(option);
        for row in OPTIONS.iter().filter(|row| self.has(row.name)) {
            if !row.needs.is_empty() && !row.needs.iter().any(|other| self.has(other)) {
                let needed: Vec<_> = row.needs.iter().map(|other| spelled(other)).collect();
                let (name, needed) = (spelled(row.name), needed.join(" or "));
                return Err(format!(
                    "{name} has no effect without {needed}: drop it, or add {needed}"
                ));
            }
            if let Some(other) = row.excludes.iter().find(|other| self.has(other)) {
                let (name, other) = (spelled(row.name), spelled(other));
                return Err(format!("{name} does not go with {other}: drop one of them"));
            }
        }
        let meets = |row: &&Conflict| row.options.iter().all(|option| self.has(option));
        match CONFLICTS.iter().find(meets) {
            Some(Conflict { options, why }) => {
                let ([a, b], why) = (options.map(spelled), spelling.text(why));
                Err(format!("{b} does not go with {a}: {why}; drop one of them"))
            }
            None => Ok(()),
        }
    }

    /// Checks for options that have no effect with the target or the scheme.
    fn check_effects(&self, target: TargetKind, spelling: Spelling) -> Result<(), String> {
        let spelled = |option: &str| spelling.option(option);
        let settings = self.settings();
        let scheme = || -> Scheme {
            settings.run.scheme.clone().unwrap_or_else(|| target.default_metric().into())
        };
        if target.is_of_sizes() && !scheme().metrics().iter().any(sees_sizes) {
            let others =
                Metric::ALL.iter().filter(|metric| sees_sizes(metric) && metric.has_barrier());
            let others: Vec<_> = others.map(|metric| metric.name()).collect();
            let target = match target {
                TargetKind::KeepSize => spelled("target=keep-size"),
                _ => spelled("target"),
            };
            let (name, others) = (spelled("scheme"), others.join(" or "));
            let scheme = scheme();
            return Err(format!(
                "{target} has no effect on {scheme}, which sees no sizes: leave {name} out, or take {others}"
            ));
        }
        let idle = [
            (
                "edge-norm",
                !scheme().metrics().contains(&Metric::Edge),
                format!("edge in {}", spelled("scheme")),
            ),
            (
                "target-rings",
                !target.keeps(),
                format!("{} or keep-shape", spelled("target=keep-size")),
            ),
            (
                "target-of",
                target == TargetKind::Equilateral,
                format!("another {}", spelled("target")),
            ),
        ];
        match idle.into_iter().find(|(option, is_idle, _)| *is_idle && self.has(option)) {
            Some((option, _, wanted)) => {
                Err(format!("{} has no effect without {wanted}: drop it", spelled(option)))
            }
            None => Ok(()),
        }
    }

    /// Returns an error of the library in the words of a front end.
    pub fn refusal(&self, error: &OptionError, spelling: Spelling) -> String {
        match error {
            OptionError::OutOfRange { option, value, range } => {
                let name = match *option {
                    "newton steps" => "inner".to_owned(),
                    "scheme length" => "scheme".to_owned(),
                    option => option.replace(' ', "-"),
                };
                format!("{}: the value is {value}, and must be {range}", spelling.option(&name))
            }
            OptionError::Conflict {
                features: features @ [Feature::TargetField, Feature::UnevenScheme],
                ..
            } => {
                let [places, scheme] = features.map(|feature| self.option_of(feature, spelling));
                let [metric, vertex] =
                    ["scheme=tmop-94", "target-of=vertex"].map(|option| spelling.option(option));
                // Targets of sizes refuse imr, which sees no sizes; tmop-94 suits every target.
                format!(
                    "{places} does not go with {scheme}: targets of places need a scheme of one metric other than edge. \
                     Take {metric}, or targets of vertices: {vertex}"
                )
            }
            OptionError::Conflict { features, why } => {
                let [a, b] = features.map(|feature| self.option_of(feature, spelling));
                let remedy = match features.contains(&Feature::TargetField) {
                    true => format!(" ({})", spelling.option("target-of=vertex")),
                    false => String::new(),
                };
                format!("{a} does not go with {b}: {why}{remedy}")
            }
            other => other.to_string(),
        }
    }

    /// Returns the option by which a run has a feature.
    fn option_of(&self, feature: Feature, spelling: Spelling) -> String {
        let option = match feature {
            Feature::UnevenScheme | Feature::UncorrectedScheme => {
                match &self.settings().run.scheme {
                    Some(scheme) => &format!("scheme={scheme}"),
                    None => "scheme",
                }
            }
            Feature::Multilevel => "method=multilevel",
            Feature::FiniteDifferences => "derivatives=finite-difference",
            Feature::Goal if !self.has("desired") => "fraction",
            Feature::Goal => "desired",
            Feature::WorstGuard => "guard=worst",
            Feature::MaxMove => "max-move",
            Feature::KeepAltitude => "keep-altitude",
            Feature::ImproveWorst => "improve-worst",
            Feature::Slide => "slide",
            Feature::Targets if self.has("surface=sphere") => "surface=sphere",
            Feature::Targets => "target",
            Feature::TargetField => "target-of=place",
            Feature::Untangle => "untangle",
            other => return other.to_string(),
        };
        spelling.option(option)
    }
}

fn sees_sizes(metric: &Metric) -> bool {
    !metric.is_scale_invariant()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::row::{Kind, OptionRow};

    /// Returns a valid value of an option.
    fn value(row: &OptionRow) -> &'static str {
        match row.kind {
            Kind::Flag(_) => "true",
            Kind::Word(words, _) | Kind::WordOrFlag(words, _) => words[words.len() - 1],
            Kind::Scheme(_) => "edge",
            Kind::Text(_) => "name",
            _ => "1",
        }
    }

    /// Returns the options with the names, which may have values.
    fn given(options: &[&str]) -> GivenOptions {
        let mut given = GivenOptions::default();
        for option in options {
            let (name, text) = option.split_once('=').unwrap_or((option, ""));
            let row = GivenOptions::row(name).unwrap_or_else(|| panic!("the table has no {name}"));
            given.set(row, if text.is_empty() { value(row) } else { text }).unwrap();
        }
        given
    }

    fn refusal(options: &[&str]) -> Option<String> {
        given(options).check(TargetKind::Equilateral, &[], Spelling::CommandLine).err()
    }

    #[test]
    fn each_pair_is_refused_by_its_own_row() {
        for Conflict { options, why } in CONFLICTS {
            let text = refusal(options).unwrap_or_else(|| panic!("{options:?} is not refused"));
            let [a, b] = options.map(|option| Spelling::CommandLine.option(option));
            assert!(text.starts_with(&format!("{b} does not go with {a}")), "{text}");
            assert!(text.contains(&Spelling::CommandLine.text(why)), "{text}");
        }
    }

    #[test]
    fn each_option_is_accepted_alone_or_with_its_needs() {
        for row in OPTIONS {
            let mut options = vec![row.name];
            match row.name {
                "edge-norm" => options.push("scheme=edge"),
                "target-rings" | "target-of" => continue,
                _ => {}
            }
            if let Some(needed) = row.needs.first() {
                let text = refusal(&options).unwrap();
                assert!(text.contains("has no effect without"), "{text}");
                options.push(needed);
            }
            assert_eq!(refusal(&options), None, "{options:?}");
        }
    }

    #[test]
    fn the_default_in_the_table_is_a_valid_value() {
        for row in OPTIONS.iter().filter(|row| !row.default.is_empty()) {
            assert_eq!(GivenOptions::default().set(row, row.default), Ok(()), "{}", row.name);
        }
    }

    #[test]
    fn options_with_a_value_have_a_placeholder() {
        for row in OPTIONS {
            assert_eq!(
                row.placeholder.is_empty(),
                matches!(row.kind, Kind::Flag(_)),
                "{}",
                row.name
            );
        }
    }

    #[test]
    fn names_in_the_table_are_options_of_the_table() {
        for row in OPTIONS {
            for other in row.needs.iter().chain(row.excludes) {
                assert!(GivenOptions::row(other).is_some(), "{}: {other}", row.name);
            }
        }
    }

    /// Errors would name a feature in the library's terms if `option_of` had no option for the feature.
    #[test]
    fn each_feature_of_a_run_has_an_option_of_the_table() {
        let given = GivenOptions::default();
        for feature in Feature::ALL {
            if matches!(feature, Feature::Encoded | Feature::EncodedCorrections) {
                continue;
            }
            let option = given.option_of(feature, Spelling::Python);
            let name = option.split('=').next().unwrap();
            assert!(name == "target" || GivenOptions::row(name).is_some(), "{option}");
        }
    }

    #[test]
    fn targets_without_effect_are_refused() {
        let check =
            |options: &[&str], kind| given(options).check(kind, &[], Spelling::Python).err();
        let text = check(&["scheme=imr"], TargetKind::KeepSize).unwrap();
        assert!(text.contains("target=\"keep-size\" has no effect on imr"), "{text}");
        assert_eq!(check(&[], TargetKind::KeepSize), None);
        let text = check(&["target-rings"], TargetKind::Sizes).unwrap();
        assert!(text.contains("target_rings has no effect without target=\"keep-size\""), "{text}");
        assert_eq!(check(&["target-rings"], TargetKind::KeepShape), None);
    }

    #[test]
    fn values_out_of_range_are_refused_with_the_range() {
        for (option, wanted) in [
            ("omega=2", "it must be above 0 and below 2"),
            ("omega=x", "not a number; it must be above 0 and below 2"),
            ("inner=0", "it must be a whole number from 1 to 1000"),
            ("guard=none", "it must be by-metric or worst"),
            ("desired=nan", "it must be a finite number, or auto"),
            ("time-limit=-1", "it must be a number of seconds, 0 or above"),
            ("scheme=edge+", "no metric is called"),
        ] {
            let (name, text) = option.split_once('=').unwrap();
            let refused =
                GivenOptions::default().set(GivenOptions::row(name).unwrap(), text).unwrap_err();
            assert!(refused.contains(wanted), "{option}: {refused}");
        }
    }
}
