//! The options of `gpu-smooth IN OUT`.

use std::path::PathBuf;
use std::time::Duration;

use clap::{ArgGroup, Args, ValueEnum};
use clap_complete::engine::ArgValueCompleter;
use gpu_smooth::Scheme;

use crate::args::{
    Desired, FieldArgs, MoveArgs, PictureArgs, ReadArgs, SlideArgs, TargetArgs, WorstArgs,
};
use crate::args::{names, parse};

#[derive(Args)]
#[command(group = ArgGroup::new("drawing").args(["picture", "html"]).multiple(true))]
#[command(group = ArgGroup::new("kept").args(["checkpoint", "continued"]).multiple(true))]
pub(crate) struct SmoothArgs {
    /// Mesh to read; the format is detected from its content. It may be compressed by gzip or zstd; - reads standard
    /// input
    #[arg(required = true, value_name = "IN")]
    pub(crate) input: Option<PathBuf>,
    /// File for the smoothed mesh, in the format of IN; may be IN itself. The file is compressed if its name ends in
    /// .gz or .zst; - writes to standard output
    #[arg(required_unless_present = "out_dir", value_name = "OUT")]
    pub(crate) output: Option<PathBuf>,
    /// Further meshes, with --out-dir
    #[arg(hide = true, value_name = "MESH")]
    pub(crate) more: Vec<PathBuf>,

