//! The wgpu engine, for any adapter, software ones included, and for an application's own device.
//!
//! A [`Gpu`] is a device with compiled pipelines, and serves many meshes. A [`DeviceMesh`] is a mesh that stays on the
//! device. [`Sweeps`] bind a scheme to such a mesh; [`BoundVertices`] and [`BoundObjective`] bind the application's
//! buffers. The constructors of these types create all resources and return all errors. In a frame, their methods only
//! encode into the application's command encoder, or into an encoder whose kernels are timed ([`Timestamps`]). Runs of
//! [`Smoother`](crate::Smoother) create their buffers and pipelines themselves. The kernels are core WebGPU, see
//! [`Kernel`].

mod device;
mod embed;
mod encode;
mod kernels;
mod mesh;
mod run;
pub(crate) mod scope;

pub use device::{Gpu, Pending, adapters, checked_adapters};
pub(crate) use device::{Waiting, ranked_adapters};
pub use embed::{
    BoundMask, BoundMove, BoundObjective, BoundVertices, Budget, DeviceMesh, Doubt, LastValid,
    ObjectiveValues, Readback, Sweeps, UntanglingSweeps, VertexBuffer,
};
pub use encode::{Encoder, Span, Spans, Timed, Timestamps};
#[doc(hidden)]
pub use kernels::BindLayout;
pub use kernels::Kernel;
pub(crate) use run::GpuEngine;
pub(crate) use wgpu::Adapter;

pub use crate::adapter::AdapterSummary;
pub use crate::error::GpuError;
pub use crate::mesh::MeshSize;
