//! The options of `gpu-smooth quality`.

use std::path::PathBuf;

use clap::{ArgGroup, Args};
use gpu_smooth::measure::Measure;

use crate::args::PictureArgs;
use crate::args::names;
use crate::args::table::{OfCoordinates, TableArgs};
use crate::args::{Quadrilaterals, ReadArgs};
use crate::limits::Threshold;
use crate::profiles::ProfileSource;

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
    /// Number of worst elements to list; of worst edges, if the first measure is orthogonality, flow-link or smoothness
    #[arg(long, value_name = "N", default_value_t = 5)]
    pub(crate) worst: usize,
    /// Measure triangles and quadrilaterals (move), or the triangles alone (keep), as runs with the same option do.
    /// Quadrilaterals of a mesh without triangles are always measured
    #[arg(long, value_name = "move|keep", default_value = "move", hide_possible_values = true)]
    pub(crate) quadrilaterals: Quadrilaterals,
    /// Show the statistics of each region too: physical groups, materials, references, attributes
    #[arg(long)]
    pub(crate) by_region: bool,
    /// Values that no triangle may have, as in 'min-angle<20'; may be given several times. orthogonality, flow-link
    /// and smoothness are those of edges, neighbors the number of elements at a vertex, boundary-corners the number of corners of a
    /// triangle on the boundary, hole-edges the number of edges around a hole, and time-step the altitude over the speed of
    /// waves by the depths of the file, in seconds. The exit code is 1 if a part of the mesh has such a value. Each threshold has a line that
    /// says whether it holds and where the worst part is; -q prints the violated ones alone
    #[arg(long, value_name = "NAME<VALUE")]
    pub(crate) threshold: Vec<Threshold>,
    /// Compare each mesh with the limits of a solver, or of a TOML file of your own, in a table. The exit code is 1 if a limit
    /// fails. docs/solvers.md has all limits with their sources
    #[arg(long = "for", value_name = "NAME|FILE", value_parser = names::profiles())]
    pub(crate) profile: Option<ProfileSource>,
    /// Print one line for each mesh, or for each --threshold and each limit of --for of each mesh, for logs
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
