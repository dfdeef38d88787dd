//! Finds where a file has its vertices and triangles, for messages.

use crate::error::Location;
use crate::mesh_file::mesh::MeshFile;
use crate::visit::locate::{ItemLocation, List, locate};
use std::collections::BTreeMap;
use std::fmt;
use std::path::PathBuf;

/// Where a vertex or triangle stands in its file. Displayed as `la.1.ele:18`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The file.
    pub path: PathBuf,
    /// The line or byte, or [`Location::Unknown`] if a second search of the file does not find the item.
    pub location: Location,
    /// The file's own number or tag of the vertex or triangle; its zero-based index if the location is unknown.
    pub label: u64,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}", self.path.display(), self.location)
    }
}

impl MeshFile {
    /// Returns where vertex `index` has its coordinates. The index is zero-based, as in
    /// [`MeshFile::points`](crate::MeshFile::points).
    ///
    /// Meant for messages: it may search the whole file.
    ///
    /// # Panics
    /// If the mesh has no such vertex.
    pub fn vertex_place(&self, index: u32) -> Place {
        let found = self.vertex_places([index]).remove(&index);
        found.unwrap_or_else(|| panic!("vertex {index} of {}", self.points().len()))
    }

    /// Returns where vertices have their coordinates, by their zero-based indices. The file is searched once for all of
    /// them. Indices of vertices that do not exist are left out.
    pub fn vertex_places(&self, indices: impl IntoIterator<Item = u32>) -> BTreeMap<u32, Place> {
        let mut wanted: Vec<usize> = indices.into_iter().map(|v| v as usize).collect();
        keep_ascending(&mut wanted, self.points().len());
        let found = locate(self.reader(), self.source(), List::Nodes, &wanted);
        self.places(&wanted, found).map(|(v, place)| (v as u32, place)).collect()
    }

    /// Returns where triangle `index` lists its vertices. The index is zero-based, as in
    /// [`MeshFile::triangles`](crate::MeshFile::triangles).
    ///
    /// Meant for messages: it may search the whole file.
    ///
    /// # Panics
    /// If the mesh has no such triangle.
    pub fn triangle_place(&self, index: usize) -> Place {
        let found = self.triangle_places([index]).remove(&index);
        found.unwrap_or_else(|| panic!("triangle {index} of {}", self.triangles().len()))
    }

    /// Returns where triangles list their vertices, by their zero-based indices. The file is searched once for all of
    /// them. Indices of triangles that do not exist are left out.
    pub fn triangle_places(
        &self,
        indices: impl IntoIterator<Item = usize>,
    ) -> BTreeMap<usize, Place> {
        let mut wanted: Vec<usize> = indices.into_iter().collect();
        keep_ascending(&mut wanted, self.triangles().len());
        let found = locate(self.reader(), self.source(), List::Triangles, &wanted);
        self.places(&wanted, found).collect()
    }

    /// Returns the place of each of these items with the index of the item.
    fn places<'a>(
        &'a self,
        wanted: &'a [usize],
        found: Vec<ItemLocation>,
    ) -> impl Iterator<Item = (usize, Place)> + 'a {
        let source = self.source();
        wanted.iter().zip(found).map(move |(&index, ItemLocation { location, label, part })| {
            let path = source.files().nth(part).unwrap_or(source).path.clone();
            (index, Place { path, location, label })
        })
    }
}

/// Sorts indices, each once, and drops those that are not below `count`.
fn keep_ascending(indices: &mut Vec<usize>, count: usize) {
    indices.retain(|&index| index < count);
    indices.sort_unstable();
    indices.dedup();
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::detect;
    use crate::disk::source::Source;
    use crate::error::ReadError;
    use crate::visit::mesh_builder;
    use crate::visit::reader::ReaderFunctions;
    use crate::visit::storage::CoordinateStorage;
    use crate::visit::visitor::MeshVisitor;
    use std::panic::AssertUnwindSafe;
    use std::path::Path;
    use std::sync::atomic::{AtomicBool, Ordering};

    /// A second walk through a file may find other items than the first one only by a fault of a reader. Messages must come out
    /// even so.
    #[test]
    fn items_that_a_second_walk_does_not_find_have_a_place_without_a_line() {
        static READER: ReaderFunctions = ReaderFunctions {
            visit: |source, _| Err(source.error("no second walk", "")),
            load_companions: Ok,
            require_single: |_| Ok(()),
            destinations: |_, path| Ok(vec![path.to_owned()]),
            renames: |_, _| Vec::new(),
            vertices: "the list",
        };
        let text = b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
        let source = Source::new(Path::new("a.off"), text.to_vec()).unwrap();
        let reader = detect::reader(&source).unwrap();
        let parsed = mesh_builder::parse(reader, &source).unwrap();
        let file = MeshFile::new(parsed, &READER, source).unwrap();
        assert_eq!(file.vertex_place(2).to_string(), "a.off");
        assert_eq!(file.vertex_places([0, 2, 3]).into_keys().collect::<Vec<_>>(), [0, 2]);
        let place = Place { path: "a.off".into(), location: Location::Unknown, label: 0 };
        assert_eq!(file.triangle_place(0), place);
        let no_triangle = AssertUnwindSafe(|| file.triangle_place(1));
        assert!(std::panic::catch_unwind(no_triangle).is_err());
    }

    /// The reader of this test comes to no node in its second walk.
    #[test]
    fn a_coordinate_beyond_single_precision_is_an_error_even_if_its_place_is_not_found() {
        static WALKED: AtomicBool = AtomicBool::new(false);
        fn walk(
            source: &Source,
            visitor: &mut dyn MeshVisitor,
        ) -> Result<CoordinateStorage, ReadError> {
            if WALKED.swap(true, Ordering::SeqCst) {
                return Err(source.error("no second walk", ""));
            }
            (detect::reader(source)?.visit)(source, visitor)
        }
        static READER: ReaderFunctions = ReaderFunctions {
            visit: walk,
            load_companions: Ok,
            require_single: |_| Ok(()),
            destinations: |_, path| Ok(vec![path.to_owned()]),
            renames: |_, _| Vec::new(),
            vertices: "the list",
        };
        let text = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
            element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1e39 0 0\n0 1 0\n3 0 1 2\n";
        let source = Source::new(Path::new("a.ply"), text.into()).unwrap();
        let error = mesh_builder::parse(&READER, &source).err().unwrap().to_string();
        assert!(error.starts_with("a.ply: a coordinate of vertex 1 is too large"), "{error}");
    }
}