    #[arg(
        long,
        value_name = "A[+B...]",
        value_parser = names::schemes(),
        add = ArgValueCompleter::new(names::completed_schemes),
        hide_possible_values = true,
        help_heading = "Metric and engine",
        help = names::scheme_help()
    )]
    pub(crate) scheme: Option<Scheme>,

    /// Where to compute: on a GPU adapter, even if it is software (gpu), on the CPU (cpu), or where the run is estimated
    /// to be done first, but not on a software adapter (auto)
    #[arg(long, value_enum, default_value = "auto", help_heading = "Metric and engine")]
    pub(crate) engine: EngineChoice,
    /// Take the first GPU adapter with NAME in its name (see `gpu-smooth adapters`)
    #[arg(long, value_name = "NAME", help_heading = "Metric and engine")]
    pub(crate) adapter: Option<String>,

    /// Exit with 1 if the run neither converges nor reaches its goal. The mesh is written all the same
    #[arg(long, help_heading = "Stopping")]
    pub(crate) strict: bool,
    /// Stop after N sweeps at the latest
    #[arg(
        long,
        default_value_t = 1000,
        value_name = "N",
        help_heading = "Stopping",
        allow_negative_numbers = true
    )]
    pub(crate) max_sweeps: u32,
    /// Stop when f is estimated to be within this share of its limit; 0 to go on to the last sweep
    #[arg(long, default_value_t = 1e-6, value_name = "T", help_heading = "Stopping", value_parser = parse::nonnegative, allow_negative_numbers = true, conflicts_with_all = ["fraction", "desired"])]
    pub(crate) tolerance: f64,
    /// Stop after this fraction of the reduction from the initial f to the desired f, instead of at the tolerance. Park
    /// & Shontz use 0.95 [default with --desired: 0.95]
    #[arg(long, value_name = "SHARE", help_heading = "Stopping", value_parser = parse::fraction, allow_negative_numbers = true)]
    pub(crate) fraction: Option<f64>,
    /// The desired f by the first metric; auto finds the optimum before the run, in tries of up to 5000 sweeps [default
    /// with --fraction: auto]
    #[arg(long, value_name = "F|auto", help_heading = "Stopping", value_parser = parse::desired, allow_negative_numbers = true)]
    pub(crate) desired: Option<Desired>,

    /// Stop after this many seconds, counted from when the mesh begins to be read, and write the best mesh so far. A mesh that
    /// is still being untangled then is written only with --keep-going
    #[arg(long, value_name = "SECONDS", help_heading = "Stopping", value_parser = parse::seconds, allow_negative_numbers = true)]
    pub(crate) time_limit: Option<Duration>,
    /// Save the state of the run to FILE every five minutes, and when Ctrl-C or --time-limit ends it. FILE is removed once a run has
    /// come to its end. OUT must be another file than IN
    #[arg(long, value_name = "FILE", help_heading = "Stopping", conflicts_with = "out_dir")]
    pub(crate) checkpoint: Option<PathBuf>,
    /// How often the state is saved
    #[arg(long, default_value = "300", value_name = "SECONDS", requires = "kept", help_heading = "Stopping", value_parser = parse::seconds, allow_negative_numbers = true)]
    pub(crate) checkpoint_every: Duration,
    /// Continue the run that saved the checkpoint FILE, with the same IN and options. On the CPU, or on the GPU of the
    /// saved run, the result is bit-identical to that of an uninterrupted run. If the driver of that GPU ended the
    /// process, add --engine cpu. The state is saved to FILE again, unless --checkpoint names another file
    #[arg(
        long = "continue",
        value_name = "FILE",
        help_heading = "Stopping",
        conflicts_with = "out_dir"
    )]
    pub(crate) continued: Option<PathBuf>,

    #[arg(
        long,
        value_enum,
        default_value = "auto",
        help_heading = "Method",
        help = names::method_help()
    )]
    pub(crate) method: MethodChoice,
    /// Over-relaxation factor of --method relaxed, above 0 and below 2 [default: by metric, see `gpu-smooth metrics`; 1 if
    /// metrics alternate]
    #[arg(long, value_name = "W", help_heading = "Method", value_parser = parse::omega, allow_negative_numbers = true)]
    pub(crate) omega: Option<f64>,
    /// Newton steps per visit of a vertex, by --method paper
    #[arg(long, default_value_t = 1, value_name = "N", help_heading = "Method", value_parser = clap::value_parser!(u32).range(1..=1000), allow_negative_numbers = true)]
    pub(crate) inner: u32,
    /// How --method paper differentiates metrics; finite differences only serve to test the paper's cost model
    #[arg(long, value_enum, default_value = "analytic", help_heading = "Method")]
    pub(crate) derivatives: DerivativesChoice,
    /// Exponent of the p-norm that replaces edge in Newton steps: 16 throughout (fixed), or doubled from 2 up to 8192
    /// (continued; 512 without corrections from coarser levels), which reaches a lower f [default: continued with
    /// corrections, fixed without]
    #[arg(long, value_enum, help_heading = "Method")]
    pub(crate) edge_norm: Option<EdgeNorm>,

    /// Bound on the inverse mean ratio of triangles after a step, measured under the --target: by-metric bounds only
    /// metrics without a barrier; worst lets no triangle exceed the initial maximum of the triangles with a free vertex
    #[arg(long, value_enum, default_value = "by-metric", help_heading = "Method")]
    pub(crate) guard: GuardChoice,

    #[command(flatten)]
    pub(crate) improving: WorstArgs,

    #[command(flatten)]
    pub(crate) target: TargetArgs,

    #[command(flatten)]
    pub(crate) reading: ReadArgs,

    #[command(flatten)]
    pub(crate) moving: MoveArgs,

    #[command(flatten)]
    pub(crate) sliding: SlideArgs,

    /// Let no vertex move farther than this many times the mean length of the edges around it before the run
    #[arg(long, value_name = "EDGES", help_heading = "What may move", value_parser = parse::edges, allow_negative_numbers = true)]
    pub(crate) max_move: Option<f64>,

    /// Let no triangle's altitude fall below the least of IN, which bounds the time step of explicit solvers
    #[arg(long, help_heading = "What may move")]
    pub(crate) keep_altitude: bool,

    #[command(flatten)]
    pub(crate) fields: FieldArgs,

    /// Untangle the mesh first if triangles are inverted or flat: move free vertices until none is. Done on the CPU
    #[arg(long, help_heading = "Untangling")]
    pub(crate) untangle: bool,
    /// If a mesh cannot be untangled, write the best mesh found all the same. The exit code is 1. A mesh whose boundary crosses
    /// itself is untangled as far as its triangles go, and is not refused
    #[arg(long, requires = "untangle", help_heading = "Untangling")]
    pub(crate) keep_going: bool,

    /// Read and check the mesh and the options, and print how many vertices would move, which are fixed for which reason,
    /// and the engine. Neither smooth nor write anything
    #[arg(long, help_heading = "Output", conflicts_with = "out_dir")]
    pub(crate) dry_run: bool,
    /// Replace OUT even if OUT holds another mesh than IN, or no mesh. Without --force, OUT must be new or empty, be IN
    /// itself, or hold a mesh with the triangles and the fixed vertices of IN
    #[arg(long, help_heading = "Output")]
    pub(crate) force: bool,
    /// Write a JSON report with the history of every sweep and a certificate: the written mesh is read again, the
    /// statements of `gpu-smooth compare` are proved for it, and both files are hashed. If inverted or flat triangles
    /// prevent smoothing, the report lists them. docs/report.md describes the keys
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub(crate) report: Option<PathBuf>,
    /// Which f the report's history holds: that of the first metric (base), or those of all metrics (all)
    #[arg(long, value_enum, default_value = "base", requires = "report", help_heading = "Output")]
    pub(crate) history: History,
    /// Write a page for a browser, in one file that needs nothing else: the mesh before and after, which can be enlarged,
    /// histograms, f by sweep and time, statistics, the worst triangles
    #[arg(long, value_name = "FILE", help_heading = "Output", conflicts_with = "out_dir")]
    pub(crate) html: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) picture: PictureArgs,

    /// Smooth all given meshes, each into a file of the same name in the directory DIR, created if missing. Small
    /// meshes are smoothed concurrently; a failed mesh does not stop the rest
    #[arg(long, value_name = "DIR", help_heading = "Many meshes", conflicts_with = "picture")]
    pub(crate) out_dir: Option<PathBuf>,
    /// Skip meshes whose smoothed files are all in DIR and newer than the mesh
    #[arg(long, requires = "out_dir", help_heading = "Many meshes", conflicts_with = "keep_going")]
    pub(crate) resume: bool,
    /// Print the table of the meshes as CSV
    #[arg(long, requires = "out_dir", help_heading = "Many meshes", conflicts_with = "json")]
    pub(crate) csv: bool,
    /// Print the table of the meshes as JSON
    #[arg(long, requires = "out_dir", help_heading = "Many meshes")]
    pub(crate) json: bool,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum EngineChoice {
    Auto,
    Gpu,
    Cpu,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum MethodChoice {
    Auto,
    Multilevel,
    Relaxed,
    Paper,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum GuardChoice {
    ByMetric,
    Worst,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum DerivativesChoice {
    Analytic,
    FiniteDifference,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum EdgeNorm {
    Fixed,
    Continued,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum History {
    Base,
    All,
}
