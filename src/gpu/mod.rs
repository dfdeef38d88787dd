//! The wgpu engine, for any adapter, software ones included, and for an application's own device.
//!
//! By lifetime: a [`Gpu`] is a device with its pipelines and serves many meshes; a [`DeviceMesh`] is a mesh
//! that stays on the device; [`Sweeps`] are a scheme bound to it, to be encoded into the application's own
//! command encoder. The blocking and the asynchronous calls of [`Smoother`](crate::Smoother) make all
//! three for themselves. The kernels are core WebGPU, see [`Kernel`].

mod buffers;
mod device;
mod embed;
mod engine;
mod exchange;
mod fine;
mod kernel;
mod layout;
mod levels;
mod readback;
mod run;
mod shaders;

pub use buffers::MeshSize;
pub use device::{AdapterSummary, Gpu, GpuError, adapters};
pub use embed::{DeviceMesh, Sweeps};
pub use engine::GpuEngine;
pub use exchange::VertexBuffer;
pub(crate) use fine::GpuFine;
pub(crate) use readback::Waiting;
pub use shaders::{Interface, Kernel};
