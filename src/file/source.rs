//! The bytes of one file, and what a format's reader makes of them.

use crate::error::{Location, ReadError};
use crate::file::binary::Order;
use crate::file::row_form::{Labels, Rows};
use crate::mesh::Mesh;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// A file as it was read.
pub(crate) struct Source {
    pub(crate) path: PathBuf,
    pub(crate) bytes: Vec<u8>,
}

/// What a reader returns.
pub(crate) struct Parsed {
    pub(crate) mesh: Mesh,
    /// Offset of each vertex's x in the file that holds the vertices, ascending.
    pub(crate) x_at: Vec<usize>,
    /// Of the bytes of its numbers, if they are not text.
    pub(crate) order: Option<Order>,
    /// How triangles and vertices are numbered, if the latter are consecutively.
    pub(crate) labels: Option<Labels>,
    /// Of a binary file, the rows of the triangles, in its order.
    pub(crate) rows: Vec<Rows>,
    /// One-line remarks for the user.
    pub(crate) notes: Vec<String>,
}

impl Source {
    pub(crate) fn load(path: &Path) -> Result<Source, ReadError> {
        match fs::read(path) {
            Ok(bytes) => Ok(Source { path: path.to_owned(), bytes }),
            Err(source) => {
                let remedy = match source.kind() {
                    ErrorKind::NotFound => "Check the name",
                    ErrorKind::IsADirectory => "Name a mesh file, not a directory",
                    ErrorKind::PermissionDenied => "Check its permissions",
                    ErrorKind::OutOfMemory => "Use a machine with more memory",
                    _ => "Check the disk, or copy the file elsewhere and try again",
                };
                Err(ReadError::Io { path: path.to_owned(), source, remedy: remedy.into() })
            }
        }
    }

    #[cold]
    pub(crate) fn error_at(
        &self,
        location: Location,
        problem: impl Into<String>,
        remedy: impl Into<String>,
    ) -> ReadError {
        let path = self.path.clone();
        ReadError::Content { path, location, problem: problem.into(), remedy: remedy.into() }
    }

    #[cold]
    pub(crate) fn error(&self, problem: impl Into<String>, remedy: impl Into<String>) -> ReadError {
        let path = self.path.clone();
        ReadError::Format { path, problem: problem.into(), remedy: remedy.into() }
    }

    /// One-based line of a byte.
    pub(crate) fn line_of(&self, at: usize) -> usize {
        1 + memchr::memchr_iter(b'\n', &self.bytes[..at]).count()
    }

    /// The last part of the path, for messages.
    pub(crate) fn name(&self) -> String {
        file_name(&self.path)
    }
}

/// The last part of a path, for messages.
pub(crate) fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

/// The remark that elements other than triangles hold their vertices.
pub(crate) fn fixed_note(count: u64, what: &str, of: &str) -> String {
    let (s, their) = if count == 1 { ("", "its") } else { ("s", "their") };
    format!("{count} {what}{s}{of}: {their} vertices stay fixed")
}
