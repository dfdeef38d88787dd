//! The command line.

use std::ffi::OsString;
use std::path::PathBuf;

use crate::moving::MoveArgs;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::parser::ValueSource;
use clap::{Arg, ArgMatches, Args, CommandFactory, FromArgMatches, Parser, Subcommand, ValueEnum};
use gpu_smooth::{
    Conversion, Derivatives, Desired, Format, Goal, Method, Options, Precision, Scheme, Sharpness,
};

use crate::picture::PictureArgs;
use crate::quality::QualityArgs;
use crate::riding::RidingArgs;

/// Smooths a 2D triangle mesh: moves its interior vertices until the elements are as good as they can be,
/// without inverting one. OUT is the same as IN but for the coordinates of vertices that moved.
#[derive(Parser)]
#[command(
    version,
    subcommand_negates_reqs = true,
    override_usage = "gpu-smooth [OPTIONS] <IN> <OUT>\n       gpu-smooth <COMMAND>",
    after_help = "Boundary vertices and those on constraint lines or between regions stay where they are. Formats: \
                  Triangle .node/.ele, gmsh .msh, VTK .vtk, .vtu and .vtp, SU2, Medit .mesh and .meshb, OBJ, PLY, OFF, ADCIRC \
                  fort.14, SCHISM .gr3, SMS .2dm, FreeFem .msh, SELAFIN, in ASCII or binary. Ctrl-C ends a run at \
                  the next sweep and writes the best mesh so far; a second one ends it at once.\n\n\
                  Examples:\n  \
                  gpu-smooth coast.msh better.msh --picture better.png\n  \
                  gpu-smooth part.1.node out.node --scheme edge+imr --report run.json\n  \
                  gpu-smooth wing.su2 better.su2 --fix airfoil --only-bad 2\n  \
                  gpu-smooth quality better.msh\n  \
                  gpu-smooth bench"
)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Option<Command>,
    #[command(flatten)]
    pub(crate) smooth: SmoothArgs,
    #[command(flatten)]
    pub(crate) output: OutputArgs,
}

/// How much is printed, whatever the command.
#[derive(Args)]
pub(crate) struct OutputArgs {
    /// Print errors only; commands still print their answer
    #[arg(short, long, global = true, conflicts_with = "verbose", help_heading = "Output")]
    pub(crate) quiet: bool,
    /// Print every sweep of a run
    #[arg(short, long, global = true, help_heading = "Output")]
    pub(crate) verbose: bool,
}

#[derive(Subcommand)]
pub(crate) enum Command {
    /// Tells how good meshes are, and where they are worst
    Quality(QualityArgs),
    /// Lists what can be named in a mesh file: physical groups, markers, references, materials and the like, and data of
    /// vertices
    Groups(GroupsArgs),
    /// Proves from two files of a mesh that only vertices which may move have moved, and that no triangle is inverted
    Compare(CompareArgs),
    /// Writes a mesh in another format, and says before what that does not hold
    Convert(ConvertArgs),
    /// Lists the GPU adapters there are, best first, and whether each can be used
    Adapters,
    /// Tells what each metric measures and what it is good for
    Metrics,
    /// Measures how fast this machine smooths: sweeps, bytes, and each kernel
    Bench(BenchArgs),
}

