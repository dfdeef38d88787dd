//! Reads a mesh from its file, or from memory.

use crate::detect;
use crate::disk::source::{ReadOptions, Source};
use crate::error::ReadError;
use crate::formats::triangle;
use crate::mesh_file::mesh::MeshFile;
use crate::mesh_file::{ghost_arrays, region_arrays};
use crate::visit::mesh_builder;
use crate::visit::reader::ReaderFunctions;
use std::path::Path;

impl MeshFile {
    /// Reads a mesh. The format is detected by the file's content and, for ambiguous content, by the ending of its
    /// name.
    ///
    /// A path to a Triangle mesh ends in `.node`, `.ele` or neither. Files of all other formats may be compressed by
    /// gzip or zstd. The reader of an XDMF also loads the other files with its numbers, and the
    /// reader of a SELAFIN the list of boundary conditions beside it.
    ///
    /// # Errors
    /// [`ReadError`] if a file is missing or cannot be read, is in none of the formats of [`Format`](crate::Format),
    /// does not follow its format, has elements other than first-order elements of the plane, or has no triangle. An
    /// STL is [`ReadError::Unwelded`] unless [`ReadOptions::weld`] is set. A mesh that names files outside of its
    /// directory is [`ReadError::Outside`] unless [`ReadOptions::allow_outside`] is set.
    pub fn read(path: &Path) -> Result<MeshFile, ReadError> {
        ReadOptions::new().read(path)
    }

    /// Reads a mesh from memory, such as from the standard input of a program. `name` is the file's name in messages.
    /// For ambiguous content, the ending of `name` selects the format.
    ///
    /// # Errors
    /// [`ReadError`] for the reasons of [`read`](Self::read), and for a mesh of several files.
    pub fn from_bytes(name: &Path, bytes: Vec<u8>) -> Result<MeshFile, ReadError> {
        ReadOptions::new().from_bytes(name, bytes)
    }
}

impl ReadOptions {
    /// Reads a mesh as [`MeshFile::read`] does, with these options.
    ///
    /// # Errors
    /// [`ReadError`] for the reasons of [`MeshFile::read`].
    pub fn read(self, path: &Path) -> Result<MeshFile, ReadError> {
        let mut given =
            triangle::files::load_by_stem(path).unwrap_or_else(|| Source::load(path))?;
        given.options = self;
        let reader = reader(&given)?;
        parsed(reader, (reader.load_companions)(given)?)
    }

    /// Reads a mesh from memory as [`MeshFile::from_bytes`] does, with these options.
    ///
    /// # Errors
    /// [`ReadError`] for the reasons of [`MeshFile::from_bytes`].
    pub fn from_bytes(self, name: &Path, bytes: Vec<u8>) -> Result<MeshFile, ReadError> {
        let given = Source { options: self, ..Source::new(name, bytes)? };
        let reader = reader(&given)?;
        (reader.require_single)(&given)?;
        parsed(reader, given)
    }
}

/// Returns the reader of a file, or an error with the reason why no reader fits.
fn reader(given: &Source) -> Result<&'static ReaderFunctions, ReadError> {
    detect::reader(given).map_err(|error| ends_by_returns(given).unwrap_or(error))
}

fn parsed(reader: &'static ReaderFunctions, source: Source) -> Result<MeshFile, ReadError> {
    // Formats read by words accept carriage returns. The error about line ends is therefore used only if reading fails.
    let ends = source.files().find_map(ends_by_returns);
    let read = mesh_builder::parse(reader, &source).and_then(|mut parsed| {
        region_arrays::find(&mut parsed, reader, &source)?;
        ghost_arrays::constrain(&mut parsed, reader, &source)?;
        Ok(parsed)
    });
    let made = read.and_then(|parsed| MeshFile::new(parsed, reader, source));
    made.map_err(|error| ends.unwrap_or(error))
}

/// Returns the error for a text whose lines end in carriage returns alone, as on old Macintosh systems.
fn ends_by_returns(source: &Source) -> Option<ReadError> {
    let is_control = |byte: &u8| *byte < b' ' && !matches!(byte, b'\t' | b'\r' | b'\x0C');
    let is_text = memchr::memchr2(b'\n', 0, &source.bytes).is_none()
        && !source.bytes[..source.bytes.len().min(512)].iter().any(is_control);
    (is_text && memchr::memchr(b'\r', &source.bytes).is_some()).then(|| {
        let problem = "its lines end in carriage returns alone, as on old Macintosh systems";
        source.error(problem, "Make them line feeds first: tr '\\r' '\\n' < IN > OUT")
    })
}
