//! Faces of a mesh with any number of corners.

/// Faces with any number of corners, such as quadrilaterals and polygons.
#[derive(Debug, Default)]
pub(crate) struct Faces {
    /// Vertex indices of the corners, face by face, in order around each face.
    corners: Vec<u32>,
    /// Exclusive end of each face's corners in `corners`.
    ends: Vec<usize>,
}

impl Faces {
    /// Adds a face by the vertex indices of its corners.
    pub(crate) fn push(&mut self, corners: &[u32]) {
        self.corners.extend_from_slice(corners);
        self.ends.push(self.corners.len());
    }

    /// Lists the corners of each face, in the order in which the faces were added.
    pub(crate) fn iter(&self) -> impl Iterator<Item = &[u32]> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, &end)| &self.corners[start..end])
    }
}
