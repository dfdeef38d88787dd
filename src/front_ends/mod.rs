//! For programs that offer runs to users, such as a command line, a package for another language, or a graphical interface:
//! the choice of a backend for many meshes, meshes in planes of space and around the earth, and the selection of vertices by
//! position and quality. An application with a plane mesh in memory needs none of these items.

mod choice;
pub mod select;

pub use crate::chart::Chart;
pub use crate::plane::{NotPlanar, Plane};
pub use choice::{BackendChooser, BackendReason};
