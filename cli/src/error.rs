//! The error of a command: its kind, message and remedy.

use std::fmt;

use crate::similar;
use gpu_smooth::{GpuError, MeshError, SmoothError};
use mesh_io::{FieldError, GroupError, ReadError, WriteError};

/// The cause of an error, which determines the exit code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ErrorKind {
    /// The command line is wrong by itself. No mesh was read.
    Usage,
    /// A file that is read is missing or damaged, lacks what an option names, or has a mesh that cannot be smoothed.
    Input,
    /// A file cannot be written.
    Output,
    /// The command finished its work without the wanted result, or failed by an error inside the program.
    Run,
    /// A GPU cannot be used, or has failed.
    Device,
}

impl ErrorKind {
    /// Returns the name in a log of JSON.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Usage => "usage",
            Self::Input => "input",
            Self::Output => "output",
            Self::Run => "run",
            Self::Device => "device",
        }
    }

    /// Returns the exit code of the program.
    pub(crate) fn exit_code(self) -> u8 {
        match self {
            Self::Run => 1,
            // clap exits with 2 as well.
            Self::Usage => 2,
            Self::Input => 3,
            Self::Output => 4,
            Self::Device => 5,
        }
    }
}

/// The error of a failed command. Displays as `message. remedy`, with each detail on an indented line below.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct CliError {
    pub(crate) kind: ErrorKind,
    /// The problem, preceded by the file, line or option if known.
    message: String,
    /// Advice to the user on how to proceed, without a final period.
    remedy: Option<String>,
    /// A list that belongs to the message, such as the first inverted triangles.
    details: Vec<String>,
}

impl CliError {
    pub(crate) fn new(kind: ErrorKind, message: impl Into<String>) -> Self {
        Self { kind, message: message.into(), remedy: None, details: Vec::new() }
    }

    pub(crate) fn usage(message: impl Into<String>) -> Self {
        Self::new(ErrorKind::Usage, message)
    }

    pub(crate) fn input(message: impl Into<String>) -> Self {
        Self::new(ErrorKind::Input, message)
    }

    pub(crate) fn output(message: impl Into<String>) -> Self {
        Self::new(ErrorKind::Output, message)
    }

    pub(crate) fn run(message: impl Into<String>) -> Self {
        Self::new(ErrorKind::Run, message)
    }

    pub(crate) fn device(message: impl Into<String>) -> Self {
        Self::new(ErrorKind::Device, message)
    }

    /// Replaces the kind, and with it the exit code.
    pub(crate) fn of_kind(self, kind: ErrorKind) -> Self {
        Self { kind, ..self }
    }

    /// Adds advice to the user on how to proceed.
    pub(crate) fn with_remedy(self, remedy: impl Into<String>) -> Self {
        Self { remedy: Some(remedy.into()), ..self }
    }

    /// Replaces the lines below the message.
    pub(crate) fn with_details(self, details: Vec<String>) -> Self {
        Self { details, ..self }
    }

    /// Adds a line below the message and the other details.
    pub(crate) fn with_detail(mut self, detail: String) -> Self {
        self.details.push(detail);
        self
    }

    /// Prefixes the message with `part` and a colon; `part` names the failed work.
    pub(crate) fn within(self, part: &str) -> Self {
        Self { message: format!("{part}: {}", self.message), ..self }
    }

    /// Prefixes the message with `words` and a blank, so that both form one sentence.
    pub(crate) fn after(self, words: &str) -> Self {
        Self { message: format!("{words} {}", self.message), ..self }
    }

    /// Appends the option that causes the error, in parentheses, to the remedy, or to the message if there is no
    /// remedy.
    pub(crate) fn about(mut self, option: &str) -> Self {
        let text = self.remedy.as_mut().unwrap_or(&mut self.message);
        *text = format!("{text} ({option})");
        self
    }

    /// Appends a period and `sentence` to the remedy, or to the message if no remedy is set.
    pub(crate) fn followed_by(mut self, sentence: &str) -> Self {
        let text = self.remedy.as_mut().unwrap_or(&mut self.message);
        *text = format!("{text}. {sentence}");
        self
    }

    pub(crate) fn remedy(&self) -> Option<&str> {
        self.remedy.as_deref()
    }

    /// Returns message and remedy without the details.
    pub(crate) fn headline(&self) -> String {
        match &self.remedy {
            None => self.message.clone(),
            Some(remedy) => format!("{}. {remedy}", self.message),
        }
    }
}

impl fmt::Display for CliError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.headline())?;
        self.details.iter().try_for_each(|detail| write!(f, "\n  {detail}"))
    }
}

