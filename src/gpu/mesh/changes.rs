//! Counts the changes that an application makes to a mesh, so that sweeps with a stop rule begin again after a change.

use std::sync::{Arc, Mutex, PoisonError};

use wgpu::BufferUsages as Usage;

use crate::error::GpuError;
use crate::gpu::device::Gpu;
use crate::gpu::device::buffers::zeroed;
use crate::gpu::scope::scoped;

/// A handle to two counters on the device: changes by kernels, such as vertices that an application moves, and changes
/// by the host, such as pins.
#[derive(Clone)]
pub(crate) struct Changes {
    pub(crate) buffer: wgpu::Buffer,
    by_host: Arc<Mutex<u32>>,
}

impl Changes {
    /// Creates both counters with the value 0. Must be called in an error scope.
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let bytes = 2 * size_of::<u32>() as u64;
        let buffer = zeroed(gpu, "changes", bytes, Usage::STORAGE | Usage::COPY_DST);
        Self { buffer, by_host: Arc::default() }
    }

    /// Counts a change by the host. Later submissions see the new count.
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