#[derive(Args)]
pub(crate) struct GroupsArgs {
    /// The mesh
    pub(crate) mesh: PathBuf,
    /// As JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Args)]
pub(crate) struct CompareArgs {
    /// The mesh before
    pub(crate) before: PathBuf,
    /// The mesh after
    pub(crate) after: PathBuf,
    /// What may have moved: the options of the run
    #[command(flatten)]
    pub(crate) moving: MoveArgs,
    #[command(flatten)]
    pub(crate) riding: RidingArgs,
}

#[derive(Args)]
pub(crate) struct ConvertArgs {
    /// The mesh, in any format that is read; - for the standard input
    pub(crate) input: PathBuf,
    /// Where to write it; its ending tells the format. - for the standard output, with --to
    pub(crate) output: PathBuf,
    /// The format to write, where the ending does not tell it: .msh is gmsh 4.1 without it
    #[arg(long, value_name = "FORMAT", value_parser = target)]
    pub(crate) to: Option<Format>,
    /// Write the mesh even if the format does not hold all of it
    #[arg(long)]
    pub(crate) lossy: bool,
}

/// The format of this short name.
fn target(text: &str) -> Result<Format, String> {
    let found = Conversion::targets().find(|(name, _)| *name == text);
    let names = || Conversion::targets().map(|(name, _)| name).collect::<Vec<_>>().join(", ");
    found.map(|(_, format)| format).ok_or_else(|| format!("it is one of {}", names()))
}

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
        value_parser = vertices,
        conflicts_with = "mesh",
        allow_negative_numbers = true
    )]
    pub(crate) vertices: Vec<usize>,
    /// The metric to sweep by, or several in turn
    #[arg(long, default_value = "imr", value_name = "A[+B...]")]
    pub(crate) scheme: Scheme,
    /// What to measure: the CPU and the best GPU adapter, or one of them
    #[arg(long, value_enum, default_value = "auto")]
    pub(crate) engine: EngineChoice,
    /// Measure the first adapter with NAME in its name
    #[arg(long, value_name = "NAME")]
    pub(crate) adapter: Option<String>,
    /// Seconds to measure for each line
    #[arg(long, default_value_t = 2.0, value_name = "S", value_parser = seconds, allow_negative_numbers = true)]
    pub(crate) seconds: f64,
    /// As JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Args)]
pub(crate) struct SmoothArgs {
    /// The mesh to read; its format is told by its content. It may be compressed by gzip or zstd, or - for the standard input
    #[arg(required = true, value_name = "IN")]
    pub(crate) input: Option<PathBuf>,
    /// Where to write the smoothed mesh, in the format of IN; may be IN itself, or - for the standard output.
    /// A name that ends in .gz or .zst gets a compressed file
    #[arg(required = true, value_name = "OUT")]
    pub(crate) output: Option<PathBuf>,

    /// The metric to minimize, or several in turn, sweep by sweep, as in edge+imr; the first judges
    /// convergence. Metrics: edge, area, rms, imr, ar, shape-size (see `gpu-smooth metrics`)
    #[arg(long, default_value = "imr", value_name = "A[+B...]")]
    pub(crate) scheme: Scheme,

    #[command(flatten)]
    pub(crate) moving: MoveArgs,

    #[command(flatten)]
    pub(crate) riding: RidingArgs,

    /// Untangle the mesh first if triangles are inverted or flat: move free vertices until none is. Done on the CPU
    #[arg(long)]
    pub(crate) untangle: bool,
    /// If a mesh cannot be untangled, write the best mesh found all the same. The exit code is 1
    #[arg(long, requires = "untangle")]
    pub(crate) keep_going: bool,

    /// Where to compute: on a GPU adapter, be it a software one, or on the CPU; auto takes what is estimated to be
    /// done first, but no software adapter
    #[arg(long, value_enum, default_value = "auto")]
    pub(crate) engine: EngineChoice,
    /// Take the first GPU adapter with NAME in its name (see `gpu-smooth adapters`)
    #[arg(long, value_name = "NAME")]
    pub(crate) adapter: Option<String>,

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
    #[arg(long, default_value_t = 1e-6, value_name = "T", help_heading = "Stopping", value_parser = tolerance, allow_negative_numbers = true, conflicts_with_all = ["fraction", "desired"])]
    pub(crate) tolerance: f64,
    /// Stop at this share of the way from the first f to the desired one, instead of at the
    /// tolerance; 0.95 is the paper's [default with --desired: 0.95]
    #[arg(long, value_name = "SHARE", help_heading = "Stopping", value_parser = fraction, allow_negative_numbers = true)]
    pub(crate) fraction: Option<f64>,
    /// The desired f by the first metric; auto finds the optimum before the run,
    /// in up to 5000 sweeps a try [default with
    /// --fraction: auto]
    #[arg(long, value_name = "F|auto", help_heading = "Stopping", value_parser = desired, allow_negative_numbers = true)]
    pub(crate) desired: Option<Desired>,

