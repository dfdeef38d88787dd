//! Files that a command writes, and checks of all their paths before any work.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use gpu_smooth::measure::Measure;
use gpu_smooth_job::{CheckpointFile, Occupant};
use mesh_io::{Format, atomic};

use crate::args::{PictureArgs, SmoothArgs};
use crate::color_scale::ColorScale;
use crate::error::{CliError, ErrorKind};
use crate::request::earlier_output;
use crate::request::picture::{self, PictureRequest};
use crate::request::target::TargetRequest;

/// How a command writes its mesh, which decides what the mesh may replace.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MeshOutput {
    /// A run on one mesh. The output may replace IN, unless the run saves checkpoints.
    Smoothed,
    /// Runs on many meshes may not replace an input mesh.
    OfMany,
    /// A conversion may not replace its input mesh.
    Converted,
    /// The command writes no mesh.
    None,
}

/// The purpose of a file beside the mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Role {
    Report,
    Picture,
    Page,
    Checkpoint,
}

/// All files that a command writes.
pub(crate) struct Outputs {
    pub(crate) mesh: MeshOutput,
    /// Whether the mesh may replace a file that holds another mesh, or no mesh, and files beside the mesh may replace files
    /// of another kind.
    pub(crate) replaces_any: bool,
    pub(crate) report: Option<PathBuf>,
    pub(crate) picture: Option<PictureRequest>,
    /// The page for a browser.
    pub(crate) page: Option<PathBuf>,
    /// The scale of colors in the picture, and on the page by the same measure.
    pub(crate) colors: ColorScale,
    pub(crate) checkpoint: Option<CheckpointFile>,
    /// Files that are read besides meshes, such as lists of vertices and sources of targets. No output may replace
    /// them.
    inputs: Vec<PathBuf>,
    /// The checkpoint from which a run continues. Only the new checkpoint may replace this file.
    continued: Option<PathBuf>,
}

impl Outputs {
    /// Returns outputs of nothing but a mesh.
    pub(crate) fn of_mesh(mesh: MeshOutput) -> Self {
        Self {
            mesh,
            replaces_any: false,
            report: None,
            picture: None,
            page: None,
            colors: ColorScale::usual(Measure::Shape),
            checkpoint: None,
            inputs: Vec::new(),
            continued: None,
        }
    }

    /// Returns the outputs of a run on one mesh or several meshes.
    ///
    /// # Errors
    /// A usage error if the extension of the picture's path is neither `.png` nor `.svg`, or if `--picture-range` is not in
    /// the range of the measure.
    pub(crate) fn of_run(args: &SmoothArgs) -> Result<Self, CliError> {
        let (checkpoint, continued) = (args.checkpoint.clone(), args.continued.clone());
        let colors = picture::colors(&args.picture)?;
        let mut inputs = args.moving.fix_vertices.clone();
        inputs.extend(TargetRequest::of(&args.target, args.options.settings()).files());
        Ok(Self {
            mesh: match args.out_dir {
                Some(_) => MeshOutput::OfMany,
                None => MeshOutput::Smoothed,
            },
            // With `--resume`, files in the directory are results of earlier runs.
            replaces_any: args.force || args.resume,
            report: args.report.clone(),
            picture: PictureRequest::of(&args.picture, colors)?,
            page: args.html.clone(),
            colors,
            checkpoint: CheckpointFile::of(
                checkpoint,
                continued,
                args.options.settings().checkpoint_every,
            ),
            inputs,
            continued: args.continued.clone(),
        })
    }

    /// Returns the outputs of a command that draws a picture and writes a page, but no mesh.
    ///
    /// # Errors
    /// A usage error if the extension of the picture's path is neither `.png` nor `.svg`, or if `--picture-range` is not in
    /// the range of the measure.
    pub(crate) fn of_drawings(
        args: &PictureArgs,
        page: Option<&PathBuf>,
    ) -> Result<Self, CliError> {
        let colors = picture::colors(args)?;
        let (picture, page) = (PictureRequest::of(args, colors)?, page.cloned());
        Ok(Self { picture, page, colors, ..Self::of_mesh(MeshOutput::None) })
    }

    /// Returns the paths of the files that a run writes beside its mesh.
    pub(crate) fn files_beside_mesh(&self) -> impl Iterator<Item = &Path> {
        self.beside_mesh().map(|(_, path)| path)
    }

