//! Tests of the `gpu-smooth` command as a process, judged by its output and files.

mod adapters;
mod arguments;
mod bench;
mod browser;
mod compare;
mod convert;
mod converted;
mod destinations;
#[cfg(unix)]
mod documented;
#[cfg(target_os = "linux")]
mod drivers;
mod dry_run;
mod ends;
mod files;
mod formats;
mod free_lines;
mod groups;
mod html;
mod interpolate;
mod interrupt;
mod jobs;
mod killed;
mod layers;
mod limits;
mod long;
mod many;
mod moving;
mod nets;
mod options;
mod output;
mod outside;
mod overwrite;
mod periodic;
mod picture;
mod planes;
mod plate;
mod progress;
mod quadrilaterals;
mod quality;
mod refusals;
mod regions;
mod report;
mod schemes;
mod shell;
mod slide;
mod slide_agreement;
mod sphere;
mod streams;
mod targets;
mod trial;
mod untangle;
mod weirs;
mod worst;

use gpu_smooth::Mesh;
use serde_json::Value;
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use support::check;
use tempfile::TempDir;

/// The exit code and output of a finished process.
struct Run {
    code: Option<i32>,
    out: String,
    err: String,
}

impl Run {
    /// Checks that the run succeeded, and printed nothing but progress to standard error. Slow machines print progress.
    #[track_caller]
    fn clean(self) -> Self {
        let remarks: Vec<&str> = self.err.lines().filter(|line| !is_progress(line)).collect();
        assert_eq!((self.code, &remarks[..]), (Some(0), &[][..]), "{}", self.out);
        self
    }

    /// Checks that the run failed, though its command line is right by itself, with one line that contains all parts. An
    /// indented list may follow the line.
    #[track_caller]
    fn refused(self, parts: &[&str]) -> Self {
        self.refused_with(&[1, 3, 4, 5], parts)
    }

    /// Checks that the run was refused as in [`refused`](Self::refused), but because of its command line alone.
    #[track_caller]
    fn misused(self, parts: &[&str]) -> Self {
        self.refused_with(&[2], parts)
    }

    #[track_caller]
    fn refused_with(self, expected: &[i32], parts: &[&str]) -> Self {
        let Self { code, out, err } = &self;
        assert!(code.is_some_and(|code| expected.contains(&code)), "{code:?}: {err}");
        assert_eq!(out, "", "{err}");
        assert!(err.starts_with("gpu-smooth: error: "), "{err}");
        assert!(err.lines().skip(1).all(|line| line.starts_with("  ")), "{err}");
        assert_holds(err, parts);
        self
    }
}

/// Returns whether a line on standard error reports progress.
fn is_progress(line: &str) -> bool {
    let starts = [
        "reading",
        "preparing",
        "smoothing",
        "writing",
        "drawing",
        "sweep ",
        "finding the optimum: ",
    ];
    let text = line.strip_prefix("gpu-smooth: ").unwrap_or_default();
    starts.iter().any(|start| text.starts_with(start))
}

#[track_caller]
fn assert_holds(text: &str, parts: &[&str]) {
    for part in parts {
        assert!(text.contains(part), "no {part:?} in:\n{text}");
    }
}

fn command() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_gpu-smooth"));
    // Without the variable, some drivers print a complaint to standard error.
    command.env("XDG_RUNTIME_DIR", std::env::temp_dir()).stdin(Stdio::null());
    command
}

fn finish(command: &mut Command) -> Run {
    let output = command.output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    Run { code: output.status.code(), out: text(output.stdout), err: text(output.stderr) }
}

/// A temporary folder of a test, in which the command runs.
struct Folder(TempDir);

impl Folder {
    fn new(files: &[(&str, &str)]) -> Self {
        let folder = Self(TempDir::new().unwrap());
        for (name, text) in files {
            fs::write(folder.path(name), text).unwrap();
        }
        folder
    }

    /// Returns a new folder with the files of this one.
    fn copy(&self) -> Self {
        let folder = Self(TempDir::new().unwrap());
        for (path, bytes) in self.content() {
            fs::write(folder.0.path().join(path.file_name().unwrap()), bytes).unwrap();
        }
        folder
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn text(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap()
    }

    fn mesh(&self, name: &str) -> Mesh {
        support::read_mesh(&self.path(name))
    }

    fn json(&self, name: &str) -> Value {
        serde_json::from_str(&self.text(name)).unwrap()
    }

    fn command(&self) -> Command {
        let mut command = command();
        command.current_dir(&self.0);
        command
    }

    fn run<S: AsRef<OsStr>>(&self, args: impl IntoIterator<Item = S>) -> Run {
        finish(self.command().args(args))
    }

    /// Runs the command with these arguments, separated by spaces.
    fn line(&self, args: &str) -> Run {
        self.run(args.split_whitespace())
    }

    /// Returns the paths and bytes of all files in the folder.
    fn content(&self) -> Vec<(PathBuf, Vec<u8>)> {
        let mut files: Vec<_> = fs::read_dir(&self.0)
            .unwrap()
            .map(|entry| entry.unwrap().path())
            .map(|path| (path.clone(), fs::read(&path).unwrap_or_default()))
            .collect();
        files.sort();
        files
    }
}

/// Returns a small mesh with most vertices randomly displaced.
fn disturbed() -> Mesh {
    let mut mesh = support::lattice(10, 8);
    // Flattened, so that the optimum is not a mesh of equilateral triangles.
    mesh.points.iter_mut().for_each(|point| point[1] *= 0.625);
    support::perturb_random(&mesh, 1.0, 5)
}

/// A folder with the small mesh of [`disturbed`], as `in.node` and `in.ele`.
fn small() -> Folder {
    let [node, ele] = support::triangle_text(&disturbed(), "made for a test");
    Folder::new(&[("in.node", &node), ("in.ele", &ele)])
}

/// Checks that `after` is a smoothed state of `before`: equal triangles, bit-identical held vertices, no inverted or
/// flat triangle, no fold, and some moved vertex.
#[track_caller]
fn assert_smoothed(before: &Mesh, after: &Mesh) {
    assert_eq!((&before.triangles, &before.fixed), (&after.triangles, &after.fixed));
    assert!(check::same_orientations(before, after) && check::is_valid(after));
    assert_ne!(before.points, after.points);
    let bits = |mesh: &Mesh, v: usize| mesh.points[v].map(f64::to_bits);
    for (v, held) in check::held(before).into_iter().enumerate() {
        assert!(!held || bits(before, v) == bits(after, v), "vertex index {v} has moved");
    }
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is not a number"))
}

fn plate_path() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../meshes/plate.node"))
}