    /// Sweeps corrected from coarser levels of the mesh (imr, ar, rms and shape-size), over-relaxed sweeps, or the
    /// paper's plain ones (the same as relaxed --omega 1); auto takes the first that the other options allow
    #[arg(long, value_enum, default_value = "auto", help_heading = "Method")]
    pub(crate) method: MethodChoice,
    /// Over-relaxation factor, above 0 and below 2 [default: by metric, see `gpu-smooth metrics`; 1 if
    /// metrics alternate]
    #[arg(long, value_name = "W", help_heading = "Method", value_parser = omega, allow_negative_numbers = true)]
    pub(crate) omega: Option<f64>,
    /// Newton steps per visit of a vertex
    #[arg(long, default_value_t = 1, value_name = "N", help_heading = "Method", value_parser = clap::value_parser!(u32).range(1..=1000), allow_negative_numbers = true)]
    pub(crate) inner: u32,
    /// How metrics are differentiated; finite differences only serve to test the paper's cost model
    #[arg(long, value_enum, default_value = "analytic", help_heading = "Method")]
    pub(crate) derivatives: DerivativesChoice,
    /// Exponent of the p-norm Newton sees in place of edge: 16 throughout, or doubled from 2 to 512,
    /// which ends lower after more sweeps
    #[arg(long, value_enum, default_value = "fixed", help_heading = "Method")]
    pub(crate) edge_norm: EdgeNorm,

    /// Write a report with the history of every sweep, as JSON; if inverted or flat triangles keep the mesh from
    /// being smoothed, a list of them
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub(crate) report: Option<PathBuf>,
    /// What f the report's history holds: the first metric's, or every metric's
    #[arg(long, value_enum, default_value = "base", requires = "report", help_heading = "Output")]
    pub(crate) history: History,
    #[command(flatten)]
    pub(crate) picture: PictureArgs,
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

impl Cli {
    /// The command line, or the end of the process with what is wrong with it.
    pub(crate) fn read() -> Self {
        let matches = Self::command().try_get_matches();
        let matches = matches.unwrap_or_else(|error| one_mesh_only(error).exit());
        if let Some(text) = misplaced(&matches) {
            Self::command().error(ErrorKind::ArgumentConflict, text).exit();
        }
        let cli = Self::from_arg_matches(&matches).unwrap_or_else(|error| error.exit());
        if let Some((kept, dropped)) = cli.smooth.contradiction() {
            let text = format!("{kept} leaves nothing for {dropped} to choose: drop one of them");
            Self::command().error(ErrorKind::ArgumentConflict, text).exit();
        }
        cli
    }
}

/// The error if a command comes after arguments of a run.
fn misplaced(matches: &ArgMatches) -> Option<String> {
    let name = matches.subcommand_name()?;
    let command = Cli::command();
    let given = |arg: &&Arg| {
        let source = matches.value_source(arg.get_id().as_str());
        !arg.is_global_set() && source == Some(ValueSource::CommandLine)
    };
    let arg = command.get_arguments().find(given)?;
    Some(match arg.get_long() {
        Some(long) => {
            format!(
                "'--{long}' stands before the command '{name}': options of a command go after it"
            )
        }
        None => format!(
            "'{name}' is a command here, and takes no mesh before it; a file of that name is ./{name}"
        ),
    })
}

/// The error if a third file is given.
fn one_mesh_only(error: clap::Error) -> clap::Error {
    let is_command = |arg: &OsString| Cli::command().find_subcommand(arg).is_some();
    match error.get(ContextKind::InvalidArg) {
        Some(ContextValue::String(extra))
            if error.kind() == ErrorKind::UnknownArgument
                && !extra.starts_with('-')
                && !std::env::args_os().skip(1).any(|arg| is_command(&arg)) =>
        {
            let text =
                format!("unexpected argument '{extra}' after IN and OUT: give one mesh a run");
            Cli::command().error(ErrorKind::UnknownArgument, text)
        }
        _ => error,
    }
}

impl SmoothArgs {
    /// An option given along with another that settles the same.
    fn contradiction(&self) -> Option<(&str, &str)> {
        if self.method == MethodChoice::Paper && self.omega.is_some() {
            Some(("--method paper", "--omega"))
        } else if self.method == MethodChoice::Multilevel && self.omega.is_some() {
            Some(("--method multilevel", "--omega"))
        } else if self.engine == EngineChoice::Cpu && self.adapter.is_some() {
            Some(("--engine cpu", "--adapter"))
        } else {
            None
        }
    }

