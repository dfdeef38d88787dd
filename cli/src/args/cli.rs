//! The command line: its commands and options.

use std::path::PathBuf;

use clap::{Args, CommandFactory, Parser, Subcommand, ValueEnum};
use clap_complete::Shell;

use crate::args::names;
use crate::args::table::{OfComparison, TableArgs};
use crate::args::{
    BenchArgs, FieldArgs, FormArgs, MoveArgs, QualityArgs, ReadArgs, SideArgs, SmoothArgs, TryArgs,
};

/// Smooths a 2D mesh of triangles and quadrilaterals: moves interior vertices so that elements get better shapes, and
/// never inverts one. OUT differs from IN in the coordinates of moved vertices only.
#[derive(Parser)]
#[command(
    name = "gpu-smooth",
    version,
    subcommand_negates_reqs = true,
    override_usage = "gpu-smooth [OPTIONS] <IN> <OUT>\n       gpu-smooth [OPTIONS] <MESH>... --out-dir <DIR>\n       gpu-smooth <COMMAND>",
    arg_required_else_help = true,
    after_help = SHORT_HELP,
    after_long_help = after_help()
)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Option<Command>,
    #[command(flatten)]
    pub(crate) smooth: SmoothArgs,
    #[command(flatten)]
    pub(crate) output: OutputArgs,
}

/// Text below the options in the program's short help.
const SHORT_HELP: &str = "Examples:
  gpu-smooth coast.msh better.msh --picture better.png
  gpu-smooth quality better.msh

--help lists all options and the formats, and `gpu-smooth COMMAND -h` those of a command.";

/// Options of a run that the short help lists. Other options are in the long help.
const USUAL: [&str; 14] = [
    "input",
    "output",
    "scheme",
    "engine",
    "target",
    "slide",
    "fix",
    "only",
    "untangle",
    "interpolate",
    "report",
    "picture",
    "html",
    "out_dir",
];

/// Returns the definition of the command line with the short help of `-h`: usual options, each with its first sentence.
pub(crate) fn command() -> clap::Command {
    let first_sentence = |arg: clap::Arg| {
        let Some(help) = arg.get_help().map(ToString::to_string) else { return arg };
        let end = [". ", "; ", ": "].iter().filter_map(|end| help.find(end)).min();
        let first = help[..end.unwrap_or(help.len())].to_owned();
        arg.help(first).long_help(help)
    };
    let is_usual = |arg: &clap::Arg| USUAL.contains(&arg.get_id().as_str()) || arg.is_global_set();
    let mut program = Cli::command().mut_args(|arg| {
        let is_hidden = !is_usual(&arg);
        first_sentence(arg).hide_short_help(is_hidden)
    });
    let names: Vec<String> =
        program.get_subcommands().map(|command| command.get_name().to_owned()).collect();
    for name in names {
        program = program.mut_subcommand(name, |command| command.mut_args(first_sentence));
    }
    program
}

/// Returns the text below the options in the program's help.
fn after_help() -> String {
    format!(
        "Boundary vertices and those on constraint lines or between regions stay where they are, unless --slide is given. Formats, \
         as text or in binary: {}. STL needs --weld. Ctrl-C ends a run at the next sweep and writes the best mesh so far; a second \
         one ends it at once.\n\n{EXAMPLES}\n\n{EXIT_CODES}",
        names::formats()
    )
}

/// Runs and commands as a user types them.
const EXAMPLES: &str = "Examples:
  gpu-smooth coast.msh better.msh --picture better.png
  gpu-smooth part.1.node out.node --scheme edge+imr --report run.json
  gpu-smooth wing.su2 better.su2 --slide --fix airfoil
  gpu-smooth part.msh better.vtu --encoding compressed
  gpu-smooth *.msh --out-dir smoothed --resume
  gpu-smooth part.msh better.msh --html run.html
  gpu-smooth quality better.msh
  gpu-smooth bench";

/// The exit codes of all commands.
const EXIT_CODES: &str = "Exit codes:
  0    the command has done its work
  1    the result falls short: a value beyond --threshold, a mesh that stays tangled, files that differ, a failed run of several
  2    the command line is wrong
  3    a file that is read is missing or damaged, lacks a name, or has a mesh that cannot be smoothed
  4    a file cannot be written
  5    a GPU cannot be used, or has failed
  130  Ctrl-C ended the run (143: SIGTERM, 129: SIGHUP)";

/// Options of the amount and the form of messages, valid with every command.
#[derive(Args)]
pub(crate) struct OutputArgs {
    /// Print errors only; commands still print their answer
    #[arg(short, long, global = true, conflicts_with = "verbose", help_heading = "Output")]
    pub(crate) quiet: bool,
    /// Print every sweep of a run
    #[arg(short, long, global = true, help_heading = "Output")]
    pub(crate) verbose: bool,
    /// Form of messages on standard error: lines of text, or one JSON object per line
    #[arg(
        long,
        global = true,
        value_enum,
        default_value = "text",
        value_name = "FORM",
        help_heading = "Output"
    )]
    pub(crate) log: LogForm,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum LogForm {
    Text,
    Json,
}

