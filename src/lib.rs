//! Moves the interior vertices of 2D meshes so that their triangles and quadrilaterals get better shapes, and never
//! inverts one. Sweeps visit the vertices, one color at a time, with feasible Newton steps, in wgpu
//! compute shaders or on the CPU.
//!
//! The method is that of J. Park and S. M. Shontz, *An Alternating Mesh Quality Metric Scheme for
//! Efficient Mesh Quality Improvement*, Procedia Computer Science 4 (2011) 292-301: the objective
//! f = (1/n) Σ q² over all elements is lowered vertex by vertex, the boundary held fixed, and the
//! metric q may change from sweep to sweep.
//!
//! ```
//! use std::ops::ControlFlow;
//! use gpu_smooth::{Backend, Mesh, Metric, Options, Quality, Smoother};
//!
//! // A square with one vertex inside, badly placed.
//! let mesh = Mesh {
//!     points: vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.9, 0.2]],
//!     triangles: vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]],
//!     fixed: vec![],
//!     ..Mesh::default()
//! };
//! let smoother = Smoother::new(&mesh)?;
//! let backend = Backend::Cpu; // or Backend::Gpu(Gpu::open(None).block()?), or what Backend::auto chooses
//! let outcome = smoother.run(&Options::default()).on(&backend).block()?;
//! let [x, y] = outcome.points[4];
//! assert!((x - 0.5).abs() < 1e-3 && (y - 0.5).abs() < 1e-3);
//! assert!(Quality::of(&outcome.points, smoother.topology())?.f(Metric::Imr) < 1.3334);
//! # Ok::<(), gpu_smooth::SmoothError>(())
//! ```
//!
//! A `Gpu` is opened once and serves every mesh. A [`Smoother`] is one prepared mesh, and serves any number of runs
//! while the triangles stay the same. A run is one call of [`Smoother::run`] with [`Options`], and returns an
//! [`Outcome`]. An [`Interpolation`](interpolate::Interpolation) evaluates vertex data at the new positions. Vertices
//! listed in [`Mesh::fixed`] do not move; [`select`](front_ends::select) helps to list them.
//! [`Measured`](measure::Measured) evaluates elements by each [`Measure`](measure::Measure) of the field, and
//! [`Quality`] compares a mesh before and after smoothing. The crate `mesh-io` reads and writes mesh files, and the crate `gpu-smooth-job` sets runs of such files up as the
//! command line does.
//!
//! The feature `gpu`, which is on by default, adds the GPU engine: `Gpu`, all else that computes on a device, and the
//! dependency wgpu. Without the feature, every run uses the CPU engine.
//!
#![cfg_attr(feature = "gpu", doc = include_str!("gpu/application.md"))]
//!
//! # Modules
//!
//! | module | contents |
//! |---|---|
//! | the root | meshes, runs, [`Options`] and its common types, errors, [`Untangle`] |
//! | [`options`] | all types of [`Options`], also those of single methods ([`Relaxed`](options::Relaxed), [`Paper`](options::Paper), [`PNormExponent`](options::PNormExponent)), of the worst triangles ([`WorstBy`](options::WorstBy)) and of stored coordinates ([`Precision`](options::Precision)), and the ranges of numbers |
//! | [`topology`] | exact signs of triangles without a run: [`infeasible`](topology::infeasible), [`certify`](topology::certify), boundary loops |
//! | [`outcome`], [`measure`] | results: the parts of an [`Outcome`]; measures of the field, for [`Smoother::topology`] and any points |
//! | [`targets`], [`slide`], [`layers`], [`untangle`], [`interpolate`] | types of single tasks |
//! | `gpu` | devices, and meshes that stay on a device |
//! | [`front_ends`] | for programs that offer runs to users: the choice of a backend, planes of space, selection of vertices |
//!
//! The type `Precision` of `mesh-io` describes the numbers of a file; `smoother_precision` of `gpu-smooth-job` converts it to
//! that of [`options`].
//!
//! # Limits
//!
//! Triangles and quadrilaterals; list vertices of other elements in [`Mesh::fixed`]. Vertices and corners are
//! numbered by 32 bits: fewer than 2³² - 1 vertices and (2³² - 1) / 3 triangles. A mesh in another plane of space than
//! that of x and y is smoothed in the coordinates of its [`Plane`](front_ends::Plane).
//!
//! On a GPU, buffers that exceed the largest binding of a device are bound part by part, which changes no bit of sweeps and
//! corrections. Newton steps of all vertices need their Hessian in one binding, some 100 to 150 bytes a vertex, and the
//! acceleration of corrections 40 bytes; on a device with smaller bindings, runs do without. Every kernel needs all positions, in two bindings at most: a device with a largest binding of 128 MiB
//! takes 16 million vertices. `Gpu::check_size` checks the size of a mesh without allocating.

mod adapter;
mod chart;
mod cpu;
mod error;
pub mod front_ends;
#[cfg(feature = "gpu")]
pub mod gpu;
pub mod interpolate;
pub mod layers;
mod layout;
pub mod measure;
mod mesh;
pub mod metric;
pub mod options;
pub mod outcome;
mod parallel;
mod patch;
mod periodic;
mod plane;
mod precision;
mod quality;
mod resume;
mod run;
pub mod slide;
mod smoother;
pub mod targets;
pub mod topology;
pub mod untangle;
mod whole;
mod worst;

/// Compiles the code of docs/embedding.md with the tests.
#[cfg(all(doctest, feature = "gpu"))]
#[doc = include_str!("../docs/embedding.md")]
mod embedding {}

/// Functions for benchmarks, experiments and this library's own tests. They change without notice.
#[doc(hidden)]
pub mod internal;

pub use error::{CheckpointError, GpuError, MeshError, ResumeError, SmoothError};
pub use front_ends::BackendReason;
#[cfg(feature = "gpu")]
pub use gpu::Gpu;
pub use mesh::{Element, Mesh, MeshSize};
pub use metric::{Metric, Scheme};
pub use options::{Goal, Guard, Method, OptionError, Options, Stopping};
pub use outcome::Outcome;
pub use quality::Quality;
pub use run::{Checkpoint, CheckpointPolicy, Observer, Phase, Progress, Stop};
pub use slide::Slide;
pub use smoother::{Backend, Run, Smoother, smooth};
pub use targets::{TargetField, Targets};
pub use topology::{DetachedTopology, Topology};
pub use untangle::Untangle;
#[cfg(feature = "gpu")]
pub use wgpu;
