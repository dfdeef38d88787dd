//! The files that a command writes, and the check of all of them before any work.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::time::Duration;

use gpu_smooth::Checkpoint;
use mesh_io::{Format, atomic};

use crate::args::{PictureArgs, SmoothArgs};
use crate::error::{CliError, ErrorKind};
use crate::request::picture::PictureRequest;
use crate::request::target::TargetRequest;

/// A file with a checkpoint, and how often it is written.
pub(crate) struct CheckpointPlan {
    pub(crate) file: PathBuf,
    pub(crate) every: Duration,
}

/// How a command writes its mesh, which decides what the mesh may replace.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MeshOutput {
    /// A run on one mesh may write it in place, unless it has a checkpoint.
    Smoothed,
    /// Runs on many meshes write none in place.
    OfMany,
    /// A conversion does not write in place.
    Converted,
    /// The command writes no mesh.
    None,
}

/// What a file beside the mesh is.
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
    /// Whether the mesh may replace a file that holds another mesh, or no mesh.
    pub(crate) replaces_any: bool,
    pub(crate) report: Option<PathBuf>,
    pub(crate) picture: Option<PictureRequest>,
    /// The page for a browser.
    pub(crate) page: Option<PathBuf>,
    pub(crate) checkpoint: Option<CheckpointPlan>,
    /// Files that are read besides meshes. The checkpoint alone may replace the one that a run continues from.
    inputs: Vec<PathBuf>,
    /// The checkpoint that a run continues from.
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
            checkpoint: None,
            inputs: Vec::new(),
            continued: None,
        }
    }

    /// Returns the outputs of a run on one mesh or many.
    ///
    /// # Errors
    /// If the ending of the picture's name is not that of a format of pictures.
    pub(crate) fn of_run(args: &SmoothArgs) -> Result<Self, CliError> {
        let checkpoint = args.checkpoint.as_ref().or(args.continued.as_ref());
        let mut inputs = args.moving.fix_vertices.clone();
        inputs.extend(TargetRequest::from(&args.target).files());
        Ok(Self {
            mesh: match args.out_dir {
                Some(_) => MeshOutput::OfMany,
                None => MeshOutput::Smoothed,
            },
            // Who resumes says that the directory holds results.
            replaces_any: args.force || args.resume,
            report: args.report.clone(),
            picture: PictureRequest::of(&args.picture)?,
            page: args.html.clone(),
            checkpoint: checkpoint
                .map(|file| CheckpointPlan { file: file.clone(), every: args.checkpoint_every }),
            inputs,
            continued: args.continued.clone(),
        })
    }

    /// Returns the outputs of a command that only draws a picture.
    ///
    /// # Errors
    /// If the ending of the picture's name is not that of a format of pictures.
    pub(crate) fn of_picture(args: &PictureArgs) -> Result<Self, CliError> {
        Ok(Self { picture: PictureRequest::of(args)?, ..Self::of_mesh(MeshOutput::None) })
    }

    /// Lists the files beside the mesh.
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

    /// Checks, before a mesh is read, all that is known of a mesh that is read from `read` and written to `written`.
    ///
    /// # Errors
    /// Of the kind [`Usage`](ErrorKind::Usage) if a name is that of another kind of file, or if a file would replace another
    /// one. Of the kind [`Output`](ErrorKind::Output) if the disk has another file at a name, or does not take one.
    pub(crate) fn check(&self, read: &[PathBuf], written: &[PathBuf]) -> Result<(), CliError> {
        self.check_names()?;
        self.check_files(read, written, ErrorKind::Usage)?;
        written.iter().try_for_each(|path| check_folder(path))?;
        self.check_disk()
    }

    /// Checks that no name of a file beside the mesh ends as those of meshes do, and that a page is called HTML.
    pub(crate) fn check_names(&self) -> Result<(), CliError> {
        for (role, path) in self.beside_mesh() {
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

    /// Checks that no file replaces another one that is read or written. The files of the mesh are known exactly once it is
    /// read; before, as far as the command line tells them.
    ///
    /// # Errors
    /// Of the given kind.
    pub(crate) fn check_files(
        &self,
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
        match own.and_then(|path| self.mesh_in_place(path, kind)) {
            Some(error) => Err(error),
            None => Ok(()),
        }
    }

    /// Checks that OUT is not a file of the mesh beside the one that was given as IN: who names two files of a mesh may take them
    /// for two meshes. `files` are all files of the mesh, the main file first.
    ///
    /// # Errors
    /// Of the kind [`Output`](ErrorKind::Output).
    pub(crate) fn check_companion(
        input: &Path,
        out: &Path,
        files: &[PathBuf],
    ) -> Result<(), CliError> {
        let Some(part) = files.iter().position(|own| is_same(own, out)) else { return Ok(()) };
        // A name without an ending is that of the whole mesh, and so is the main file then.
        if is_same(input, out) || (part == 0 && !input.is_file()) {
            return Ok(());
        }
        let (shown, input) = (out.display(), input.display());
        let text =
            format!("{shown}: this file and {input} are of one mesh, which it would replace");
        let remedy = format!(
            "To smooth the mesh in place, name one file twice ({input} {input}), or give OUT another name"
        );
        Err(CliError::output(text).with_remedy(remedy))
    }

    /// Returns the error if the mesh may not replace one of its own files.
    fn mesh_in_place(&self, path: &Path, kind: ErrorKind) -> Option<CliError> {
        let path = path.display();
        let (text, remedy) = match self.mesh {
            MeshOutput::Smoothed if self.checkpoint.is_some() => (
                format!("{path}: a run can only be continued while IN is as it was"),
                "With a checkpoint, OUT must be another file",
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

    /// Checks that the files beside the mesh can be written, and that none replaces a mesh or a foreign file.
    pub(crate) fn check_disk(&self) -> Result<(), CliError> {
        for (role, path) in self.beside_mesh() {
            let head = head(path);
            if role == Role::Checkpoint {
                self.check_checkpoint(path, head.as_deref())?;
            } else if let Some(format) = head.as_deref().and_then(Format::name_of_content) {
                let text = format!("{}: there is a mesh in this file ({format})", path.display());
                return Err(CliError::output(text).with_remedy(role.remedy()));
            }
            let cannot = |error| CliError::from(error).within(role.cannot_be_written());
            atomic::ensure_writable(path).map_err(cannot)?;
        }
        Ok(())
    }

    /// Checks whether the report can be written, as this may have changed during a long run.
    pub(crate) fn check_report(&self) -> Result<(), CliError> {
        let Some(report) = &self.report else { return Ok(()) };
        let cannot = |error| CliError::from(error).within(Role::Report.cannot_be_written());
        atomic::ensure_writable(report).map_err(cannot)
    }

    /// Refuses a checkpoint that would replace the checkpoint of another run, or any other file. `head` is the beginning of
    /// the file, if there is one.
    fn check_checkpoint(&self, path: &Path, head: Option<&[u8]>) -> Result<(), CliError> {
        let name = path.display();
        let is_continued = self.continued.as_deref().is_some_and(|from| is_same(from, path));
        match head.map(|head| head.starts_with(Checkpoint::MAGIC)) {
            _ if is_continued => Ok(()),
            None => Ok(()),
            Some(true) => {
                let text = format!("{name}: this file is the checkpoint of another run");
                let remedy = format!(
                    "Go on with that run by --continue {name} (with --engine cpu as well, if the driver of a GPU ended it), or remove the file"
                );
                Err(CliError::output(text).with_remedy(remedy))
            }
            Some(false) => {
                let text = format!("{name}: exists and is not a checkpoint");
                Err(CliError::output(text).with_remedy(Role::Checkpoint.remedy()))
            }
        }
    }
}

impl Role {
    /// Words that a file would replace one of the mesh, or is called like one.
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

/// Whether two paths lead to one file. The standard streams are none.
fn is_same(a: &Path, b: &Path) -> bool {
    let is_stream = |path: &Path| path.as_os_str() == "-";
    !is_stream(a) && !is_stream(b) && atomic::same_file(a, b)
}

fn is_page(path: &Path) -> bool {
    let ending = path.extension().and_then(|ending| ending.to_str()).map(str::to_lowercase);
    matches!(ending.as_deref(), Some("html" | "htm"))
}

/// Whether a name ends as files of a format of meshes do, or as the outline beside a Triangle mesh.
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

/// Returns the beginning of a file. `None` if there is no such file.
fn head(path: &Path) -> Option<Vec<u8>> {
    /// Longer than the comments at the beginning of usual meshes.
    const LENGTH: u64 = 1 << 16;
    if !path.is_file() {
        return None;
    }
    let mut head = Vec::new();
    File::open(path).ok()?.take(LENGTH).read_to_end(&mut head).ok()?;
    Some(head)
}

/// Whether a file is a checkpoint, of whichever run.
pub(crate) fn is_checkpoint(path: &Path) -> bool {
    head(path).is_some_and(|head| head.starts_with(Checkpoint::MAGIC))
}
