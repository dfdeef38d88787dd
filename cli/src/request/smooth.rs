//! The request for a run on one mesh or several meshes.

use std::path::PathBuf;
use std::time::Duration;

use gpu_smooth::{Guard, Options, Scheme, Stopping, options::Precision, targets::Surface};
use gpu_smooth_job::EngineRequest;
use gpu_smooth_job::options::GivenOptions;

use crate::args::SmoothArgs;
use crate::error::CliError;
use crate::profiles::{Profile, ProfileSource};
use crate::request::form::FormRequest;
use crate::request::movable::{FieldsRequest, MovableRequest, SlideRequest};
use crate::request::outputs::Outputs;
use crate::request::read::ReadRequest;
use crate::request::target::{TargetRequest, ThirdCoordinate};

/// A run on one mesh, or equal runs on many meshes.
pub(crate) struct SmoothRequest {
    pub(crate) meshes: Meshes,
    pub(crate) reading: ReadRequest,
    /// The surface on which coordinates lie.
    pub(crate) surface: Surface,
    /// The meaning of third coordinates.
    pub(crate) z: ThirdCoordinate,
    pub(crate) target: TargetRequest,
    pub(crate) movable: MovableRequest,
    /// Options of sliding vertices; `None` if no vertex slides.
    pub(crate) slide: Option<SlideRequest>,
    pub(crate) fields: FieldsRequest,
    pub(crate) engine: EngineRequest,
    /// The options of the table that the command line has.
    pub(crate) given: GivenOptions,
    /// The options of the library, for coordinates in double precision.
    run: Options,
    /// The time after which the run ends, counted from the start of reading the mesh.
    pub(crate) time_limit: Option<Duration>,
    /// The treatment of a mesh with inverted or flat triangles; `None` if the mesh is refused.
    pub(crate) untangle: Option<UntangleRequest>,
    /// The checkpoint from which the run continues.
    pub(crate) continue_from: Option<PathBuf>,
    /// Whether a run that neither converges nor reaches its goal is an error.
    pub(crate) is_strict: bool,
    pub(crate) extent: RunExtent,
    /// The limits with which the mesh is compared before and after the run.
    pub(crate) profile: Option<Profile>,
    /// The format of the written mesh.
    pub(crate) form: FormRequest,
    pub(crate) outputs: Outputs,
}

/// The part of a run that is carried out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum RunExtent {
    /// The mesh is smoothed and written.
    Whole,
    /// The mesh is smoothed, and no file is written.
    Unwritten,
    /// The run ends before its first sweep, and no file is written.
    Prepared,
}

/// The meshes of a request.
pub(crate) enum Meshes {
    One { input: PathBuf, output: PathBuf },
    Many(Batch),
}

/// Many meshes, each smoothed into a file of its name.
pub(crate) struct Batch {
    pub(crate) inputs: Vec<PathBuf>,
    /// The directory of the results.
    pub(crate) directory: PathBuf,
    /// Whether a mesh is skipped if its result files are all newer than the mesh.
    pub(crate) skips_done: bool,
    pub(crate) table: TableForm,
}

/// The format of the printed table of many meshes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum TableForm {
    Text,
    Csv,
    Json,
}

/// Options of untangling a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct UntangleRequest {
    /// Whether the best mesh found is written if inverted triangles remain.
    pub(crate) keeps_going: bool,
}

impl SmoothRequest {
    /// Returns the request for options without conflicts.
    ///
    /// # Errors
    /// Returns a usage error if IN or OUT is missing, or if the picture's extension is unknown. Returns an input error if
    /// the file of a profile cannot be read.
    pub(crate) fn new(args: SmoothArgs) -> Result<Self, CliError> {
        let outputs = Outputs::of_run(&args)?;
        let settings = args.options.settings();
        let run = settings.run.options(args.target.kind().default_metric(), Precision::Double);
        let (given, more) = (args.input.into_iter().chain(args.output), args.more);
        let meshes = match (args.out_dir, given.collect::<Vec<_>>()) {
            (Some(directory), mut inputs) => {
                inputs.extend(more);
                let table = match (args.csv, args.json) {
                    (_, true) => TableForm::Json,
                    (true, false) => TableForm::Csv,
                    (false, false) => TableForm::Text,
                };
                Meshes::Many(Batch { inputs, directory, skips_done: args.resume, table })
            }
            (None, given) => match <[PathBuf; 2]>::try_from(given) {
                Ok([input, output]) => Meshes::One { input, output },
                Err(_) => return Err(CliError::usage("IN and OUT are needed")),
            },
        };
        Ok(Self {
            meshes,
            reading: ReadRequest::from(&args.reading).moving(args.moving.quadrilaterals),
            form: (&args.form).into(),
            surface: settings.surface,
            z: ThirdCoordinate::of(settings, &args.fields.interpolate),
            target: TargetRequest::of(&args.target, settings),
            movable: MovableRequest::of(args.moving, settings).keeping_layers(),
            slide: SlideRequest::of(args.sides, settings),
            fields: args.fields.into(),
            engine: settings.engine(),
            given: GivenOptions::clone(&args.options),
            run,
            time_limit: settings.time_limit,
            untangle: settings
                .untangles
                .then_some(UntangleRequest { keeps_going: args.keep_going }),
            continue_from: args.continued,
            is_strict: args.strict,
            extent: match args.dry_run {
                true => RunExtent::Prepared,
                false => RunExtent::Whole,
            },
            profile: args.profile.as_ref().map(ProfileSource::read).transpose()?,
            outputs,
        })
    }

