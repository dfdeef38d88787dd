//! Meshes of the mesh generator Triangle, in files that end in `.node`, `.ele` and `.poly`.

pub(crate) mod content;
pub(crate) mod data;
pub(crate) mod groups;
pub(crate) mod mesh;
pub(crate) mod names;
pub(crate) mod write;

pub(crate) use data::point_data;
pub(crate) use groups::groups;
pub(crate) use mesh::{parse, triangle_places, vertex_places};