    /// What the library is asked to do.
    /// The options of a run on a mesh that is stored with so many digits.
    pub(crate) fn options(&self, stored: Precision) -> Options {
        let has_goal = self.fraction.is_some() || self.desired.is_some();
        Options {
            scheme: self.scheme.clone(),
            max_sweeps: self.max_sweeps,
            tolerance: self.tolerance,
            stored,
            goal: has_goal.then(|| Goal {
                fraction: self.fraction.unwrap_or(0.95),
                desired: self.desired.unwrap_or(Desired::Auto),
            }),
            method: match self.method {
                MethodChoice::Auto => Method::Auto,
                MethodChoice::Multilevel => Method::Multilevel,
                MethodChoice::Relaxed | MethodChoice::Paper => Method::Sweeps,
            },
            omega: match self.method {
                MethodChoice::Paper => Some(1.0),
                _ => self.omega,
            },
            inner: self.inner,
            derivatives: match self.derivatives {
                DerivativesChoice::Analytic => Derivatives::Analytic,
                DerivativesChoice::FiniteDifference => Derivatives::FiniteDifference,
            },
            sharpness: match self.edge_norm {
                EdgeNorm::Fixed => Sharpness::FIXED,
                EdgeNorm::Continued => Sharpness::CONTINUED,
            },
            track_all: self.history == History::All,
            ..Options::default()
        }
    }
}

/// Parses a number and refuses those for which `fits` does not hold.
fn number(text: &str, fits: impl Fn(f64) -> bool, range: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| format!("not a number; it must be {range}"))?;
    if fits(value) { Ok(value) } else { Err(format!("it must be {range}")) }
}

fn tolerance(text: &str) -> Result<f64, String> {
    number(text, |t| t >= 0.0 && t.is_finite(), "0 or above")
}

fn fraction(text: &str) -> Result<f64, String> {
    number(text, |f| f > 0.0 && f <= 1.0, "above 0 and at most 1")
}

fn omega(text: &str) -> Result<f64, String> {
    number(text, |w| w > 0.0 && w < 2.0, "above 0 and below 2")
}

fn seconds(text: &str) -> Result<f64, String> {
    number(text, |s| s >= 0.0 && s.is_finite(), "0 or above")
}

fn vertices(text: &str) -> Result<usize, String> {
    let range = "a number of vertices from 9 to 100000000";
    let value = text.trim().parse().map_err(|_| range.to_owned())?;
    if (9..=100_000_000).contains(&value) { Ok(value) } else { Err(format!("it must be {range}")) }
}

fn desired(text: &str) -> Result<Desired, String> {
    match text {
        "auto" => Ok(Desired::Auto),
        _ => number(text, f64::is_finite, "a value of f, or auto").map(Desired::Value),
    }
}
