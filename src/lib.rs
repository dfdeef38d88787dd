//! Moves the interior vertices of 2D triangle meshes until the elements are as good as they can be,
//! without ever inverting one. It sweeps over the vertices, one color at a time, with feasible Newton
//! steps, in wgpu compute shaders or on the CPU.
//!
//! The method is that of J. Park and S. M. Shontz, *An Alternating Mesh Quality Metric Scheme for
//! Efficient Mesh Quality Improvement*, Procedia Computer Science 4 (2011) 292-301: the objective
//! f = (1/n) Σ q² over all triangles is lowered vertex by vertex, the boundary held fixed, and the
//! metric q may change from sweep to sweep.
//!
//! ```
//! use std::ops::ControlFlow;
//! use gpu_smooth::{Backend, Mesh, Metric, Options, Smoother};
//!
//! // A square with one vertex inside, badly placed.
//! let mesh = Mesh {
//!     points: vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.9, 0.2]],
//!     triangles: vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]],
//!     fixed: vec![],
//! };
//! let smoother = Smoother::new(&mesh)?;
//! let backend = Backend::Cpu; // or Backend::Gpu(Gpu::open(None)?), or what Backend::auto chooses
//! let outcome = smoother.run(&Options::default(), &backend)?;
//! let [x, y] = outcome.points[4];
//! assert!((x - 0.5).abs() < 1e-3 && (y - 0.5).abs() < 1e-3);
//! assert!(smoother.quality(&outcome.points)?.f(Metric::Imr) < 1.3334);
//! # Ok::<(), gpu_smooth::SmoothError>(())
//! ```
//!
//! A `Gpu` is opened once and serves every mesh. A [`Smoother`] is one prepared mesh, and serves any number of runs
//! while the triangles stay the same. A run is one call of [`Smoother::run`] with [`Options`], and returns an
//! [`Outcome`]. An [`Interpolation`] takes data of vertices to their new positions. Vertices listed in [`Mesh::fixed`] do
//! not move; [`select`] helps to list them. [`Measured`] evaluates triangles by each [`Measure`] of the field, and
//! [`Quality`] compares a mesh before and after smoothing. The crate `mesh-io` reads and writes mesh files.
//!
//! The feature `gpu`, which is on by default, adds the GPU engine: `Gpu`, all else that computes on a device, and the
//! dependency wgpu. Without the feature, all runs are on the CPU.
//!
#![cfg_attr(feature = "gpu", doc = include_str!("gpu/application.md"))]
//!
//! # Limits
//!
//! Triangles only; list vertices of other elements in [`Mesh::fixed`]. Vertices and triangle corners are
//! numbered by 32 bits: fewer than 2³² - 1 vertices and (2³² - 1) / 3 triangles.
//!
//! On a GPU, buffers that are larger than a device can bind at once are bound part by part, which changes no bit of the
//! result. But every kernel needs all positions, in two bindings at most: a device that binds 128 MiB at once takes 16
//! million vertices. `Gpu::check_size` checks this without allocating.

mod adapter;
mod chart;
mod choice;
mod cpu;
mod error;
#[cfg(feature = "gpu")]
pub mod gpu;
mod interpolate;
mod layout;
mod measure;
mod mesh;
mod metric;
mod outcome;
mod parallel;
mod patch;
mod periodic;
mod precision;
mod quality;
mod resume;
mod run;
pub mod select;
mod slide;
mod smoother;
mod targets;
mod topology;
mod untangle;
mod whole;
mod worst;

/// Exact checks for inverted and flat triangles.
pub mod validity {
    pub use crate::topology::{certify, infeasible};
}

/// Compiles the code of docs/embedding.md with the tests.
#[cfg(all(doctest, feature = "gpu"))]
#[doc = include_str!("../docs/embedding.md")]
mod embedding {}

/// Functions for benchmarks, experiments and this library's own tests. They change without notice.
#[doc(hidden)]
pub mod internal;

pub use chart::Chart;
pub use choice::Reason;
pub use error::{BadTriangle, GpuError, MeshError, SmoothError};
#[cfg(feature = "gpu")]
pub use gpu::{
    BoundMask, BoundMove, BoundObjective, BoundVertices, Budget, DeviceMesh, Gpu, LastValid,
    ObjectiveValues, Readback, Sweeps, Timestamps, UntanglingSweeps, VertexBuffer,
};
pub use interpolate::Interpolation;
pub use measure::{
    Better, Change, Definition, Measure, Measured, QUANTILES, Spread, Statistics, UnknownMeasure,
};
pub use mesh::{Mesh, MeshSize};
pub use metric::{Corner, Metric, Properties, Scheme, UnknownMetric};
pub use outcome::{DeviceFault, GoalOutcome, Improved, Outcome, Slid};
pub use periodic::{Motion, Periodic};
pub use precision::{Precision, Rounding};
pub use quality::Quality;
pub use run::{
    Checkpoint, Derivatives, Desired, Goal, Guard, Keeper, Method, Objectives, Observer, Options,
    Phase, Progress, Sharpness, Stop, WorstBy,
};
pub use slide::Slide;
pub use smoother::{Backend, Smoother, smooth};
pub use targets::{Outside, Surface, TargetField, Targets};
pub use topology::{Crossing, HangingNode, Topology, signed_area};
pub use untangle::{Untangled, Untangling, untangle};
#[cfg(feature = "gpu")]
pub use wgpu;
