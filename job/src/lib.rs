//! Smooths mesh files. A [`Job`] takes the facts that matter for a run from the file: vertices that the file fixes,
//! vertices between regions, the plane of the mesh, and the precision in which the file stores coordinates.
//!
//! The crate joins `gpu-smooth`, which reads no files, and `mesh-io`, which knows no smoother. It is the set-up of a run that the
//! command line, the Python package and Rust programs share: a [`Domain`] has the vertices that stay or slide, a
//! [`TargetRequest`] the desired elements, and [`GivenOptions`](options::GivenOptions) the options as users give them. With equal
//! options, a job writes the bytes that the command line writes:
//!
//! ```no_run
//! # use std::path::Path;
//! # use gpu_smooth::Backend;
//! # use gpu_smooth_job::options::GivenOptions;
//! # use gpu_smooth_job::{Job, TargetKind, TargetRequest};
//! # use mesh_io::MeshFile;
//! // gpu-smooth in.msh out.msh --engine cpu --slide --target keep-size --max-sweeps 50
//! let file = MeshFile::read(Path::new("in.msh"))?;
//! let target = TargetRequest { kind: TargetKind::KeepSize, ..TargetRequest::default() };
//! let given = GivenOptions::of(&[("slide", "true"), ("max-sweeps", "50")])?;
//! let job = Job::of_file(&file)?.target(target).settings(given.settings())?;
//! let options = job.options(&given.settings().run);
//! job.smooth(&options, &Backend::Cpu)?.write(Path::new("out.msh"))?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
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

mod checkpoint;
mod domain;
mod error;
mod facts;
mod job;
mod moved;
pub mod options;
mod plane;
mod precision;
mod run;
mod target;

pub use checkpoint::{CheckpointFile, CheckpointWriter, Occupant};
pub use domain::{Curves, Domain, NearBad, SlideBy};
pub use error::{JobError, PlaneError};
pub use facts::{
    Adapted, RiseReason, WorstEffect, WorstRise, cost_in_percent, is_at_wall, look_like_degrees,
    overlooks_boundary, overlooks_wall, vertices_in_rows,
};
pub use job::{Job, Smoothed};
pub use moved::moved_fixed_vertex;
pub use plane::{plane_of_file, points_in_space, z_field};
pub use precision::smoother_precision;
pub use run::{EngineRequest, MethodName, RunRequest};
pub use target::{TargetFacts, TargetKind, TargetRequest, TargetSource};
