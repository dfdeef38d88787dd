//! Files that give data to the vertices of a mesh in another file: views of gmsh and solutions of Medit.

pub(crate) mod solution;
pub(crate) mod view;
