//! The options of `gpu-smooth quality`.

use std::path::PathBuf;
use std::str::FromStr;

use clap::{ArgGroup, Args};
use gpu_smooth::measure::{Better, Measure};

use crate::args::PictureArgs;
use crate::args::ReadArgs;
use crate::args::names;
use crate::args::table::{OfCoordinates, TableArgs};

// Arrows need a run. The option is accepted here only for the message that says so.
#[derive(Args)]
#[command(group = ArgGroup::new("drawing").args(["picture", "html"]).multiple(true))]
#[command(mut_arg("picture_arrows", |arrows| arrows.hide(true)))]
pub(crate) struct QualityArgs {
    /// The meshes; several are shown side by side
    #[arg(required = true, value_name = "MESH")]
    pub(crate) meshes: Vec<PathBuf>,
    #[arg(
        short,
        long,
        value_name = "NAME,...",
        value_delimiter = ',',
        value_parser = names::measures(),
        hide_possible_values = true,
        help = names::measure_help()
    )]
    pub(crate) measure: Vec<Measure>,
    /// Number of worst triangles to list
    #[arg(long, value_name = "N", default_value_t = 5)]
    pub(crate) worst: usize,
    /// Show the statistics of each region too: physical groups, materials, references, attributes
    #[arg(long)]
    pub(crate) by_region: bool,
    /// Values that no triangle may have, as in 'min-angle<20'; may be given several times. The exit code is 1 if a
    /// triangle has such a value. Each threshold has a line that says whether it holds and where the worst triangle is; -q
    /// prints the violated ones alone
    #[arg(long, value_name = "NAME<VALUE")]
    pub(crate) threshold: Vec<Threshold>,
    /// Print one line for each mesh, or for each --threshold of each mesh, for logs
    #[arg(long, conflicts_with_all = ["csv", "json"])]
    pub(crate) summary: bool,
    /// Print JSON
    #[arg(long, conflicts_with = "csv")]
    pub(crate) json: bool,
    /// Print the statistics as CSV, a row for each measure (and region) of each file
    #[arg(long)]
    pub(crate) csv: bool,
    /// Draw in ASCII, which is the default where standard output is not a terminal
    #[arg(long)]
    pub(crate) ascii: bool,
    /// Write a page for a browser, in one file that needs nothing else: the mesh, histograms, statistics and the worst
    /// triangles. Several meshes have one page, with a picture of each
    #[arg(long, value_name = "FILE")]
    pub(crate) html: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) picture: PictureArgs,
    #[command(flatten)]
    pub(crate) coordinates: TableArgs<OfCoordinates>,
    #[command(flatten)]
    pub(crate) reading: ReadArgs,
}

impl QualityArgs {
    /// Returns the measures with a histogram, the first of which ranks triangles.
    pub(crate) fn histograms(&self) -> &[Measure] {
        match &self.measure[..] {
            [] => &[Measure::Shape, Measure::MinAngle],
            named => named,
        }
    }

    /// Returns the measures with statistics: those of `--measure`, or all, each once.
    pub(crate) fn statistics(&self) -> Vec<Measure> {
        let all = if self.measure.is_empty() { Measure::ALL } else { &self.measure };
        let mut measures: Vec<Measure> = Vec::new();
        all.iter().for_each(|measure| {
            if !measures.contains(measure) {
                measures.push(*measure);
            }
        });
        measures
    }
}

/// A range of bad values of a measure, as in `min-angle<20`. If a triangle has a value in the range, the exit code
/// is 1.
#[derive(Clone, Debug)]
pub(crate) struct Threshold {
    pub(crate) measure: Measure,
    or_equal: bool,
    value: f64,
}

impl Threshold {
    /// Returns whether a triangle with this value of the measure violates the threshold.
    pub(crate) fn is_met(&self, value: f64) -> bool {
        self.measure.is_worse(value, self.value) || self.or_equal && value == self.value
    }
}

impl std::fmt::Display for Threshold {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let sign = match self.measure.definition().better {
            Better::Higher => '<',
            Better::Lower => '>',
        };
        let equal = if self.or_equal { "=" } else { "" };
        write!(f, "{}{sign}{equal}{}", self.measure, self.value)
    }
}

impl FromStr for Threshold {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        let form = "a measure, < or >, and a number, as in min-angle<20";
        let at = text.find(['<', '>']).ok_or_else(|| format!("it must be {form}"))?;
        let (name, rest) = text.split_at(at);
        let measure: Measure = name.parse().map_err(|error| format!("{error}"))?;
        let number = rest[1..].trim_start_matches('=');
        let or_equal = match rest.len() - 1 - number.len() {
            0 => false,
            1 => true,
            _ => return Err(format!("it must be {form}")),
        };
        let value: f64 =
            number.trim().parse().map_err(|_| format!("'{number}' is not a number"))?;
        if value.is_nan() {
            return Err(format!("'{number}' is not a number"));
        }
        let threshold = Self { measure, or_equal, value };
        let bad = match measure.definition().better {
            Better::Higher => "low",
            Better::Lower => "high",
        };
        if rest.starts_with('<') != (bad == "low") {
            // Most likely the user wrote the values that all triangles should have.
            return Err(format!(
                "--threshold names the values that no triangle may have, and {bad} values of {measure} are bad: write '{threshold}'"
            ));
        }
        Ok(threshold)
    }
}