    /// Lists the paths of the report, picture, page and checkpoint.
    fn beside_mesh(&self) -> impl Iterator<Item = (Role, &Path)> {
        let picture = self.picture.as_ref().map(|picture| &picture.path);
        let checkpoint = self.checkpoint.as_ref().map(|plan| &plan.file);
        let all = [
            (Role::Report, self.report.as_ref()),
            (Role::Picture, picture),
            (Role::Page, self.page.as_ref()),
            (Role::Checkpoint, checkpoint),
        ];
        all.into_iter().filter_map(|(role, path)| Some((role, path?.as_path())))
    }

    /// Checks all paths before a mesh is read. `read` and `written` are paths of meshes on the command line.
    ///
    /// # Errors
    /// Returns a [`Usage`](ErrorKind::Usage) error if a path has a wrong extension, or if an output would replace
    /// another file of the command. Returns an [`Output`](ErrorKind::Output) error if an output would replace a foreign
    /// file on disk, or cannot be written.
    pub(crate) fn check(&self, read: &[PathBuf], written: &[PathBuf]) -> Result<(), CliError> {
        self.check_names()?;
        self.check_files(read, written, ErrorKind::Usage)?;
        written.iter().try_for_each(|path| check_ending(path, self.mesh))?;
        written.iter().try_for_each(|path| check_folder(path))?;
        self.check_disk()
    }

    /// Checks that no file beside the mesh is a standard stream or has an extension of a mesh format, and that the page
    /// ends in `.html` or `.htm`.
    pub(crate) fn check_names(&self) -> Result<(), CliError> {
        for (role, path) in self.beside_mesh() {
            if path.as_os_str() == "-" {
                let text = "-: only a mesh is written to standard output";
                return Err(CliError::usage(text).with_remedy(role.remedy()));
            }
            if role == Role::Page && !is_page(path) {
                let text = format!("{}: a page is HTML", path.display());
                return Err(CliError::usage(text).with_remedy("End its name in .html"));
            }
            if is_named_like_a_mesh(path) {
                return Err(role.is_no_mesh(path, ErrorKind::Usage));
            }
        }
        Ok(())
    }

    /// Checks that no output replaces a file that is read, nor another output. Before the mesh is read, `read` and
    /// `written` are the paths on the command line; afterwards, all files of the mesh.
    ///
    /// # Errors
    /// Returns an error of kind `kind` for the first conflict between paths.
    pub(crate) fn check_files(
        &self,
        read: &[PathBuf],
        written: &[PathBuf],
        kind: ErrorKind,
    ) -> Result<(), CliError> {
        self.check_files_of(self.mesh, read, written, kind)
    }

    /// Checks files as [`check_files`](Self::check_files) does, for a mesh that is written as `mesh`.
    pub(crate) fn check_files_of(
        &self,
        mesh: MeshOutput,
        read: &[PathBuf],
        written: &[PathBuf],
        kind: ErrorKind,
    ) -> Result<(), CliError> {
        let meshes: Vec<&Path> = read.iter().chain(written).map(PathBuf::as_path).collect();
        let mut taken: Vec<&Path> = self.inputs.iter().map(PathBuf::as_path).collect();
        for (role, path) in self.beside_mesh() {
            let replaces = |others: &[&Path]| others.iter().any(|own| is_same(own, path));
            let continued = self.continued.as_deref().filter(|_| role != Role::Checkpoint);
            if replaces(&meshes) {
                return Err(role.is_no_mesh(path, kind));
            }
            if replaces(&taken) || continued.is_some_and(|own| is_same(own, path)) {
                return Err(role.would_replace(path, kind));
            }
            taken.push(path);
        }
        let own = written.iter().find(|path| read.iter().any(|own| is_same(own, path)));
        match own.and_then(|path| self.mesh_in_place(mesh, path, kind)) {
            Some(error) => Err(error),
            None => Ok(()),
        }
    }

    /// Checks that OUT equals IN if OUT is a file of the mesh: users who name two files of one mesh may mistake them
    /// for two meshes. `files` lists all files of the mesh, the main file first.
    ///
    /// # Errors
    /// Returns an [`Output`](ErrorKind::Output) error if OUT is a companion file of IN.
    pub(crate) fn check_companion(
        input: &Path,
        out: &Path,
        files: &[PathBuf],
    ) -> Result<(), CliError> {
        let Some(part) = files.iter().position(|own| is_same(own, out)) else { return Ok(()) };
        // An IN without an extension denotes the whole mesh, and so does the main file then.
        if is_same(input, out) || (part == 0 && !input.is_file()) {
            return Ok(());
        }
        let (shown, input) = (out.display(), input.display());
        let text =
            format!("{shown}: this file belongs to the mesh of {input}, and would be replaced");
        let remedy = format!(
            "To smooth the mesh in place, name one file twice ({input} {input}), or give OUT another name"
        );
        Err(CliError::output(text).with_remedy(remedy))
    }

