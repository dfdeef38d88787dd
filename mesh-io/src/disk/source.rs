//! A mesh file in memory, with its companion files and the errors that name it.

use crate::compress::file::{CompressedFile, DecompressError, decompress};
use crate::disk::paths::directory_of;
use crate::disk::stamp::KnownState;
use crate::error::{Location, ReadError};
use crate::parallel::map_parts;
use std::fs::{self, File};
use std::io::{self, ErrorKind, Read, Seek, SeekFrom};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Options for reading a mesh file.
///
/// ```no_run
/// use mesh_io::ReadOptions;
/// use std::path::Path;
///
/// let file = ReadOptions::new().weld(true).read(Path::new("part.stl"))?;
/// # Ok::<(), mesh_io::ReadError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ReadOptions {
    pub(crate) welds: bool,
    pub(crate) allows_outside: bool,
    pub(crate) regions: Option<String>,
    pub(crate) allows_quadrilaterals_alone: bool,
}

impl ReadOptions {
    /// Returns the default options, with which [`MeshFile::read`](crate::MeshFile::read) reads.
    pub fn new() -> ReadOptions {
        ReadOptions::default()
    }

    /// Sets whether corners of triangles with equal coordinates become one vertex: in STL, which has no vertices, and in
    /// VTK XML, where programs with discontinuous elements write a point for each corner of each triangle. All three
    /// coordinates must be equal. Vertices are numbered in the order of their first corners in the file, and a moved vertex
    /// is written at each of its corners. Data that differ between the corners of a vertex stay as they are. Other formats
    /// ignore the option. Off by default.
    #[must_use]
    pub fn weld(self, welds: bool) -> ReadOptions {
        ReadOptions { welds, ..self }
    }

    /// Sets whether a mesh file may name files outside of its own directory, which are then read, and replaced by a
    /// write in place. Symbolic links are followed before directories are compared. Off by default, as a stranger may
    /// have made the mesh file: outside files are then the error [`ReadError::Outside`].
    #[must_use]
    pub fn allow_outside(self, allows_outside: bool) -> ReadOptions {
        ReadOptions { allows_outside, ..self }
    }

    /// Sets whether a mesh may have quadrilaterals and no triangle, for a program that takes
    /// [quadrilaterals](crate::MeshFile::quadrilaterals). Off by default: such a mesh is then an error.
    #[must_use]
    pub fn allow_quadrilaterals_alone(self, allows: bool) -> ReadOptions {
        ReadOptions { allows_quadrilaterals_alone: allows, ..self }
    }

    /// Sets the cell data that number the regions of the elements, in place of those that the reader finds. The data
    /// must be whole numbers, stored as integers or as real numbers, with a number per triangle and quadrilateral. `None`
    /// by default: regions are then the entries of the format, or else the first array of whole numbers that form few
    /// connected regions.
    #[must_use]
    pub fn regions(self, array: Option<String>) -> ReadOptions {
        ReadOptions { regions: array, ..self }
    }
}

/// A file of a mesh as it was read, decompressed.
pub(crate) struct Source {
    pub(crate) path: PathBuf,
    pub(crate) bytes: Vec<u8>,
    /// The compressed bytes of the file, if it is compressed.
    pub(crate) compressed: Option<CompressedFile>,
    pub(crate) options: ReadOptions,
    /// Stamp of the file on disk after the latest read or write by this process.
    pub(crate) known: KnownState,
    /// The other files of the mesh.
    pub(crate) companions: Vec<Companion>,
    /// A file that adds groups to the mesh, which is complete without the file.
    pub(crate) beside: Option<Box<Source>>,
}

/// Another file of a mesh.
pub(crate) struct Companion {
    /// Names by which the main file refers to this file. Empty if the name follows from the main file's name.
    pub(crate) names: Vec<String>,
    /// Ranges of the main file that hold one of the names, ascending.
    pub(crate) named_at: Vec<Range<usize>>,
    pub(crate) source: Source,
}

impl Companion {
    /// Makes a companion whose name follows from the main file's name.
    pub(crate) fn by_convention(source: Source) -> Companion {
        Companion { names: Vec::new(), named_at: Vec::new(), source }
    }
}