    /// Returns the scheme: the metrics of the sweeps.
    pub(crate) fn scheme(&self) -> &Scheme {
        &self.run.scheme
    }

    /// Returns the largest number of sweeps.
    pub(crate) fn max_sweeps(&self) -> u32 {
        self.run.max_sweeps
    }

    /// Returns whether the guard bounds every triangle by the worst one of IN.
    pub(crate) fn guards_worst(&self) -> bool {
        self.run.guard == Guard::Worst
    }

    /// Returns whether the history of a report has the objectives of all metrics.
    pub(crate) fn tracks_all(&self) -> bool {
        self.run.track_all
    }

    /// Returns `--tolerance` if it ends the run, `None` with `--fraction` or `--desired`. The time display
    /// extrapolates to the tolerance.
    pub(crate) fn estimated_end(&self) -> Option<f64> {
        match self.run.stopping {
            Stopping::Tolerance(tolerance) => Some(tolerance),
            _ => None,
        }
    }

    /// Returns the options of a run on a mesh whose file stores coordinates with precision `stored`.
    pub(crate) fn options(&self, stored: Precision) -> Options {
        self.run.clone().stored(stored)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::args::Cli;
    use crate::request::target::TargetSource;
    use clap::Parser;
    use std::path::Path;

    /// Returns the request of a command line without the name of the program.
    fn request(words: &str) -> Result<SmoothRequest, CliError> {
        let words = std::iter::once("gpu-smooth").chain(words.split_whitespace());
        SmoothRequest::new(Cli::try_parse_from(words).unwrap().smooth)
    }

    #[test]
    fn an_adapter_stands_for_the_engine_gpu() {
        let engine = |words: &str| request(&format!("in out {words}")).unwrap().engine;
        let gpu =
            |adapter: Option<&str>| EngineRequest::Gpu { adapter: adapter.map(str::to_owned) };
        assert_eq!(engine(""), EngineRequest::Auto);
        assert_eq!(engine("--engine cpu"), EngineRequest::Cpu);
        assert_eq!(engine("--engine gpu"), gpu(None));
        assert_eq!(engine("--adapter llvm"), gpu(Some("llvm")));
        assert_eq!(engine("--engine gpu --adapter llvm"), gpu(Some("llvm")));
    }

    #[test]
    fn a_continued_run_saves_its_state_to_the_same_file_unless_another_is_named() {
        let file = |words: &str| {
            let plan = request(&format!("in out {words}")).unwrap().outputs.checkpoint;
            plan.map(|plan| (plan.file.display().to_string(), plan.every.as_secs()))
        };
        assert_eq!(file(""), None);
        assert_eq!(file("--continue a"), Some(("a".into(), 300)));
        assert_eq!(file("--continue a --checkpoint b --checkpoint-every 9"), Some(("b".into(), 9)));
    }

    #[test]
    fn one_mesh_has_a_file_and_many_have_a_directory() {
        let Meshes::One { input, output } = request("a b").unwrap().meshes else { panic!() };
        assert_eq!([input, output], ["a", "b"].map(PathBuf::from));
        let Meshes::Many(batch) = request("a b c --out-dir d --csv").unwrap().meshes else {
            panic!()
        };
        assert_eq!(batch.inputs, ["a", "b", "c"].map(PathBuf::from));
        assert_eq!((batch.directory.as_path(), batch.table), (Path::new("d"), TableForm::Csv));
        assert!(!batch.skips_done);
        let refused = request("a b --picture p.bmp").err().unwrap();
        assert_eq!(refused.kind, crate::error::ErrorKind::Usage);
    }

    #[test]
    fn the_source_of_a_target_is_found_by_the_files_that_exist() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name).display().to_string();
        for name in ["back.msh", "view.pos", "odd:name.sol"] {
            std::fs::write(folder.path().join(name), "any").unwrap();
        }
        let target =
            |source: String| request(&format!("in out --target size={source}")).unwrap().target;
        for (text, is_of_places) in [
            (format!("{}:h", path("back.msh")), true),
            (path("view.pos"), true),
            (path("odd:name.sol"), false),
        ] {
            let target = target(text.clone());
            assert_eq!(
                (target.is_of_places(), target.name()),
                (is_of_places, format!("size={text}"))
            );
            assert_eq!(target.files().len(), 1, "{text}");
        }
        let given = target(format!("{}:h", path("back.msh"))).given.unwrap();
        let TargetSource::Background { mesh, data } = given.source else { panic!() };
        assert_eq!((mesh, data.as_str()), (folder.path().join("back.msh"), "h"));
    }
}
