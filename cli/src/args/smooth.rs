//! The options of `gpu-smooth IN OUT`.

use std::path::PathBuf;

use clap::{ArgGroup, Args};

use gpu_smooth_job::TargetKind;

use crate::args::names;
use crate::args::table::{OfRun, TableArgs};
use crate::args::{FieldArgs, FormArgs, MoveArgs, PictureArgs, ReadArgs, SideArgs, TargetArgs};
use crate::profiles::ProfileSource;

#[derive(Args)]
#[command(group = ArgGroup::new("drawing").args(["picture", "html"]).multiple(true))]
#[command(group = ArgGroup::new("kept").args(["checkpoint", "continued"]).multiple(true))]
#[command(mut_arg("checkpoint-every", |every| every.requires("kept")))]
#[command(mut_arg("history", |history| history.requires("report")))]
pub(crate) struct SmoothArgs {
    /// Mesh to read; the format is detected from its content. It may be compressed by gzip or zstd; - reads standard
    /// input
    #[arg(required = true, value_name = "IN")]
    pub(crate) input: Option<PathBuf>,
    /// File for the smoothed mesh, which may be IN itself. OUT has the format of IN, unless its ending belongs to another format.
    /// The file is compressed if its name ends in .gz or .zst; - writes to standard output
    #[arg(required_unless_present = "out_dir", value_name = "OUT")]
    pub(crate) output: Option<PathBuf>,
    /// Further meshes, with --out-dir
    #[arg(hide = true, value_name = "MESH")]
    pub(crate) more: Vec<PathBuf>,

    #[command(flatten)]
    pub(crate) options: TableArgs<OfRun>,

    /// Smooth for a solver, or for a TOML file of limits: by the metric of the profile, unless --scheme or --target is given.
    /// The summary ends with a table of the limits before and after the run. docs/solvers.md has all limits
    #[arg(
        long = "for",
        value_name = "NAME|FILE",
        value_parser = names::profiles(),
        help_heading = "Quality"
    )]
    pub(crate) profile: Option<ProfileSource>,

    /// Exit with 1 if the run neither converges nor reaches its goal. The mesh is written all the same
    #[arg(long, help_heading = "Stopping")]
    pub(crate) strict: bool,
    /// Save the state of the run to FILE every five minutes, and when Ctrl-C or --time-limit ends it. FILE is removed once a run has
    /// come to its end. OUT must be another file than IN
    #[arg(long, value_name = "FILE", help_heading = "Stopping", conflicts_with = "out_dir")]
    pub(crate) checkpoint: Option<PathBuf>,
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

    #[command(flatten)]
    pub(crate) target: TargetArgs,

    #[command(flatten)]
    pub(crate) reading: ReadArgs,

    #[command(flatten)]
    pub(crate) moving: MoveArgs,

    #[command(flatten)]
    pub(crate) sides: SideArgs,

    #[command(flatten)]
    pub(crate) fields: FieldArgs,

    /// If a mesh cannot be untangled, write the best mesh found all the same. The exit code is 1. A mesh whose boundary crosses
    /// itself is untangled as far as its triangles go, and is not refused
    #[arg(long, requires = "untangle", help_heading = "Untangling")]
    pub(crate) keep_going: bool,

    /// Read and check the mesh and the options, and print how many vertices would move, which are fixed for which reason,
    /// and the engine. Neither smooth nor write anything
    #[arg(long, help_heading = "Output", conflicts_with = "out_dir")]
    pub(crate) dry_run: bool,
    /// Replace OUT even if OUT holds another mesh than IN, or no mesh. Without --force, OUT must be new or empty, be IN
    /// itself, or hold a mesh with the triangles and the fixed vertices of IN, and reports, pages and pictures replace
    /// those of earlier runs only
    #[arg(long, help_heading = "Output")]
    pub(crate) force: bool,
    /// Write a JSON report with the history of every sweep and a certificate: the written mesh is read again, the
    /// statements of `gpu-smooth compare` are proved for it, and both files are hashed. If inverted or flat triangles
    /// prevent smoothing, the report lists them. docs/report.md describes the keys
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub(crate) report: Option<PathBuf>,
    /// Write a page for a browser, in one file that needs nothing else: the mesh before and after, which can be enlarged,
    /// histograms, f by sweep and time, statistics, the worst triangles
    #[arg(long, value_name = "FILE", help_heading = "Output", conflicts_with = "out_dir")]
    pub(crate) html: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) picture: PictureArgs,

    #[command(flatten)]
    pub(crate) form: FormArgs,

    /// Smooth all given meshes, each into a file of the same name in the directory DIR, created if missing. With
    /// --to, the names get the ending of the format. Small
    /// meshes are smoothed concurrently; a failed mesh does not stop the rest
    #[arg(long, value_name = "DIR", help_heading = "Many meshes", conflicts_with = "picture")]
    pub(crate) out_dir: Option<PathBuf>,
    /// Skip meshes whose smoothed files are all in DIR and newer than the mesh. Files that a mesh file names are not looked
    /// at, but for an XDMF's .h5 of the same name
    #[arg(long, requires = "out_dir", help_heading = "Many meshes", conflicts_with = "keep_going")]
    pub(crate) resume: bool,
    /// Print the table of the meshes as CSV
    #[arg(long, requires = "out_dir", help_heading = "Many meshes", conflicts_with = "json")]
    pub(crate) csv: bool,
    /// Print the table of the meshes as JSON
    #[arg(long, requires = "out_dir", help_heading = "Many meshes")]
    pub(crate) json: bool,
}

impl SmoothArgs {
    /// Sets the scheme to the metric of the profile, unless a scheme or a target is given. A profile that cannot be read
    /// changes nothing here, as the request reads it again and returns the error.
    pub(crate) fn take_metric_of_profile(&mut self) {
        let is_free = self.target.kind() == TargetKind::Equilateral && !self.options.has("scheme");
        let profile = self.profile.as_ref().filter(|_| is_free);
        let metric = profile.and_then(|profile| profile.read().ok()?.scheme);
        if let Some(metric) = metric {
            self.options.set("scheme", metric.name());
        }
    }
}
