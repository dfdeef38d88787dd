//! Files that give data to the vertices of a mesh in another file: views of gmsh and solutions of Medit.

pub(crate) mod gmsh_view;
pub(crate) mod medit_solution;
