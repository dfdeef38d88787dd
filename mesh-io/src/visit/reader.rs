//! Interface of the readers of formats.

use crate::disk::source::Source;
use crate::edit::numbers::ByteEdit;
use crate::error::{ReadError, WriteError};
use crate::visit::storage::CoordinateStorage;
use crate::visit::visitor::MeshVisitor;
use std::path::{Path, PathBuf};

/// Reader of one or more formats. All methods but `visit` handle meshes of several files.
pub(crate) trait FormatReader {
    /// Name of the file's list of vertices in messages.
    const VERTICES: &'static str;
    /// Whether groups of lines may have edges that no line element or polyline of a plain reading has, such as a list of sides.
    const NAMES_OTHER_LINES: bool = true;
    /// Loads the other files of the mesh that `given` belongs to. Returns the main file, with the other files as
    /// companions.
    ///
    /// # Errors
    /// [`ReadError`] if `given` is damaged, or if another file is missing or cannot be read.
    fn load_companions(given: Source) -> Result<Source, ReadError> {
        Ok(given)
    }
    /// Checks that a mesh read from memory needs no other files.
    ///
    /// # Errors
    /// [`ReadError`] if the mesh has other files, or if the bytes are damaged.
    fn require_single(_source: &Source) -> Result<(), ReadError> {
        Ok(())
    }
    /// Returns the paths of the files that a write to `path` creates, in the order of [`Source::files`].
    ///
    /// # Errors
    /// [`WriteError`] if `path` does not suit the format, or if readers would open a file of another mesh with the
    /// written files.
    fn destinations(_source: &Source, path: &Path) -> Result<Vec<PathBuf>, WriteError> {
        Ok(vec![path.to_owned()])
    }
    /// Returns the edits of the main file that rename its companions if the mesh is written to `path`.
    fn renames(_source: &Source, _path: &Path) -> Vec<ByteEdit> {
        Vec::new()
    }
    /// Visits all items of the mesh. Returns the encoding and location of the coordinates.
    fn visit(
        source: &Source,
        visitor: &mut dyn MeshVisitor,
    ) -> Result<CoordinateStorage, ReadError>;
}

/// The functions of a [`FormatReader`] as values, for the table of formats. `visit` takes a trait object, so that
/// each reader is compiled once.
pub(crate) struct ReaderFunctions {
    pub(crate) visit: fn(&Source, &mut dyn MeshVisitor) -> Result<CoordinateStorage, ReadError>,
    pub(crate) load_companions: fn(Source) -> Result<Source, ReadError>,
    pub(crate) require_single: fn(&Source) -> Result<(), ReadError>,
    pub(crate) destinations: fn(&Source, &Path) -> Result<Vec<PathBuf>, WriteError>,
    pub(crate) renames: fn(&Source, &Path) -> Vec<ByteEdit>,
    pub(crate) vertices: &'static str,
    pub(crate) names_other_lines: bool,
}

impl ReaderFunctions {
    pub(crate) const fn of<W: FormatReader>() -> ReaderFunctions {
        ReaderFunctions {
            visit: W::visit,
            load_companions: W::load_companions,
            require_single: W::require_single,
            destinations: W::destinations,
            renames: W::renames,
            vertices: W::VERTICES,
            names_other_lines: W::NAMES_OTHER_LINES,
        }
    }
}