/// Examples of `completions`, with the directories in which each shell looks for completions.
const COMPLETIONS: &str = "Examples:
  gpu-smooth completions bash > ~/.local/share/bash-completion/completions/gpu-smooth
  echo 'source <(gpu-smooth completions zsh)' >> ~/.zshrc
  gpu-smooth completions fish > ~/.config/fish/completions/gpu-smooth.fish";

#[derive(Subcommand)]
pub(crate) enum Command {
    /// Measures the element quality of meshes and lists the worst triangles
    #[command(after_help = "Examples:\n  \
        gpu-smooth quality coast.msh -m min-angle,skewness --picture coast.png\n  \
        gpu-smooth quality before.su2 after.su2 --csv\n  \
        gpu-smooth quality part.msh --threshold 'min-angle<20' --threshold 'size-ratio>4'")]
    Quality(QualityArgs),
    /// Smooths a mesh with several targets, without writing it, and prints a table of the results and the command of the
    /// best run
    #[command(after_help = "Examples:\n  \
        gpu-smooth try coast.msh\n  \
        gpu-smooth try wing.su2 --fix airfoil --slide --json")]
    Try(TryArgs),
    /// Lists the names in a mesh file that options accept: physical groups, markers, references, materials and the
    /// like, and data of vertices
    #[command(after_help = "Example:\n  gpu-smooth groups wing.su2")]
    Groups(GroupsArgs),
    /// Proves from two files of a mesh that only vertices which may move have moved, and that no triangle is inverted. Of
    /// files in different formats, only positions and elements are compared
    #[command(after_help = "Example:\n  gpu-smooth compare part.msh smooth.msh --only steel")]
    Compare(CompareArgs),
    /// Writes a mesh in another format; if that format cannot hold all of the mesh, lists the losses, and writes only
    /// with --lossy
    #[command(after_help = "Examples:\n  \
        gpu-smooth convert wing.su2 wing.vtu --encoding compressed\n  \
        gpu-smooth convert part.msh part.inp --lossy\n  \
        gpu-smooth convert bay.gr3 - --to gmsh22 > bay.msh")]
    Convert(ConvertArgs),
    /// Lists the GPU adapters of this machine, best first, and whether each is usable
    Adapters(AdaptersArgs),
    /// Explains what each metric measures and when to use it
    Metrics,
    /// Measures how fast this machine smooths: sweeps, bytes, and each kernel
    #[command(
        after_help = "Examples:\n  gpu-smooth bench\n  gpu-smooth bench coast.msh --scheme edge+imr --engine gpu"
    )]
    Bench(BenchArgs),
    /// Prints completions for a shell
    #[command(after_help = COMPLETIONS)]
    Completions(CompletionsArgs),
    /// Prints the manual page, or writes the pages of all commands into a directory
    #[command(
        after_help = "Examples:\n  gpu-smooth man | man -l -\n  gpu-smooth man ~/.local/share/man/man1"
    )]
    Man(ManArgs),
}

#[derive(Args)]
pub(crate) struct GroupsArgs {
    /// The mesh
    pub(crate) mesh: PathBuf,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) reading: ReadArgs,
}

#[derive(Args)]
pub(crate) struct CompareArgs {
    /// The mesh before
    pub(crate) before: PathBuf,
    /// The mesh after
    pub(crate) after: PathBuf,
    /// Vertices that may have moved, by the options of the run
    #[command(flatten)]
    pub(crate) moving: MoveArgs,
    #[command(flatten)]
    pub(crate) options: TableArgs<OfComparison>,
    #[command(flatten)]
    pub(crate) sides: SideArgs,
    #[command(flatten)]
    pub(crate) fields: FieldArgs,
    #[command(flatten)]
    pub(crate) reading: ReadArgs,
}

#[derive(Args)]
pub(crate) struct ConvertArgs {
    /// Mesh in any supported input format; - reads standard input
    #[arg(value_name = "IN")]
    pub(crate) input: PathBuf,
    /// File to write; its extension determines the format. - writes to standard output, with --to
    #[arg(value_name = "OUT")]
    pub(crate) output: PathBuf,
    #[command(flatten)]
    pub(crate) form: FormArgs,
    /// Replace OUT even if it holds another mesh than IN, or is no mesh
    #[arg(long)]
    pub(crate) force: bool,
    #[command(flatten)]
    pub(crate) reading: ReadArgs,
}

#[derive(Args)]
pub(crate) struct AdaptersArgs {
    /// List only the adapter that --adapter NAME takes
    pub(crate) name: Option<String>,
}

#[derive(Args)]
pub(crate) struct CompletionsArgs {
    /// The shell
    pub(crate) shell: Shell,
}

#[derive(Args)]
pub(crate) struct ManArgs {
    /// Directory for a page of the program and one of each command [default: the page of the program is printed]
    pub(crate) directory: Option<PathBuf>,
}
