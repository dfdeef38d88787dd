//! The options of `gpu-smooth bench`.

use std::path::PathBuf;

use clap::Args;
use clap_complete::engine::ArgValueCompleter;
use gpu_smooth::Scheme;

use crate::args::EngineChoice;
use crate::args::ReadArgs;
use crate::args::SurfaceArgs;
use crate::args::{names, parse};

#[derive(Args)]
pub(crate) struct BenchArgs {
    /// A mesh to measure on [default: lattices, see --vertices]
    pub(crate) mesh: Option<PathBuf>,
    /// Sizes of the lattices to measure on
    #[arg(
        long,
        value_name = "N,...",
        value_delimiter = ',',
        default_value = "10000,100000,1000000",
        value_parser = parse::vertices,
        conflicts_with = "mesh",
        allow_negative_numbers = true
    )]
    pub(crate) vertices: Vec<usize>,
    /// The metric to sweep by, or several in turn
    #[arg(long, default_value = "imr", value_name = "A[+B...]", value_parser = names::schemes(), hide_possible_values = true, add = ArgValueCompleter::new(names::completed_schemes))]
    pub(crate) scheme: Scheme,
    /// What to measure: the CPU and the best GPU adapter, or one of them
    #[arg(long, value_enum, default_value = "auto")]
    pub(crate) engine: EngineChoice,
    /// Measure the first adapter with NAME in its name
    #[arg(long, value_name = "NAME")]
    pub(crate) adapter: Option<String>,
    /// Time whole runs and their phases instead of single sweeps: set-up, coarser levels, compilation of kernels and waits
    /// for the device, with counts of the work that a run gives to the device
    #[arg(long, conflicts_with = "baseline")]
    pub(crate) runs: bool,
    /// Seconds to measure for each line
    #[arg(long, default_value_t = 2.0, value_name = "S", value_parser = parse::nonnegative, allow_negative_numbers = true)]
    pub(crate) seconds: f64,
    /// Print JSON, which --baseline reads
    #[arg(long)]
    pub(crate) json: bool,
    /// Print Markdown with the machine and the version, ready to be pasted
    #[arg(long, conflicts_with = "json")]
    pub(crate) markdown: bool,
    /// Compare with the measurements in FILE, the output of `bench --json`
    #[arg(long, value_name = "FILE")]
    pub(crate) baseline: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) surface: SurfaceArgs,
    #[command(flatten)]
    pub(crate) reading: ReadArgs,
}
