//! Reads 2D meshes in many file formats, rewrites files with moved vertices and no other change, and converts
//! meshes.
//!
//! [`MeshFile::read`] detects the format by the content of a file. A [`MeshFile`] never changes: it reports points,
//! triangles, regions, [`Groups`], data of vertices ([`PointField`]), [`Constraints`], and the whole mesh as
//! [`Content`], and [`MeshFile::write`] writes the file with vertices at other points. A [`Conversion`] writes the mesh
//! in another [`Format`], and lists the losses. [`atomic`] replaces any file safely.
//!
//! ```no_run
//! use mesh_io::MeshFile;
//! use std::path::Path;
//!
//! let file = MeshFile::read(Path::new("in.msh"))?;
//! let moved: Vec<[f64; 2]> = file.points().iter().map(|[x, y]| [x + 1.0, *y]).collect();
//! file.write(Path::new("out.msh"), &moved)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod binary;
mod compress;
mod content;
mod convert;
mod detect;
mod disk;
mod edit;
mod error;
mod export;
mod format;
mod formats;
mod hdf5;
mod mesh_file;
mod netcdf;
mod parallel;
mod precision;
mod registry;
mod text;
mod visit;
mod xml;

pub use crate::content::constraints::{Affine, Constraints, PeriodicPairs, edges_between_regions};
pub use crate::content::group::{Group, Groups};
pub use crate::content::regions::{interface_vertices, interfaces};
pub use crate::content::remark::Remark;
pub use crate::convert::{Conversion, Encoding};
pub use crate::disk::source::ReadOptions;
pub use crate::error::{FieldError, GroupError, Location, ReadError, WriteError};
pub use crate::export::content::{Cell, Content, ContentGroup, DataArray};
pub use crate::format::Format;
pub use crate::formats::side::gmsh_view::GmshView;
pub use crate::formats::side::medit_solution::MeditSolution;
pub use crate::mesh_file::diff::Difference;
pub use crate::mesh_file::locate::SourceLocation;
pub use crate::mesh_file::mesh::MeshFile;
pub use crate::precision::Precision;
pub use crate::visit::field::PointField;
pub use crate::visit::items::CellKind;

/// Safe replacement of whole files: whatever happens, a file has either its old content or all of the new content.
pub mod atomic {
    pub use crate::disk::atomic::{BlockedWrites, discard_pending_writes, ensure_writable, write};
    pub use crate::disk::paths::same_file;
}

/// Compiles the code examples of the README as doc tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}
