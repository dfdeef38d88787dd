//! The options of `gpu-smooth try`.

use std::path::PathBuf;

use clap::Args;

use crate::args::table::{OfTrial, TableArgs};
use crate::args::{MoveArgs, ReadArgs, SideArgs, names};
use crate::profiles::ProfileSource;

/// All options but `--json` are options of a run, and belong to each of the tried runs.
#[derive(Args)]
pub(crate) struct TryArgs {
    /// The mesh
    pub(crate) mesh: PathBuf,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// Smooth for a solver, or for a TOML file of limits, and count what is beyond the limits. The best row has the fewest.
    /// docs/solvers.md has all limits
    #[arg(long = "for", value_name = "NAME|FILE", value_parser = names::profiles())]
    pub(crate) profile: Option<ProfileSource>,
    #[command(flatten)]
    pub(crate) options: TableArgs<OfTrial>,
    #[command(flatten)]
    pub(crate) moving: MoveArgs,
    #[command(flatten)]
    pub(crate) sides: SideArgs,
    #[command(flatten)]
    pub(crate) reading: ReadArgs,
}
