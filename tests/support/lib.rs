//! Generators of meshes with fixed seeds, and checks of meshes that are independent of the library.
//!
//! A crate of its own is compiled once for all tests, benchmarks and examples, and is optimized, as generators of large
//! meshes take longer unoptimized than most tests.

pub mod binary;
pub mod boundaries;
pub mod check;
pub mod disturb;
pub mod generate;
pub mod outline;
#[cfg(feature = "smoother")]
pub mod quadrilaterals;
pub mod rearrange;
pub mod recipe;
pub mod regions;
pub mod rng;
pub mod tangle;
pub mod trig;
pub mod write;

/// Returns the folder of the project's meshes. Where tests run outside of a checkout, `GPU_SMOOTH_MESHES` names it.
pub fn meshes() -> std::path::PathBuf {
    let checkout = concat!(env!("CARGO_MANIFEST_DIR"), "/../../meshes");
    std::env::var_os("GPU_SMOOTH_MESHES").map_or_else(|| checkout.into(), Into::into)
}

/// The mesh type of the library under test.
#[cfg(feature = "smoother")]
pub use gpu_smooth::Mesh;
pub use mesh_io::Precision;

/// A 2D triangle mesh, with the fields of the smoother's type.
#[cfg(not(feature = "smoother"))]
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// x and y of each vertex.
    pub points: Vec<[f64; 2]>,
    /// Vertex indices of each triangle, zero-based.
    pub triangles: Vec<[u32; 3]>,
    /// Vertices of elements other than triangles.
    pub fixed: Vec<u32>,
}

pub use binary::{Binary, write_msh22_binary, write_msh41_binary};
pub use check::{
    area, boundary, edge_uses, f_imr, is_ccw, is_valid, min_angle, mover_count, orientations,
    same_orientations, worst_imr,
};
pub use disturb::{distort_smooth, perturb_random};
pub use generate::{graded, hub, hub_evenly, lattice, layered, triangulate, wavy_layer};
pub use outline::Outline;
pub use rearrange::{renumbered, shuffled_windings, transformed};
pub use recipe::Recipe;
pub use regions::write_regions;
pub use rng::SplitMix64;
pub use write::{triangle_text, write_msh22, write_msh41, write_triangle};

/// Reads a mesh file. Vertices of elements other than triangles and vertices between regions are fixed.
pub fn read_mesh(path: &std::path::Path) -> Mesh {
    mesh_of(&mesh_io::MeshFile::read(path).unwrap())
}

/// Returns the mesh of a file. Vertices of elements other than triangles and vertices between regions are fixed.
pub fn mesh_of(file: &mesh_io::MeshFile) -> Mesh {
    let fixed = [file.constraints().vertices.clone(), file.interface_vertices()].concat();
    Mesh {
        points: file.points().to_vec(),
        triangles: file.triangles().to_vec(),
        fixed,
        ..Mesh::default()
    }
}
