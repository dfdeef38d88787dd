//! The mesh of a file, with the vertices that stay by the facts of the file.

use gpu_smooth::Mesh;
use mesh_io::MeshFile;

/// The mesh of a file, with the vertices that stay by the facts of the file.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Domain {
    /// Points and triangles of the file. Fixed are the vertices that the file constrains, followed by
    /// [`interfaces`](Self::interfaces).
    pub mesh: Mesh,
    /// Vertices fixed only because they lie between regions, ascending. They are the last entries of the mesh's fixed
    /// vertices.
    pub interfaces: Vec<u32>,
    /// Vertices that neither move nor slide. In any order, with repeats.
    pub anchored: Vec<u32>,
}

impl Domain {
    /// Makes the mesh of a file. Constrained vertices and vertices between regions are fixed.
    pub fn of_file(file: &MeshFile) -> Self {
        let constraints = file.constraints();
        let mut fixed = constraints.vertices.clone();
        let mut interfaces = file.interface_vertices();
        let mut is_fixed = vec![false; file.points().len()];
        for &v in &fixed {
            if let Some(is_fixed) = is_fixed.get_mut(v as usize) {
                *is_fixed = true;
            }
        }
        interfaces.retain(|&v| !is_fixed[v as usize]);
        fixed.extend_from_slice(&interfaces);
        let (points, triangles) = (file.points().to_vec(), file.triangles().to_vec());
        let mesh = Mesh { points, triangles, fixed };
        Self { mesh, interfaces, anchored: constraints.anchored.clone() }
    }
}