    /// Returns the error if the mesh may not replace its own file `path`; `None` if replacing is allowed.
    fn mesh_in_place(&self, mesh: MeshOutput, path: &Path, kind: ErrorKind) -> Option<CliError> {
        let path = path.display();
        let (text, remedy) = match mesh {
            MeshOutput::Smoothed if self.checkpoint.is_some() => (
                format!("{path}: a checkpoint continues a run only while IN is unchanged"),
                "A run with checkpoints needs an OUT that differs from IN",
            ),
            MeshOutput::OfMany => (
                format!("{path}: the mesh itself would be replaced"),
                "Give another directory to --out-dir",
            ),
            MeshOutput::Converted => {
                (format!("{path} is the mesh that is read"), "Give OUT another name")
            }
            MeshOutput::Smoothed | MeshOutput::None => return None,
        };
        Some(CliError::new(kind, text).with_remedy(remedy))
    }

    /// Checks that the files beside the mesh can be written, that none replaces a mesh, and that none replaces a file of
    /// another kind without `--force`.
    pub(crate) fn check_disk(&self) -> Result<(), CliError> {
        for (role, path) in self.beside_mesh() {
            let head = head(path);
            if role == Role::Checkpoint {
                self.check_checkpoint(path)?;
            } else if let Some(format) = head.as_deref().and_then(Format::name_of_content) {
                let text = format!("{}: the file is a mesh ({format})", path.display());
                return Err(CliError::output(text).with_remedy(role.remedy()));
            } else if head.is_some_and(|head| !self.replaces_any && !role.may_replace(&head)) {
                let text = role.is_other(path);
                let remedy = match self.mesh {
                    // Commands that write no mesh have no `--force`.
                    MeshOutput::None => role.remedy().to_string(),
                    _ => format!("{}, or replace the file by --force", role.remedy()),
                };
                return Err(CliError::output(text).with_remedy(remedy));
            }
            let cannot = |error| CliError::from(error).within(role.cannot_be_written());
            atomic::ensure_writable(path).map_err(cannot)?;
        }
        Ok(())
    }

    /// Checks that the report can still be written. The disk may have changed during a long run.
    pub(crate) fn check_report(&self) -> Result<(), CliError> {
        let Some(report) = &self.report else { return Ok(()) };
        let cannot = |error| CliError::from(error).within(Role::Report.cannot_be_written());
        atomic::ensure_writable(report).map_err(cannot)
    }

    /// Refuses to replace another run's checkpoint, or a file of another kind.
    fn check_checkpoint(&self, path: &Path) -> Result<(), CliError> {
        match Occupant::of(path, self.continued.as_deref()) {
            None => Ok(()),
            Some(Occupant::OtherRun) => {
                let name = path.display();
                let text = format!("{name}: the file is a checkpoint of another run");
                let remedy = format!(
                    "Go on with that run by --continue {name} (with --engine cpu as well, if the driver of a GPU ended it), or remove the file"
                );
                Err(CliError::output(text).with_remedy(remedy))
            }
            Some(Occupant::OtherKind) => {
                let text = Role::Checkpoint.is_other(path);
                Err(CliError::output(text).with_remedy(Role::Checkpoint.remedy()))
            }
        }
    }
}

impl Role {
    /// Returns whether a file with these first bytes is an earlier output of this role, or empty.
    fn may_replace(self, head: &[u8]) -> bool {
        match self {
            _ if head.trim_ascii().is_empty() => true,
            Self::Report => earlier_output::is_report(head),
            Self::Page => earlier_output::is_page(head),
            Self::Picture => earlier_output::is_picture(head),
            // Checkpoints of a run replace those of this run alone.
            Self::Checkpoint => false,
        }
    }

    /// Returns the message on a file of another kind at the path.
    fn is_other(self, path: &Path) -> String {
        let kind = match self {
            Self::Report => "a report",
            Self::Page => "a page",
            Self::Picture => "a picture",
            Self::Checkpoint => "a checkpoint",
        };
        format!("{}: exists and is not {kind} of gpu-smooth", path.display())
    }

