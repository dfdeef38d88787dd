//! Meshes with the bytes of their files: reading, rewriting, comparison, locations, groups and data.

pub(crate) mod center_functions;
mod centers;
mod content;
pub(crate) mod diff;
pub(crate) mod fields;
mod ghost_arrays;
pub(crate) mod groups;
pub(crate) mod locate;
pub(crate) mod mesh;
mod net_centers;
#[cfg(test)]
mod parallel_tests;
pub(crate) mod parameters;
pub(crate) mod parametric;
mod plane_centers;
pub(crate) mod read;
mod region_arrays;
pub(crate) mod rewrite;
