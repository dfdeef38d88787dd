//! The options of `gpu-smooth try`.

use std::path::PathBuf;

use clap::Args;

use crate::args::parse;
use crate::args::{EngineChoice, MoveArgs, ReadArgs, SlideArgs, SurfaceArgs};

/// All options but `--json` are options of a run, and belong to each of the tried runs.
#[derive(Args)]
pub(crate) struct TryArgs {
    /// The mesh
    pub(crate) mesh: PathBuf,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// Where to compute, as in a run
    #[arg(long, value_enum, default_value = "auto", help_heading = "Options of all runs")]
    pub(crate) engine: EngineChoice,
    /// Untangle the mesh first if triangles are inverted or flat
    #[arg(long, help_heading = "Options of all runs")]
    pub(crate) untangle: bool,
    /// Let no vertex move farther than this many times the mean length of the edges around it before the run
    #[arg(long, value_name = "EDGES", help_heading = "Options of all runs", value_parser = parse::edges, allow_negative_numbers = true)]
    pub(crate) max_move: Option<f64>,
    /// Let no triangle's altitude fall below the least of MESH
    #[arg(long, help_heading = "Options of all runs")]
    pub(crate) keep_altitude: bool,
    #[command(flatten)]
    pub(crate) moving: MoveArgs,
    #[command(flatten)]
    pub(crate) sliding: SlideArgs,
    #[command(flatten)]
    pub(crate) surface: SurfaceArgs,
    #[command(flatten)]
    pub(crate) reading: ReadArgs,
}
