//! The wgpu engine, for any adapter, software ones included, and for an application's own device.
//!
//! By lifetime: a [`Gpu`] is a device with its pipelines and serves many meshes; a [`DeviceMesh`] is a mesh
//! that stays on the device; [`Sweeps`] are a scheme bound to it, and [`BoundVertices`] and
//! [`BoundObjective`] the application's buffers. All that can fail and all that makes resources is done when these
//! are made; in a frame, they only encode into the application's own command encoder, or, under the
//! clock of [`Timestamps`], into one that is timed. The blocking and the asynchronous calls of
//! [`Smoother`](crate::Smoother) make what they need for themselves. The kernels are core WebGPU, see
//! [`Kernel`].

mod buffers;
mod device;
mod embed;
mod engine;
mod exchange;
mod fine;
mod kernel;
mod layout;
mod levels;
mod limits;
mod objective;
mod pages;
mod parts;
mod passes;
mod readback;
mod run;
mod shaders;
mod size;
mod sweeps;
mod timestamps;

pub use device::{AdapterSummary, Gpu, GpuError, adapters};
pub use embed::DeviceMesh;
pub use engine::GpuEngine;
pub use exchange::{BoundVertices, VertexBuffer};
pub(crate) use fine::GpuFine;
pub use objective::{BoundObjective, ObjectiveValues};
pub use passes::Encoder;
pub(crate) use readback::Waiting;
pub use shaders::{Interface, Kernel};
pub use size::MeshSize;
pub use sweeps::Sweeps;
pub use timestamps::{Span, Spans, Timed, Timestamps};
