//! Reads 2D triangle meshes in some 20 file formats, writes them again with nothing changed but moved vertices, and converts
//! them.
//!
//! [`MeshFile::read`] finds the format by the content of a file. A [`MeshFile`] never changes: it reports points, triangles,
//! regions, [`Groups`], data of vertices ([`PointField`]) and [`Constraints`], and [`MeshFile::write`] writes the file with
//! vertices at other points. A [`Conversion`] writes the mesh in another [`Format`], and lists what that format does not
//! hold. [`atomic`] replaces any file safely.
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

mod abaqus;
mod adcirc;
#[cfg(test)]
mod ahead_tests;
mod assemble;
mod beside;
mod binary;
mod card;
mod centers;
mod cgns;
mod column;
mod compare;
mod constraints;
mod container;
mod continued;
mod convert;
mod detect;
mod disk;
mod error;
mod exodus;
mod families;
#[cfg(test)]
mod faults;
mod field;
mod field_text;
mod fields;
mod format;
mod freefem;
mod fvcom;
mod gather;
mod gmsh;
mod group;
mod group_table;
mod hdf5;
mod heights;
mod jigsaw;
mod label;
mod layout;
mod med;
mod medit;
mod meditb;
mod mesh_file;
mod mfem;
mod mike;
mod named;
mod nastran;
mod netcdf;
mod numbered_nodes;
mod numbers;
mod obj;
mod off;
mod packed;
mod parallel;
mod parallel_rows;
mod parameters;
mod parametric;
mod parsed;
mod place;
mod ply;
mod point_data;
mod precision;
mod read;
mod records;
mod regions;
mod replace;
mod rewrite;
mod save;
mod selafin;
mod sink;
mod sms;
mod solution;
mod source;
mod stl;
mod su2;
mod su2_motions;
mod syntax;
mod tags;
mod text;
mod text_numbers;
mod token;
mod triangle;
mod triangle_data;
mod triangle_groups;
mod triangle_names;
mod ugrid;
mod view;
mod vtk;
mod vtu;
mod whole;
mod xdmf;

pub use compare::Difference;
pub use constraints::{Affine, Constraints, PeriodicPairs};
pub use convert::Conversion;
pub use error::{FieldError, GroupError, Location, ReadError, WriteError};
pub use field::PointField;
pub use format::Format;
pub use group::{Group, Groups};
pub use mesh_file::MeshFile;
pub use place::Place;
pub use precision::Precision;
pub use solution::Solution;
pub use view::View;

/// Replaces whole files safely: a file has either its old content or all of the new content, whatever happens.
pub mod atomic {
    pub use crate::replace::{AbandonedWrites, abandon_writes, check, replace, same_file};
}

/// Compiles the code of the README with the tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}
