//! Mesh files, which are read once and written with nothing changed but moved vertices.

mod binary;
mod compress;
mod content;
mod convert;
mod detect;
mod disk;
mod edit;
mod error;
mod export;
mod families;
mod format;
mod formats;
mod hdf5;
mod mesh_file;
mod netcdf;
mod parallel;
mod precision;
mod text;
mod visit;

pub use crate::content::constraints::{Affine, Constraints, PeriodicPairs};
pub use crate::content::group::{Group, Groups};
pub use crate::convert::Conversion;
pub use crate::error::{FieldError, GroupError, Location, ReadError, WriteError};
pub use crate::format::Format;
pub use crate::formats::side::solution::Solution;
pub use crate::formats::side::view::View;
pub use crate::mesh_file::compare::Difference;
pub use crate::mesh_file::mesh::MeshFile;
pub use crate::mesh_file::place::Place;
pub use crate::precision::Precision;
pub use crate::visit::field::PointField;

/// Replaces whole files safely: a file has either its old content or all of the new content, whatever happens.
pub mod atomic {
    pub use crate::disk::replace::{AbandonedWrites, abandon_writes, check, replace, same_file};
}
