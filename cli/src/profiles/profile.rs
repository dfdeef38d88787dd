//! The limits of a solver or of its users, as a TOML file lists them.

use gpu_smooth::Metric;
use serde::de::Error;
use serde::{Deserialize, Deserializer};
use std::ops::Range;
use toml::Spanned;

use crate::limits::{Quantity, Threshold};

/// Limits of the quantities of a mesh.
#[derive(Clone, Debug)]
pub(crate) struct Profile {
    /// The name for `--for`, or that of a user's file.
    pub(crate) name: String,
    /// A description of the solver in a few words, which may be empty.
    pub(crate) title: String,
    /// The metric by which runs for the solver smooth meshes; `None` if the default metric suits the solver.
    pub(crate) scheme: Option<Metric>,
    /// The limits in the order of the file, then the listed quantities, which have no range. A profile has at least one
    /// limit.
    pub(crate) limits: Vec<Limit>,
}

/// Ranges of values of a quantity that are bad for a solver. A listed quantity has neither range.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Limit {
    pub(crate) quantity: Quantity,
    /// The elements that a limit of elements concerns. Limits of edges concern edges of all elements, and listed quantities all
    /// elements.
    pub(crate) elements: Elements,
    /// Values of which users should know.
    pub(crate) warn: Option<Threshold>,
    /// Values with which the solver does not run, or that it or its users refuse.
    pub(crate) fail: Option<Threshold>,
    /// The document or the source file that states the limit.
    pub(crate) source: String,
}

impl Limit {
    /// Returns whether the quantity has no limit. Its worst value is then that of all parts of the mesh.
    pub(crate) fn is_listed(&self) -> bool {
        self.warn.is_none() && self.fail.is_none()
    }
}

/// A kind of elements, as other values are good for quadrilaterals than for triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Elements {
    #[default]
    Triangles,
    Quadrilaterals,
}

impl Elements {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Triangles => "triangles",
            Self::Quadrilaterals => "quadrilaterals",
        }
    }
}

/// A problem of the text of a profile.
#[derive(Debug, PartialEq)]
pub(crate) struct ProfileProblem {
    pub(crate) message: String,
    /// The line, from 1; `None` if the problem has no place.
    pub(crate) line: Option<usize>,
}

/// The keys of a file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct GivenProfile {
    name: String,
    #[serde(default)]
    title: String,
    #[serde(default, deserialize_with = "metric")]
    scheme: Option<Metric>,
    #[serde(default)]
    listed: Vec<Listed>,
    limits: Vec<Spanned<GivenLimit>>,
}

/// A quantity whose worst value is shown without a limit.
#[derive(Deserialize)]
#[serde(try_from = "String")]
struct Listed(Quantity);

impl TryFrom<String> for Listed {
    type Error = String;

    fn try_from(name: String) -> Result<Self, String> {
        name.parse().map(Self).map_err(|problem| format!("listed: {problem}"))
    }
}

/// The keys of a limit.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct GivenLimit {
    quantity: Spanned<String>,
    elements: Option<Spanned<Elements>>,
    warn: Option<Spanned<String>>,
    fail: Option<Spanned<String>>,
    #[serde(default)]
    source: String,
}

/// Reads the name of a metric.
fn metric<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Metric>, D::Error> {
    let name = String::deserialize(deserializer)?;
    name.parse().map(Some).map_err(|error| D::Error::custom(format!("scheme: {error}")))
}

impl Profile {
    /// Returns the quantities that have limits.
    pub(crate) fn limited(&self) -> impl Iterator<Item = Quantity> + '_ {
        self.limits.iter().filter(|limit| !limit.is_listed()).map(|limit| limit.quantity)
    }

    /// Returns whether depths are necessary for a limit or a listed quantity.
    pub(crate) fn needs_depths(&self) -> bool {
        self.limits.iter().any(|limit| limit.quantity == Quantity::TimeStep)
    }

    /// Parses the text of a file.
    ///
    /// # Errors
    /// Returns the first mistake in the text, such as an unknown key.
    pub(crate) fn parse(text: &str) -> Result<Self, ProfileProblem> {
        let given: Result<GivenProfile, _> = toml::from_str(text);
        let given = given
            .map_err(|error| Mistake { message: error.message().to_owned(), span: error.span() });
        given.and_then(GivenProfile::checked).map_err(|Mistake { message, span }| ProfileProblem {
            message,
            line: span.map(|span| {
                let before = text.get(..span.start).unwrap_or(text);
                1 + before.matches('\n').count()
            }),
        })
    }
}

/// A problem of the text of a profile.
struct Mistake {
    message: String,
    /// The bytes of the text that are wrong; `None` if the problem has no place.
    span: Option<Range<usize>>,
}

impl Mistake {
    fn at(span: Range<usize>, message: impl Into<String>) -> Self {
        Self { message: message.into(), span: Some(span) }
    }
}

impl GivenProfile {
    fn checked(self) -> Result<Profile, Mistake> {
        let Self { name, title, scheme, listed, limits } = self;
        if limits.is_empty() {
            let message = "a profile needs a limit, as in [[limits]]".into();
            return Err(Mistake { message, span: None });
        }
        let limits = limits.into_iter().map(GivenLimit::checked);
        let mut limits = limits.collect::<Result<Vec<_>, _>>()?;
        for Listed(quantity) in listed {
            let (elements, source) = (Elements::default(), String::new());
            limits.push(Limit { quantity, elements, warn: None, fail: None, source });
        }
        Ok(Profile { name, title, scheme, limits })
    }
}

