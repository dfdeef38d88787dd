//! Facts of a file as a program that moves vertices uses them: fixed vertices and remarks.

use mesh_io::MeshFile;
use support::Mesh;

/// Returns the vertices inside the mesh between triangles of different regions that no other constraint holds,
/// ascending.
pub(crate) fn between_regions(file: &MeshFile) -> Vec<u32> {
    let constrained = &file.constraints().vertices;
    let mut between = file.interface_vertices();
    between.retain(|v| !constrained.contains(v));
    between
}

/// Returns the vertices that a program would fix: constrained vertices, then vertices between regions.
pub(crate) fn fixed(file: &MeshFile) -> Vec<u32> {
    [file.constraints().vertices.clone(), between_regions(file)].concat()
}

/// Returns the mesh of a file with the vertices that a program would fix.
pub(crate) fn mesh_of(file: &MeshFile) -> Mesh {
    let (points, triangles) = (file.points().to_vec(), file.triangles().to_vec());
    Mesh { points, triangles, fixed: fixed(file), ..Mesh::default() }
}

/// Returns the mesh of a file with its constrained vertices fixed. Vertices between regions are free.
pub(crate) fn freed(file: &MeshFile) -> Mesh {
    Mesh { fixed: file.constraints().vertices.clone(), ..mesh_of(file) }
}

/// Returns the remarks on a file, in words.
pub(super) fn remarks(file: &MeshFile) -> Vec<String> {
    file.remarks().iter().map(ToString::to_string).collect()
}
