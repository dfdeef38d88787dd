//! The kinds of connectivity tables.

/// Elements of a connectivity table.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum TableKind {
    Faces,
    Edges,
}

impl TableKind {
    /// Returns singular and plural for messages, the attribute that names the element dimension, and the minimum of
    /// nodes per element.
    pub(super) fn words(self) -> (&'static str, &'static str, &'static str, u64) {
        match self {
            TableKind::Faces => ("face", "faces", "face_dimension", 3),
            TableKind::Edges => ("edge", "edges", "edge_dimension", 2),
        }
    }
}
