//! The wgpu engine, for any adapter, software ones included, and for an application's own device.
//!
//! By lifetime: a [`Gpu`] is a device with its pipelines and serves many meshes; a [`DeviceMesh`] is a mesh
//! that stays on the device; [`Sweeps`] are a scheme bound to it, and [`BoundVertices`] and
//! [`BoundObjective`] the application's buffers. All that can fail and all that makes resources is done when these
//! are made; in a frame, they only encode into the application's own command encoder, or, under the
//! clock of [`Timestamps`], into one that is timed. The blocking and the asynchronous calls of
//! [`Smoother`](crate::Smoother) make what they need for themselves. The kernels are core WebGPU, see
//! [`Kernel`].

mod device;
mod embed;
mod encode;
mod kernels;
mod mesh;
mod run;
pub(crate) mod scope;

pub use device::{AdapterSummary, Gpu, MeshSize, adapters, checked_adapters};
pub(crate) use device::{Waiting, ranked_adapters};
pub use embed::{BoundObjective, BoundVertices, DeviceMesh, ObjectiveValues, Sweeps, VertexBuffer};
pub use encode::{Encoder, Span, Spans, Timed, Timestamps};
pub use kernels::{Interface, Kernel};
pub(crate) use run::GpuEngine;

pub use crate::error::GpuError;
