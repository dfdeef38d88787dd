//! The wgpu engine, for any adapter, software ones included, and for an application's own device.
//!
//! A [`Gpu`] is a device with its pipelines and serves many meshes. A [`DeviceMesh`] is a mesh that stays on the
//! device. [`Sweeps`] bind a scheme to that mesh; [`BoundVertices`] and [`BoundObjective`] bind the application's
//! buffers. Their constructors make all resources and return all errors; in a frame they only encode into the
//! application's own command encoder, or into one whose kernels are timed, see [`Timestamps`]. The calls of
//! [`Smoother`](crate::Smoother) make all of this themselves. The kernels are core WebGPU, see [`Kernel`].

mod device;
mod embed;
mod encode;
mod kernels;
mod mesh;
mod run;
pub(crate) mod scope;

pub use device::{Gpu, adapters, checked_adapters};
pub(crate) use device::{Waiting, ranked_adapters};
pub use embed::{
    BoundMask, BoundMove, BoundObjective, BoundVertices, Budget, DeviceMesh, LastValid,
    ObjectiveValues, Readback, Sweeps, UntanglingSweeps, VertexBuffer,
};
pub use encode::{Encoder, Span, Spans, Timed, Timestamps};
pub use kernels::{BindLayout, Kernel};
pub(crate) use run::GpuEngine;

pub use crate::adapter::AdapterSummary;
pub use crate::error::GpuError;
pub use crate::mesh::MeshSize;
