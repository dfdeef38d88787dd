//! Locations of vertices and triangles in a mesh file, for messages.

use crate::error::Location;
use crate::mesh_file::mesh::MeshFile;
use crate::visit::locate::{ItemList, ItemLocation, locate};
use std::collections::BTreeMap;
use std::fmt;
use std::path::PathBuf;

/// Location of a vertex or triangle in a mesh file: path, line or byte, and id. Displayed as `la.1.ele:18`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SourceLocation {
    /// The file.
    pub path: PathBuf,
    /// The line or byte, or [`Location::Unknown`] if a second reading of the file does not find the item.
    pub location: Location,
    /// Id of the vertex or triangle in the file; the 0-based index if the location is unknown.
    pub id: u64,
}

impl fmt::Display for SourceLocation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}", self.path.display(), self.location)
    }
}

impl MeshFile {
    /// Returns the location of a vertex's coordinates in the file. `index` is the 0-based index in
    /// [`MeshFile::points`](crate::MeshFile::points).
    ///
    /// Meant for messages: the method may search the whole file.
    ///
    /// # Panics
    /// Panics if `index` is out of range for the mesh's vertices.
    pub fn vertex_location(&self, index: u32) -> SourceLocation {
        let found = self.vertex_locations([index]).remove(&index);
        found.unwrap_or_else(|| panic!("vertex {index} of {}", self.points().len()))
    }

    /// Returns the locations of the coordinates of vertices, by 0-based index. A single reading of the file finds all
    /// locations. Indices out of range are left out.
    pub fn vertex_locations(
        &self,
        indices: impl IntoIterator<Item = u32>,
    ) -> BTreeMap<u32, SourceLocation> {
        let mut wanted: Vec<usize> = indices.into_iter().map(|v| v as usize).collect();
        keep_ascending(&mut wanted, self.points().len());
        let found = locate(self.reader(), self.source(), ItemList::Nodes, &wanted);
        self.locations(&wanted, found).map(|(v, place)| (v as u32, place)).collect()
    }

    /// Returns the location of a triangle's vertices in the file. `index` is the 0-based index in
    /// [`MeshFile::triangles`](crate::MeshFile::triangles).
    ///
    /// Meant for messages: the method may search the whole file.
    ///
    /// # Panics
    /// Panics if `index` is out of range for the mesh's triangles.
    pub fn triangle_location(&self, index: usize) -> SourceLocation {
        let found = self.triangle_locations([index]).remove(&index);
        found.unwrap_or_else(|| panic!("triangle {index} of {}", self.triangles().len()))
    }

    /// Returns the locations of the vertex lists of triangles, by 0-based index. A single reading of the file finds all
    /// locations. Indices out of range are left out.
    pub fn triangle_locations(
        &self,
        indices: impl IntoIterator<Item = usize>,
    ) -> BTreeMap<usize, SourceLocation> {
        let mut wanted: Vec<usize> = indices.into_iter().collect();
        keep_ascending(&mut wanted, self.triangles().len());
        let found = locate(self.reader(), self.source(), ItemList::Triangles, &wanted);
        self.locations(&wanted, found).collect()
    }

    /// Returns the locations of the vertex lists of quadrilaterals, by 0-based index among those of four different vertices
    /// ([`proper_quadrilaterals`](crate::MeshFile::proper_quadrilaterals)). A single reading of the file finds all locations.
    /// Indices out of range are left out.
    pub fn quadrilateral_locations(
        &self,
        indices: impl IntoIterator<Item = usize>,
    ) -> BTreeMap<usize, SourceLocation> {
        let mut wanted: Vec<usize> = indices.into_iter().collect();
        let of_file: Vec<usize> = self.proper_quadrilaterals().map(|(index, _)| index).collect();
        keep_ascending(&mut wanted, of_file.len());
        let places: Vec<usize> = wanted.iter().map(|&index| of_file[index]).collect();
        let found = locate(self.reader(), self.source(), ItemList::Quadrilaterals, &places);
        self.locations(&wanted, found).collect()
    }

    /// Pairs each index in `wanted` with its location, completed by the path of the file.
    fn locations<'a>(
        &'a self,
        wanted: &'a [usize],
        found: Vec<ItemLocation>,
    ) -> impl Iterator<Item = (usize, SourceLocation)> + 'a {
        let source = self.source();
        wanted.iter().zip(found).map(
            move |(&index, ItemLocation { location, id: label, file_index })| {
                let path = source.files().nth(file_index).unwrap_or(source).path.clone();
                (index, SourceLocation { path, location, id: label })
            },
        )
    }
}

/// Sorts indices, and removes repeated indices and indices of `count` or more.
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

    /// Only a defect of a reader can make a second reading find other items than the first reading. Messages must then
    /// lack a line, but appear.
    #[test]
    fn items_that_a_second_reading_does_not_find_have_a_location_without_a_line() {
        static READER: ReaderFunctions = ReaderFunctions {
            visit: |source, _| Err(source.error("no second reading", "")),
            load_companions: Ok,
            require_single: |_| Ok(()),
            destinations: |_, path| Ok(vec![path.to_owned()]),
            renames: |_, _| Vec::new(),
            vertices: "the list",
            names_other_lines: false,
        };
        let text = b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
        let source = Source::new(Path::new("a.off"), text.to_vec()).unwrap();
        let reader = detect::reader(&source).unwrap();
        let parsed = mesh_builder::parse(reader, &source).unwrap();
        let file = MeshFile::new(parsed, &READER, source).unwrap();
        assert_eq!(file.vertex_location(2).to_string(), "a.off");
        assert_eq!(file.vertex_locations([0, 2, 3]).into_keys().collect::<Vec<_>>(), [0, 2]);
        let place = SourceLocation { path: "a.off".into(), location: Location::Unknown, id: 0 };
        assert_eq!(file.triangle_location(0), place);
        let no_triangle = AssertUnwindSafe(|| file.triangle_location(1));
        assert!(std::panic::catch_unwind(no_triangle).is_err());
    }

    /// The second reading fails before the first node.
    #[test]
    fn a_coordinate_beyond_single_precision_is_an_error_even_if_its_place_is_not_found() {
        static WAS_READ: AtomicBool = AtomicBool::new(false);
        fn visit(
            source: &Source,
            visitor: &mut dyn MeshVisitor,
        ) -> Result<CoordinateStorage, ReadError> {
            if WAS_READ.swap(true, Ordering::SeqCst) {
                return Err(source.error("no second reading", ""));
            }
            (detect::reader(source)?.visit)(source, visitor)
        }
        static READER: ReaderFunctions = ReaderFunctions {
            visit,
            load_companions: Ok,
            require_single: |_| Ok(()),
            destinations: |_, path| Ok(vec![path.to_owned()]),
            renames: |_, _| Vec::new(),
            vertices: "the list",
            names_other_lines: false,
        };
        let text = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
            element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1e39 0 0\n0 1 0\n3 0 1 2\n";
        let source = Source::new(Path::new("a.ply"), text.into()).unwrap();
        let error = mesh_builder::parse(&READER, &source).err().unwrap().to_string();
        assert!(error.starts_with("a.ply: a coordinate of vertex 1 is too large"), "{error}");
    }
}
