//! Seeded meshes and checks of meshes: the files of the top folder's `tests/support` that need no smoother, with a mesh
//! type of this crate.
#![allow(dead_code, unreachable_pub, unused_imports)]

#[path = "../../../tests/support/binary.rs"]
pub mod binary;
#[path = "../../../tests/support/boundaries.rs"]
pub mod boundaries;
#[path = "../../../tests/support/check.rs"]
pub mod check;
#[path = "../../../tests/support/disturb.rs"]
pub mod disturb;
#[path = "../../../tests/support/generate.rs"]
pub mod generate;
#[path = "../../../tests/support/outline.rs"]
pub mod outline;
#[path = "../../../tests/support/rearrange.rs"]
pub mod rearrange;
#[path = "../../../tests/support/regions.rs"]
pub mod regions;
#[path = "../../../tests/support/rng.rs"]
pub mod rng;
#[path = "../../../tests/support/tangle.rs"]
pub mod tangle;
#[path = "../../../tests/support/trig.rs"]
pub mod trig;
#[path = "../../../tests/support/write.rs"]
pub mod write;

pub use mesh_io::Precision;

/// A 2D triangle mesh.
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
pub use regions::write_regions;
pub use rng::SplitMix64;
pub use write::{triangle_text, write_msh22, write_msh41, write_triangle};