impl Source {
    pub(crate) fn load(path: &Path) -> Result<Source, ReadError> {
        let known = KnownState::before_reading(path);
        match content(path) {
            Ok(bytes) => Ok(Source { known, ..Source::new(path, bytes)? }),
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

    /// Makes a source from a file's bytes, and decompresses gzip and zstd.
    pub(crate) fn new(path: &Path, bytes: Vec<u8>) -> Result<Source, ReadError> {
        let source = Source {
            path: path.to_owned(),
            bytes,
            compressed: None,
            options: ReadOptions::new(),
            known: KnownState::default(),
            companions: Vec::new(),
            beside: None,
        };
        match decompress(&source.bytes) {
            Ok(None) => Ok(source),
            Ok(Some((compression, content))) => {
                let compressed = Some(CompressedFile { compression, bytes: source.bytes });
                Ok(Source { bytes: content, compressed, ..source })
            }
            Err(DecompressError { problem, remedy }) => Err(source.error(problem, remedy)),
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

    /// Checks that `path` lies in the directory of the mesh file `mesh` or below, unless the options of `mesh` allow
    /// other directories. This file refers to `path` by `names` at byte `at`. A path without a file passes.
    ///
    /// # Errors
    /// [`ReadError::Outside`] if the file is outside of the directory.
    pub(crate) fn check_inside(
        &self,
        mesh: &Source,
        path: &Path,
        names: &str,
        at: usize,
    ) -> Result<(), ReadError> {
        if mesh.options.allows_outside {
            return Ok(());
        }
        let Ok(target) = fs::canonicalize(path) else { return Ok(()) };
        let own = fs::canonicalize(directory_of(&mesh.path)).ok();
        // If the mesh file is a symbolic link, files beside its target are allowed too.
        let linked = fs::canonicalize(&mesh.path).ok();
        let linked = linked.as_deref().and_then(Path::parent);
        if own.as_deref().into_iter().chain(linked).any(|folder| target.starts_with(folder)) {
            return Ok(());
        }
        let (path, location) = (self.path.clone(), Location::Line(self.line_of(at)));
        Err(ReadError::Outside { path, location, names: names.to_owned(), target })
    }

    /// Returns the offset of the content: 3 if the file starts with a UTF-8 byte order mark, else 0.
    pub(crate) fn begin(&self) -> usize {
        if self.bytes.starts_with(b"\xEF\xBB\xBF") { 3 } else { 0 }
    }

    /// Returns the line of the byte at offset `at`, counted from 1.
    pub(crate) fn line_of(&self, at: usize) -> usize {
        1 + memchr::memchr_iter(b'\n', &self.bytes[..at]).count()
    }

    /// Returns the bytes of the file on disk when it was read: the compressed bytes of a compressed file.
    pub(crate) fn stored(&self) -> &[u8] {
        self.compressed.as_ref().map_or(&self.bytes, |packed| &packed.bytes)
    }

    /// Returns the files of the mesh: this file, then its companions.
    pub(crate) fn files(&self) -> impl Iterator<Item = &Source> {
        std::iter::once(self).chain(self.companions.iter().map(|companion| &companion.source))
    }

    /// Returns the file name without directories, for messages.
    pub(crate) fn name(&self) -> String {
        file_name(&self.path)
    }
}

/// Number of bytes that one task reads.
const CHUNK: usize = 1 << 19;

/// Reads a file. If the file has at least two chunks, all threads read chunks, as a single thread spends most of its
/// time waiting for the system to provide memory.
fn content(path: &Path) -> io::Result<Vec<u8>> {
    let about = fs::metadata(path)?;
    match usize::try_from(about.len()) {
        Ok(length) if about.is_file() && length >= 2 * CHUNK => {
            // Without enough memory, this line returns an error, while the next line would end the process without a
            // message.
            Vec::<u8>::new().try_reserve_exact(length)?;
            let mut bytes = vec![0; length];
            let each = bytes.chunks_mut(CHUNK);
            let read = map_parts(each, |index, chunk| {
                let mut file = File::open(path)?;
                file.seek(SeekFrom::Start((index * CHUNK) as u64))?;
                file.read_exact(chunk)
            });
            let has_changed = fs::metadata(path)?.len() != about.len();
            match read.iter().all(io::Result::is_ok) && !has_changed {
                true => Ok(bytes),
                false => fs::read(path),
            }
        }
        _ => fs::read(path),
    }
}

/// Returns the file name of a path without directories, for messages.
pub(crate) fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}
