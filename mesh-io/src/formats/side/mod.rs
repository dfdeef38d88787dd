//! Files with data for the vertices of a mesh in another file: gmsh views and Medit solutions.

pub(crate) mod gmsh_view;
pub(crate) mod medit_solution;
