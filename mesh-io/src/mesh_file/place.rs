//! Finds where a file has its vertices and triangles, for messages.

use crate::error::Location;
use crate::mesh_file::mesh::MeshFile;
use crate::visit::assemble;
use std::collections::BTreeMap;
use std::fmt;
use std::path::PathBuf;

/// Where a vertex or triangle stands in its file. Displayed as `la.1.ele:18`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The file.
    pub path: PathBuf,
    /// The line or byte.
    pub location: Location,
    /// The file's own number or tag of the vertex or triangle.
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
    /// If there is no such vertex.
    pub fn vertex_place(&self, index: u32) -> Place {
        let found = self.vertex_places([index]).remove(&index);
        found.unwrap_or_else(|| panic!("there is no vertex {index}"))
    }

    /// Returns where vertices have their coordinates, by their zero-based indices. The file is searched once for all of
    /// them. Indices of vertices that do not exist are left out.
    pub fn vertex_places(&self, indices: impl IntoIterator<Item = u32>) -> BTreeMap<u32, Place> {
        let mut wanted: Vec<usize> = indices.into_iter().map(|v| v as usize).collect();
        keep_ascending(&mut wanted, self.points().len());
        let source = self.source();
        let found = assemble::vertex_places(self.reader(), source, &wanted);
        let place = |(location, label, part)| {
            let path = source.parts().nth(part).unwrap_or(source).path.clone();
            Place { path, location, label }
        };
        wanted.iter().map(|&v| v as u32).zip(found.into_iter().map(place)).collect()
    }

    /// Returns where triangle `index` lists its vertices. The index is zero-based, as in
    /// [`MeshFile::triangles`](crate::MeshFile::triangles).
    ///
    /// Meant for messages: it may search the whole file.
    ///
    /// # Panics
    /// If there is no such triangle.
    pub fn triangle_place(&self, index: usize) -> Place {
        let found = self.triangle_places([index]).remove(&index);
        found.unwrap_or_else(|| panic!("there is no triangle {index}"))
    }

    /// Returns where triangles list their vertices, by their zero-based indices. The file is searched once for all of
    /// them. Indices of triangles that do not exist are left out.
    pub fn triangle_places(
        &self,
        indices: impl IntoIterator<Item = usize>,
    ) -> BTreeMap<usize, Place> {
        let mut wanted: Vec<usize> = indices.into_iter().collect();
        keep_ascending(&mut wanted, self.triangles().len());
        let source = self.source();
        let found = assemble::triangle_places(self.reader(), source, &wanted);
        let place = |(location, label, part)| {
            let path = source.parts().nth(part).unwrap_or(source).path.clone();
            Place { path, location, label }
        };
        wanted.iter().copied().zip(found.into_iter().map(place)).collect()
    }
}

/// Sorts indices, each once, and drops those that are not below `count`.
fn keep_ascending(indices: &mut Vec<usize>, count: usize) {
    indices.retain(|&index| index < count);
    indices.sort_unstable();
    indices.dedup();
}
