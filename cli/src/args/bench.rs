//! The options of `gpu-smooth bench`.

use std::path::PathBuf;

use clap::Args;

use gpu_smooth::{Metric, Scheme};
use gpu_smooth_job::EngineRequest;

use crate::args::ReadArgs;
use crate::args::parse;
use crate::args::table::{OfBench, TableArgs};

#[derive(Args)]
#[command(mut_arg("scheme", |arg| {
    arg.help("The metric to sweep by, or several in turn").default_value("imr").help_heading(None)
}))]
#[command(mut_arg("engine", |arg| {
    arg.help("What to measure: the CPU and the best GPU adapter, or one of them").help_heading(None)
}))]
#[command(mut_arg("adapter", |arg| {
    arg.help("Measure the first adapter with NAME in its name").help_heading(None)
}))]
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
    #[command(flatten)]
    pub(crate) options: TableArgs<OfBench>,
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
    pub(crate) reading: ReadArgs,
}

impl BenchArgs {
    /// Returns the scheme to measure.
    pub(crate) fn scheme(&self) -> Scheme {
        self.options.settings().run.scheme.clone().unwrap_or_else(|| Metric::Imr.into())
    }

    /// Returns whether the CPU is measured.
    pub(crate) fn has_cpu(&self) -> bool {
        matches!(self.options.settings().engine(), EngineRequest::Auto | EngineRequest::Cpu)
    }

    /// Returns whether a GPU is measured.
    pub(crate) fn has_gpu(&self) -> bool {
        self.options.settings().engine() != EngineRequest::Cpu
    }

    /// Returns the text in the name of the GPU adapter.
    pub(crate) fn adapter(&self) -> Option<&str> {
        self.options.settings().adapter.as_deref()
    }
}
