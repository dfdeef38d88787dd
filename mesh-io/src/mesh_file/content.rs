//! The whole mesh of a file, independent of the format.

use crate::error::ReadError;
use crate::export::content::Content;
use crate::export::content_builder;
use crate::mesh_file::mesh::MeshFile;

impl MeshFile {
    /// Reads cells of all kinds, groups and data, by parsing the bytes of the file again.
    ///
    /// # Errors
    /// [`ReadError`] if names of groups, or other content that [`read`](Self::read) skips, are damaged.
    pub fn content(&self) -> Result<Content, ReadError> {
        self.content_with(self.region_array())
    }

    /// Reads the content as [`content`](Self::content) does. The cell data `region_array` become groups; `None` leaves them
    /// data.
    pub(crate) fn content_with(&self, region_array: Option<&str>) -> Result<Content, ReadError> {
        let mut content = content_builder::content(self.reader(), self.source(), region_array)?;
        // The points of the first reading are rounded to the precision of the file.
        content.points = self.points().to_vec();
        Ok(content)
    }
}
