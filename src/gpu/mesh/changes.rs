//! Counts the changes that an application makes to a mesh, so that judged sweeps know when to begin again.

use std::sync::{Arc, Mutex, PoisonError};

use wgpu::BufferUsages as Usage;

use crate::error::GpuError;
use crate::gpu::device::Gpu;
use crate::gpu::device::buffers::zeroed;
use crate::gpu::scope::scoped;

/// Two counters on the device: of changes by kernels, such as vertices that an application moves, and of changes by the
/// host. It is a handle.
#[derive(Clone)]
pub(crate) struct Changes {
    pub(crate) buffer: wgpu::Buffer,
    by_host: Arc<Mutex<u32>>,
}

impl Changes {
    /// Creates counters that are zero. To be called in an error scope.
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let bytes = 2 * size_of::<u32>() as u64;
        let buffer = zeroed(gpu, "changes", bytes, Usage::STORAGE | Usage::COPY_DST);
        Self { buffer, by_host: Arc::default() }
    }

    /// Counts a change by the host, which takes effect in submissions after the call.
    ///
    /// # Errors
    /// A [`GpuError`] if the device fails.
    pub(crate) fn count(&self, gpu: &Gpu) -> Result<(), GpuError> {
        let mut by_host = self.by_host.lock().unwrap_or_else(PoisonError::into_inner);
        *by_host = by_host.wrapping_add(1);
        let (at, count) = (size_of::<u32>() as u64, by_host.to_le_bytes());
        scoped(&gpu.device, || gpu.queue.write_buffer(&self.buffer, at, &count))
    }
}
