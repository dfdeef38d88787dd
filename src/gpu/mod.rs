//! The wgpu engine, for any adapter, software ones included.
//!
//! By lifetime: a [`Gpu`] is a device with its pipelines and serves many meshes; a [`GpuEngine`] is one
//! run on one mesh. The kernels are core WebGPU, see [`Kernel`].

mod buffers;
mod device;
mod engine;
mod kernel;
mod layout;
mod readback;
mod shaders;

pub use device::{AdapterSummary, Gpu, GpuError, adapters};
pub use engine::GpuEngine;
pub use shaders::Kernel;
