//! Medit meshes: `.mesh` files of text and `.meshb` files of binary numbers.

mod beside;
pub(crate) mod binary;
mod required;
pub(crate) mod text;
pub(crate) mod write;
