//! The whole mesh of a file, independent of the format.

use crate::error::ReadError;
use crate::export::content::Content;
use crate::export::content_builder;
use crate::mesh_file::mesh::MeshFile;

impl MeshFile {
    /// Reads cells of all kinds, groups and data. The file's content is searched again for them.
    ///
    /// # Errors
    /// [`ReadError`] if the names of groups, or other parts that reading the mesh does not need, are damaged.
    pub fn content(&self) -> Result<Content, ReadError> {
        let mut content = content_builder::content(self.reader(), self.source())?;
        // The points as they were read, rounded to the precision of the file.
        content.points = self.points().to_vec();
        Ok(content)
    }
}
