//! The protocol of the reader of a format.

use crate::disk::source::Source;
use crate::edit::numbers::Splice;
use crate::error::{ReadError, WriteError};
use crate::visit::sink::Sink;
use crate::visit::storage::Layout;
use std::path::{Path, PathBuf};

/// The reader of a format.
pub(crate) trait Walk {
    /// Names the file's list of vertices in messages.
    const VERTICES: &'static str;
    /// Loads the other files of the mesh that `given` belongs to. Returns the main file, with the other files as
    /// companions.
    ///
    /// # Errors
    /// If `given` is damaged, or if another file is missing or cannot be read.
    fn load_companions(given: Source) -> Result<Source, ReadError> {
        Ok(given)
    }
    /// Refuses bytes that were not read from a file, if the mesh has other files.
    ///
    /// # Errors
    /// If the mesh has other files, or if the bytes are damaged.
    fn require_single(_source: &Source) -> Result<(), ReadError> {
        Ok(())
    }
    /// Returns the files to which the mesh is written for `path`, in the order of [`Source::parts`].
    ///
    /// # Errors
    /// If `path` does not suit the format, or if a file of another mesh is in the way.
    fn destinations(_source: &Source, path: &Path) -> Result<Vec<PathBuf>, WriteError> {
        Ok(vec![path.to_owned()])
    }
    /// Returns the edits of the main file that rename its companions for `path`.
    fn renames(_source: &Source, _path: &Path) -> Vec<Splice> {
        Vec::new()
    }
    /// Feeds the nodes and elements of the mesh to the sink.
    fn walk(source: &Source, sink: &mut dyn Sink) -> Result<Layout, ReadError>;
}

/// The reader of a format, as a value: the functions of a [`Walk`] under their names. A file is read by this walk alone.
/// It takes any sink, so that it is compiled once.
pub(crate) struct Reader {
    pub(crate) walk: fn(&Source, &mut dyn Sink) -> Result<Layout, ReadError>,
    pub(crate) load_companions: fn(Source) -> Result<Source, ReadError>,
    pub(crate) require_single: fn(&Source) -> Result<(), ReadError>,
    pub(crate) destinations: fn(&Source, &Path) -> Result<Vec<PathBuf>, WriteError>,
    pub(crate) renames: fn(&Source, &Path) -> Vec<Splice>,
    pub(crate) vertices: &'static str,
}

impl Reader {
    pub(crate) const fn of<W: Walk>() -> Reader {
        Reader {
            walk: W::walk,
            load_companions: W::load_companions,
            require_single: W::require_single,
            destinations: W::destinations,
            renames: W::renames,
            vertices: W::VERTICES,
        }
    }
}
