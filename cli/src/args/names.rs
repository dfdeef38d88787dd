//! Names of metrics and measures in options: parsers that offer the names as completions, and lists for help texts and
//! messages. All names come from the library's tables.

use std::ffi::OsStr;

use clap::builder::{PossibleValue, TypedValueParser};
use clap::{Arg, Command};
use clap_complete::engine::CompletionCandidate;
use gpu_smooth::{Metric, measure::Measure};
use mesh_io::Format;

use crate::profiles::{self, ProfileSource};

/// A parser of values that offers names as completions. Values beyond the offered names may be valid, such as
/// `edge+imr`.
#[derive(Clone)]
pub(crate) struct Offering<T> {
    parse: fn(&str) -> Result<T, String>,
    names: fn() -> Vec<&'static str>,
}

impl<T: Clone + Send + Sync + 'static> TypedValueParser for Offering<T> {
    type Value = T;

    fn parse_ref(
        &self,
        command: &Command,
        arg: Option<&Arg>,
        value: &OsStr,
    ) -> Result<T, clap::Error> {
        self.parse.parse_ref(command, arg, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new((self.names)().into_iter().map(PossibleValue::new)))
    }
}

/// Returns the completions of an incomplete scheme: the scheme with each metric whose name begins like the last word.
pub(crate) fn completed_schemes(scheme: &OsStr) -> Vec<CompletionCandidate> {
    let scheme = scheme.to_string_lossy();
    let start = scheme.rfind('+').map_or(0, |sign| sign + 1);
    let (before, last) = scheme.split_at(start);
    let names = metrics(|metric| metric.name().starts_with(last));
    names.iter().map(|name| CompletionCandidate::new(format!("{before}{name}"))).collect()
}

/// Returns the parser of measures, which offers the names of all measures.
pub(crate) fn measures() -> Offering<Measure> {
    let parse = |text: &str| text.parse().map_err(|error| format!("{error}"));
    Offering { parse, names: || Measure::ALL.iter().map(|measure| measure.name()).collect() }
}

/// Returns the parser of profiles, which offers the names of the program's profiles.
pub(crate) fn profiles() -> Offering<ProfileSource> {
    Offering { parse: ProfileSource::of, names: profiles::names }
}

/// Returns the names of the metrics for which `is_wanted` is true.
pub(crate) fn metrics(is_wanted: impl Fn(Metric) -> bool) -> Vec<&'static str> {
    let wanted = Metric::ALL.iter().filter(|&&metric| is_wanted(metric));
    wanted.map(|metric| metric.name()).collect()
}

/// Returns the help text of `--measure`.
pub(crate) fn measure_help() -> String {
    let own = Measure::ALL.iter().filter(|measure| !matches!(measure, Measure::Metric(_)));
    let names: Vec<_> = own.map(|measure| measure.name()).collect();
    format!(
        "Measures with statistics and a histogram; the first also ranks the worst triangles: {}, or a metric [default: statistics of \
         these measures, histograms of shape and min-angle]",
        names.join(", ")
    )
}

/// Returns a list of the supported input formats, each with the usual extension of its files.
pub(crate) fn formats() -> String {
    let mut names: Vec<String> = Vec::new();
    for format in Format::ALL {
        let (family, ending) = (format.family(), format.extensions()[0]);
        let name = match family.contains(ending) {
            true => family.to_owned(),
            false => format!("{family} {ending}"),
        };
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names.join(", ")
}
