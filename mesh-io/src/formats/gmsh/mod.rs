//! gmsh's `.msh`, versions 1 (ASCII alone), 2.2, 4.0 and 4.1, in ASCII and in binary.
//!
//! The formats: <https://gmsh.info/doc/texinfo/gmsh.html#Gmsh-file-formats>. Reading a mesh requires only
//! `$MeshFormat`, `$Nodes` and `$Elements`. `$PhysicalNames` and `$Entities`, which lists the physical groups of each
//! entity from version 4 on, are read only for groups. Regions do not depend on these sections, as all triangles of an
//! entity have the same physical groups.

mod binary2;
mod binary4;
mod binary40;
mod data;
mod encoding;
mod ghosts;
mod kind;
mod lists;
mod model;
mod periodic;
mod reader;
mod repeats;
mod text2;
mod text4;
mod text40;
mod words;
pub(crate) mod write;

pub(crate) use reader::Gmsh;