    /// Returns the error for an output at the path of a mesh file, or with the extension of a mesh format.
    fn is_no_mesh(self, path: &Path, kind: ErrorKind) -> CliError {
        match self {
            Self::Report => {
                let text = format!("{}: the report is JSON, not a mesh", path.display());
                CliError::new(kind, text).with_remedy("End its name in .json")
            }
            Self::Checkpoint if is_named_like_a_mesh(path) && !path.exists() => {
                let text = format!("{}: a checkpoint is no mesh", path.display());
                CliError::new(kind, text).with_remedy(self.remedy())
            }
            _ => self.would_replace(path, kind),
        }
    }

    fn would_replace(self, path: &Path, kind: ErrorKind) -> CliError {
        let what = match self {
            Self::Report => "the report",
            Self::Picture => "the picture",
            Self::Page => "the page",
            Self::Checkpoint => "the checkpoint",
        };
        let error =
            CliError::new(kind, format!("{}: {what} would replace this file", path.display()));
        match self {
            Self::Report | Self::Checkpoint => error.with_remedy(self.remedy()),
            Self::Picture | Self::Page => error,
        }
    }

    fn remedy(self) -> &'static str {
        match self {
            Self::Report => "Give --report another name",
            Self::Picture => "Give --picture another name",
            Self::Page => "Give --html another name",
            Self::Checkpoint => "Give --checkpoint another name",
        }
    }

    fn cannot_be_written(self) -> &'static str {
        match self {
            Self::Report => "the report cannot be written",
            Self::Picture => "the picture cannot be written",
            Self::Page => "the page cannot be written",
            Self::Checkpoint => "checkpoints cannot be saved",
        }
    }
}

/// Returns whether two paths lead to one file. The standard streams (`-`) are never equal.
fn is_same(a: &Path, b: &Path) -> bool {
    let is_stream = |path: &Path| path.as_os_str() == "-";
    !is_stream(a) && !is_stream(b) && atomic::same_file(a, b)
}

fn is_page(path: &Path) -> bool {
    let ending = path.extension().and_then(|ending| ending.to_str()).map(str::to_lowercase);
    matches!(ending.as_deref(), Some("html" | "htm"))
}

/// Endings of pictures, pages, tables and of compressions that this program does not write.
const OF_OTHERS: [&str; 11] =
    ["png", "svg", "jpg", "pdf", "html", "htm", "json", "csv", "zip", "xz", "bz2"];

/// Refuses an OUT that ends like a file of another kind. A run would write the format of IN there.
fn check_ending(out: &Path, mesh: MeshOutput) -> Result<(), CliError> {
    let ending = out.extension().and_then(|ending| ending.to_str()).map(str::to_lowercase);
    let Some(ending) = ending.filter(|ending| OF_OTHERS.contains(&&**ending)) else {
        return Ok(());
    };
    let text = format!("{}: a mesh is written here, and .{ending} is no mesh", out.display());
    let remedy = match &*ending {
        "zip" | "xz" | "bz2" => "End OUT like IN, or in .gz",
        _ if mesh == MeshOutput::Converted => "End OUT like a mesh format, as .msh or .vtu",
        "png" | "svg" | "jpg" | "pdf" => {
            "End OUT like IN, and draw a picture by --picture FILE.png"
        }
        "html" | "htm" => "End OUT like IN, and write a page by --html FILE.html",
        _ => "End OUT like IN, and write a report by --report FILE.json",
    };
    Err(CliError::usage(text).with_remedy(remedy))
}

/// Returns whether a path has the extension of a mesh format, or `.poly`, that of a Triangle mesh's outline.
fn is_named_like_a_mesh(path: &Path) -> bool {
    let is_outline = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("poly"));
    is_outline || Format::name_of_extension(path).is_some()
}

/// Checks that the folder of a mesh exists. The other checks of its files need the format of the mesh.
fn check_folder(path: &Path) -> Result<(), CliError> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    match folder.is_none_or(Path::is_dir) {
        true => Ok(()),
        false => Ok(atomic::ensure_writable(path)?),
    }
}

/// Returns the first bytes of a file; `None` if there is no readable file.
fn head(path: &Path) -> Option<Vec<u8>> {
    /// Number of bytes read. Comments at the beginning of usual meshes are shorter.
    const LENGTH: u64 = 1 << 16;
    if !path.is_file() {
        return None;
    }
    let mut head = Vec::new();
    File::open(path).ok()?.take(LENGTH).read_to_end(&mut head).ok()?;
    Some(head)
}