impl GivenLimit {
    /// Returns the limit of a table of the file. A mistake has the place of the value, or that of the table if a value is
    /// missing.
    fn checked(given: Spanned<Self>) -> Result<Limit, Mistake> {
        let table = given.span();
        let Self { quantity, elements, warn, fail, source } = given.into_inner();
        let place = quantity.span();
        let quantity: Quantity =
            quantity.get_ref().parse().map_err(|problem: String| Mistake::at(place, problem))?;
        if let Some(elements) = &elements
            && *elements.get_ref() == Elements::Quadrilaterals
            && !quantity.is_of_quadrilaterals()
        {
            let message = format!("quadrilaterals have no limit of {quantity} of their own");
            return Err(Mistake::at(elements.span(), message));
        }
        let elements = elements.map(Spanned::into_inner).unwrap_or_default();
        let end = fail.as_ref().map_or_else(|| table.clone(), Spanned::span);
        let threshold = |key: &str, range: Option<Spanned<String>>| {
            let parsed = |range: Spanned<String>| {
                Threshold::of(quantity, range.get_ref()).map_err(|problem| {
                    Mistake::at(range.span(), format!("{key} of {quantity}: {problem}"))
                })
            };
            range.map(parsed).transpose()
        };
        let (warn, fail) = (threshold("warn", warn)?, threshold("fail", fail)?);
        let problem = match (&warn, &fail) {
            (None, None) => {
                format!("the limit of {quantity} needs warn or fail, as in fail = \"> 1\"")
            }
            (Some(warn), Some(fail)) if warn.is_below != fail.is_below => {
                format!("warn and fail of {quantity} have different directions: write two limits")
            }
            (Some(warn), Some(fail)) if !warn.contains(fail) => {
                format!("fail of {quantity} must be beyond warn")
            }
            _ => return Ok(Limit { quantity, elements, warn, fail, source }),
        };
        Err(Mistake::at(end, problem))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const OWN: &str = "name = \"ours\"\nscheme = \"acute\"\n\n[[limits]]\nquantity = \"min-angle\"\nwarn = \"< 30\"\n\
                       fail = \"< 20\"\n";

    #[test]
    fn the_ranges_of_a_file_are_thresholds_of_its_quantities() {
        let Profile { name, title, scheme, limits } = Profile::parse(OWN).unwrap();
        assert_eq!((&*name, &*title, scheme), ("ours", "", Some(Metric::Acute)));
        let [Limit { quantity, elements, warn, fail, source }] = &limits[..] else {
            panic!("{limits:?}")
        };
        let written = |threshold: &Option<Threshold>| threshold.as_ref().unwrap().to_string();
        assert_eq!((quantity.name(), *elements), ("min-angle", Elements::Triangles));
        assert_eq!([written(warn), written(fail)], ["min-angle<30", "min-angle<20"]);
        assert_eq!(source, "");
    }

    #[test]
    fn each_mistake_of_a_file_has_its_line_and_its_remedy() {
        let cases = [
            ("fail = \"< 20\"", "fail = \"> 20\"", 7, "write 'min-angle<20'"),
            ("min-angle", "roundness", 5, "no measure is called 'roundness'; there are "),
            ("fail = \"< 20\"", "fails = \"< 20\"", 7, "unknown field `fails`"),
            ("warn = \"< 30\"\nfail = \"< 20\"\n", "", 4, "needs warn or fail"),
            ("acute", "round", 2, "scheme: no metric is called 'round'"),
            (
                "scheme = \"acute\"",
                "listed = [\"depth\"]",
                2,
                "listed: no measure is called 'depth'",
            ),
            ("name = \"ours\"\n", "", 1, "missing field `name`"),
            ("\"< 20\"", "20", 7, "expected a string"),
            ("warn", "elements = \"hexagons\"\nwarn", 6, "unknown variant `hexagons`"),
            (
                "quantity = \"min-angle\"\nwarn = \"< 30\"\nfail = \"< 20\"",
                "quantity = \"neighbors\"\nelements = \"quadrilaterals\"\nfail = \"> 9\"",
                6,
                "quadrilaterals have no limit of neighbors of their own",
            ),
            ("\"< 20\"", "\"< twenty\"", 7, "fail of min-angle: 'twenty' is not a number"),
            ("[[limits]]", "[limits", 4, ""),
            ("\"< 20\"", "\"< 40\"", 7, "fail of min-angle must be beyond warn"),
        ];
        for (from, to, line, part) in cases {
            let ProfileProblem { message, line: found } =
                Profile::parse(&OWN.replace(from, to)).unwrap_err();
            assert!(message.contains(part), "{to}: {message}");
            assert_eq!(found, Some(line), "{to}: {message}");
        }
        // The place of a later table is not that of the first.
        let third = "\n[[limits]]\nquantity = \"neighbors\"\n";
        let found = Profile::parse(&format!("{OWN}{third}{third}warn = \"> 9\"\n")).unwrap_err();
        assert_eq!(found.line, Some(9), "{}", found.message);
        let two = OWN.replace("min-angle", "neighbors").replace("\"< 20\"", "\"> 20\"");
        let message = Profile::parse(&two).unwrap_err().message;
        assert!(message.contains("write two limits"), "{message}");
    }
}
