//! Meshes of the command line: the content of a file, and the selection of movable vertices.

pub(crate) mod conversion;
mod depths;
pub(crate) mod destination;
pub(crate) mod explain;
mod fields;
mod fixed;
mod layers;
mod mesh;
mod movable;
mod named;
pub(crate) mod overwrite;
mod place;
mod plane;
pub(crate) mod remarks;
mod slide;
pub(crate) mod streams;
mod surface;
mod targets;
mod walls;

pub(crate) use depths::depths;
pub(crate) use fields::InterpolatedFields;
pub(crate) use fixed::{FixedBy, nothing_free};
pub(crate) use mesh::LoadedMesh;
pub(crate) use movable::MovableSelection;
pub(crate) use place::{Place, placed};
pub(crate) use plane::axes_legend;
pub(crate) use slide::{SlidingVertices, stay_as_ends};
pub(crate) use surface::{as_in_file, lay_out};
pub(crate) use walls::{wall_edges, walls};
