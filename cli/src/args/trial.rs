//! The options of `gpu-smooth try`.

use std::path::PathBuf;

use clap::Args;

use crate::args::table::{OfTrial, TableArgs};
use crate::args::{MoveArgs, ReadArgs, SideArgs};

/// All options but `--json` are options of a run, and belong to each of the tried runs.
#[derive(Args)]
pub(crate) struct TryArgs {
    /// The mesh
    pub(crate) mesh: PathBuf,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) options: TableArgs<OfTrial>,
    #[command(flatten)]
    pub(crate) moving: MoveArgs,
    #[command(flatten)]
    pub(crate) sides: SideArgs,
    #[command(flatten)]
    pub(crate) reading: ReadArgs,
}