impl From<ReadError> for CliError {
    fn from(error: ReadError) -> Self {
        match error {
            ReadError::Io { path, source, remedy } => {
                let is_missing = source.kind() == std::io::ErrorKind::NotFound;
                let meant = similar::nearest_file(&path).filter(|_| is_missing);
                let remedy =
                    meant.map_or(remedy, |meant| format!("Did you mean {}?", meant.display()));
                Self::input(format!("{}: {source}", path.display())).with_remedy(remedy)
            }
            ReadError::Content { path, location, problem, remedy } => {
                Self::input(format!("{}{location}: {problem}", path.display())).with_remedy(remedy)
            }
            ReadError::Format { path, problem, remedy } => {
                Self::input(format!("{}: {problem}", path.display())).with_remedy(remedy)
            }
            ReadError::Unwelded { path } => {
                let problem =
                    "an STL lists corners of triangles, and has no vertices that these share";
                Self::input(format!("{}: {problem}", path.display()))
                    .with_remedy("Have corners at the same place joined: --weld")
            }
            ReadError::Outside { path, location, names, target } => {
                let (path, target) = (path.display(), target.display());
                let problem = format!(
                    "{path}{location}: it names {names}, which is {target}, outside of the directory of the mesh"
                );
                Self::input(problem).with_remedy(
                    "Move the file beside the mesh, or, if you trust the mesh, let it name files elsewhere by --allow-outside",
                )
            }
        }
    }
}

impl From<WriteError> for CliError {
    fn from(error: WriteError) -> Self {
        match error {
            WriteError::Io { path, source, remedy } => {
                Self::output(format!("{}: {source}", path.display())).with_remedy(remedy)
            }
            WriteError::Format { path, problem, remedy } => {
                Self::output(format!("{}: {problem}", path.display())).with_remedy(remedy)
            }
            WriteError::Changed { path } => {
                let problem = "another program has changed this file after the file was read, so the file is not replaced";
                Self::output(format!("{}: {problem}", path.display()))
                    .with_remedy("Give OUT another name, or run again to smooth the present mesh")
            }
            WriteError::Points { .. } => Self::run(error.to_string()),
        }
    }
}

impl From<GroupError> for CliError {
    fn from(error: GroupError) -> Self {
        Self::input(error.to_string())
    }
}

/// A field of a wrong length is an internal error, not one of the user's files.
impl From<FieldError> for CliError {
    fn from(error: FieldError) -> Self {
        Self::run(error.to_string())
    }
}

/// Words the error without names of the file. `load::explain` words errors in the terms of a mesh file.
impl From<MeshError> for CliError {
    fn from(error: MeshError) -> Self {
        Self::input(error.to_string())
    }
}

impl From<GpuError> for CliError {
    fn from(error: GpuError) -> Self {
        let told = Self::device(error.to_string());
        match error {
            GpuError::Arithmetic { .. } => {
                told.with_remedy("Use another adapter or the CPU (--engine cpu)")
            }
            _ => told,
        }
    }
}

impl From<SmoothError> for CliError {
    fn from(error: SmoothError) -> Self {
        match error {
            SmoothError::Mesh(error) => error.into(),
            SmoothError::Gpu(error) => error.into(),
            SmoothError::Checkpoint(_) => Self::input(error.to_string()),
            _ => Self::run(error.to_string()),
        }
    }
}

impl From<serde_json::Error> for CliError {
    fn from(error: serde_json::Error) -> Self {
        Self::run(error.to_string())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mesh_io::MeshFile;
    use std::path::Path;

    #[test]
    fn an_error_of_a_file_reads_as_the_library_words_it() {
        for name in ["none.msh", "in.txt"] {
            let error = MeshFile::from_bytes(Path::new(name), b"hello\n".to_vec()).err().unwrap();
            let text = error.to_string();
            let error = CliError::from(error);
            assert_eq!((error.kind, error.to_string()), (ErrorKind::Input, text));
            assert!(error.remedy().is_some());
        }
        let error = mesh_io::atomic::ensure_writable(Path::new("none/out.msh")).err().unwrap();
        let text = error.to_string();
        let error = CliError::from(error);
        assert_eq!((error.kind, error.to_string()), (ErrorKind::Output, text));
    }

    #[test]
    fn an_adapter_that_drops_digits_is_refused_with_the_option_for_the_cpu() {
        let error = GpuError::Arithmetic { adapter: "Card".into(), operation: "digits are lost" };
        let line = "the adapter Card cannot be used: digits are lost. Use another adapter or the CPU (--engine cpu)";
        for error in [CliError::from(error.clone()), SmoothError::Gpu(error).into()] {
            assert_eq!((error.kind, error.headline().as_str()), (ErrorKind::Device, line));
        }
    }

    #[test]
    fn parts_are_joined_to_one_text() {
        let error =
            CliError::output("r.json: the file is read-only").with_remedy("Make it writable");
        let error =
            error.within("the report cannot be written").followed_by("The mesh was written");
        let error = error.with_details(vec!["first".into(), "second".into()]);
        let line = "the report cannot be written: r.json: the file is read-only. Make it writable. The mesh was written";
        assert_eq!(error.headline(), line);
        assert_eq!(error.to_string(), format!("{line}\n  first\n  second"));
        let bare = CliError::run("it failed").followed_by("The mesh was written");
        assert_eq!(
            (bare.to_string().as_str(), bare.remedy()),
            ("it failed. The mesh was written", None)
        );
    }
}
