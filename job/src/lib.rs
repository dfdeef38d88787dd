//! Smooths mesh files. A [`Job`] takes the facts that matter for a run from the file: vertices that the file fixes,
//! vertices between regions, the plane of the mesh, and the precision in which the file stores coordinates.
//!
//! The crate joins `gpu-smooth`, which reads no files, and `mesh-io`, which knows no smoother.
//!
//! ```no_run
//! use std::path::Path;
//!
//! use gpu_smooth::{Backend, Options};
//! use gpu_smooth_job::Job;
//! use mesh_io::MeshFile;
//!
//! let file = MeshFile::read(Path::new("in.bdf"))?;
//! let smoothed = Job::of_file(&file)?.smooth(&Options::default(), &Backend::Cpu)?;
//! smoothed.write(Path::new("out.bdf"))?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod domain;
mod error;
mod job;
mod plane;
mod precision;

pub use domain::Domain;
pub use error::{JobError, PlaneError};
pub use job::{Job, Smoothed};
pub use plane::{plane_of_file, points_in_space, z_field};
pub use precision::smoother_precision;
