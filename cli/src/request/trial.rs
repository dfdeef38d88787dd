//! The runs of `gpu-smooth try`, with command lines: three runs for each target, two of which improve the worst triangles.

use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};

use clap::error::ErrorKind;
use clap::parser::ValueSource;
use clap::{ArgAction, ArgMatches, Command, CommandFactory};
use gpu_smooth::Metric;

use crate::args::Cli;
use crate::request::command_line::checked;
use crate::request::smooth::{RunExtent, SmoothRequest};
use crate::terminal::process;

/// Options of the tried runs, by target. Metrics such as `shape-size` are left out: they even out the sizes of triangles,
/// and so remove the refinement of a coast or an airfoil.
const ROWS: [&[&str]; 9] = [
    &[],
    &["--improve-worst"],
    &["--improve-worst=min-angle"],
    &["--target", "keep-size"],
    &["--target", "keep-size", "--improve-worst"],
    &["--target", "keep-size", "--improve-worst=min-angle"],
    &["--target", "keep-shape"],
    &["--target", "keep-shape", "--improve-worst"],
    &["--target", "keep-shape", "--improve-worst=min-angle"],
];

/// Further options for a profile that needs acute triangles, which the targets of [`ROWS`] do not make.
const ROWS_OF_ACUTE: [&[&str]; 2] = [
    &["--target", "keep-size", "--scheme", "acute-size"],
    &["--target", "keep-size", "--scheme", "acute-size", "--improve-worst"],
];

/// A run to try.
pub(crate) struct TrialRun {
    /// Options for the target and the worst triangles.
    pub(crate) options: &'static [&'static str],
    /// The words of the command line of the run, the name of the program first.
    pub(crate) words: Vec<OsString>,
    pub(crate) request: SmoothRequest,
}

impl TrialRun {
    /// Returns the runs for the command line of this process.
    ///
    /// # Errors
    /// Returns an error if an option of all runs contradicts another option.
    pub(crate) fn of_command_line(mesh: &Path) -> Result<Vec<Self>, clap::Error> {
        let program = Cli::command();
        let matches = program.clone().try_get_matches_from(process::command_line())?;
        let common = match (program.find_subcommand("try"), matches.subcommand_matches("try")) {
            (Some(command), Some(matches)) => words_of(command, matches),
            _ => Vec::new(),
        };
        Self::of_options(mesh, &common)
    }

    /// Returns the runs with the options `common`.
    fn of_options(mesh: &Path, common: &[OsString]) -> Result<Vec<Self>, clap::Error> {
        let row = |options: &'static [&'static str]| {
            let mut words: Vec<OsString> =
                vec!["gpu-smooth".into(), mesh.into(), output(mesh).into()];
            words.extend(options.iter().map(OsString::from));
            words.extend_from_slice(common);
            let mut request = SmoothRequest::new(checked(words.clone())?.smooth)
                .map_err(|error| Cli::command().error(ErrorKind::ArgumentConflict, error))?;
            request.extent = RunExtent::Unwritten;
            Ok::<_, clap::Error>(Self { options, words, request })
        };
        let mut runs = ROWS.into_iter().map(row).collect::<Result<Vec<_>, _>>()?;
        let profile = runs.first().and_then(|run| run.request.profile.as_ref());
        if profile.is_some_and(|profile| profile.scheme == Some(Metric::Acute)) {
            runs.extend(ROWS_OF_ACUTE.into_iter().map(row).collect::<Result<Vec<_>, _>>()?);
        }
        Ok(runs)
    }
}

/// Returns the options of a parsed command as words of a command line, without options of the command alone and of the
/// program.
fn words_of(command: &Command, matches: &ArgMatches) -> Vec<OsString> {
    let mut words = Vec::new();
    for arg in command.get_arguments() {
        let id = arg.get_id().as_str();
        let is_given = matches.value_source(id) == Some(ValueSource::CommandLine);
        let Some(long) = arg.get_long().filter(|long| is_given && *long != "json") else {
            continue;
        };
        let option = format!("--{long}");
        if matches!(arg.get_action(), ArgAction::SetTrue) {
            words.push(option.into());
            continue;
        }
        for value in matches.get_raw(id).into_iter().flatten() {
            // A value that begins with a hyphen must not look like an option.
            if value.as_encoded_bytes().starts_with(b"-") {
                let mut word = OsString::from(format!("{option}="));
                word.push(value);
                words.push(word);
            } else {
                words.extend([OsString::from(&option), value.to_owned()]);
            }
        }
    }
    words
}

/// Returns a path for the smoothed mesh: the path of the mesh with `-smooth` before the file extension.
fn output(mesh: &Path) -> PathBuf {
    let name = mesh.file_name().unwrap_or(OsStr::new("mesh"));
    let packed = [".gz", ".zst"].into_iter().find(|end| mesh.to_string_lossy().ends_with(end));
    let bare = if packed.is_some() { Path::new(name).with_extension("") } else { name.into() };
    let mut smooth = bare.file_stem().unwrap_or_default().to_owned();
    smooth.push("-smooth");
    if let Some(ending) = bare.extension() {
        smooth.push(".");
        smooth.push(ending);
    }
    smooth.push(packed.unwrap_or_default());
    mesh.with_file_name(smooth)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_smoothed_mesh_has_a_name_of_its_own_in_the_same_format() {
        for (mesh, expected) in [
            ("a/coast.gr3", "a/coast-smooth.gr3"),
            ("la.1.node", "la.1-smooth.node"),
            ("part", "part-smooth"),
            ("big.msh.gz", "big-smooth.msh.gz"),
        ] {
            assert_eq!(output(Path::new(mesh)), Path::new(expected));
        }
    }

    #[test]
    fn options_of_all_runs_are_in_the_command_line_of_each_run() {
        let program = Cli::command();
        let line = "gpu-smooth try in.msh --json --slide --corner-angle 30 --fix a,b --fix c --fix-box -1,0,1,1";
        let matches = program.clone().try_get_matches_from(line.split(' ')).unwrap();
        let command = program.find_subcommand("try").unwrap();
        let words = words_of(command, matches.subcommand_matches("try").unwrap());
        let mut words: Vec<_> = words.iter().map(|word| word.to_str().unwrap()).collect();
        let runs = TrialRun::of_options(
            Path::new("in.msh"),
            &words.iter().map(OsString::from).collect::<Vec<_>>(),
        );
        for run in runs.unwrap() {
            assert_eq!(run.request.slide.as_ref().unwrap().corner_angle, 30.0);
            assert_eq!(run.request.movable.fix, ["a,b", "c"]);
            assert_eq!(run.request.movable.fix_box, [[[-1.0, 0.0], [1.0, 1.0]]]);
            assert!(!run.words.contains(&"--json".into()));
        }
        words.sort_unstable();
        let mut expected = "--slide --corner-angle 30 --fix a,b --fix c --fix-box=-1,0,1,1"
            .split(' ')
            .collect::<Vec<_>>();
        expected.sort_unstable();
        assert_eq!(words, expected);
    }
}
