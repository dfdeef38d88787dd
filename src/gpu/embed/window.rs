//! Checks and binds the range of an application's buffer that a kernel accesses.

use wgpu::BufferUsages as Usage;

use crate::error::GpuError;
use crate::gpu::device::Gpu;

/// A range of 4-byte words in a buffer, bound from an aligned byte on.
pub(crate) struct Window<'a> {
    buffer: &'a wgpu::Buffer,
    start: u64,
    size: u64,
    /// Offset of the range in the binding, in words.
    pub(crate) offset: u32,
}

impl<'a> Window<'a> {
    /// Checks that `bytes` bytes from `offset` on can be bound as storage. Returns [`GpuError::Buffer`] if the usage,
    /// the alignment or the size is wrong, and [`GpuError::Limit`] if the range exceeds a binding.
    pub(crate) fn new(
        gpu: &Gpu,
        buffer: &'a wgpu::Buffer,
        offset: u64,
        bytes: u64,
    ) -> Result<Self, GpuError> {
        let refuse = |problem: String| Err(GpuError::Buffer(problem));
        if !buffer.usage().contains(Usage::STORAGE) {
            let usage = buffer.usage();
            return refuse(format!("it was made for {usage:?}, and needs STORAGE as well"));
        }
        if !offset.is_multiple_of(4) {
            return refuse(format!("the offset is {offset} bytes, not a multiple of 4"));
        }
        let Some(end) = offset.checked_add(bytes).filter(|&end| end <= buffer.size()) else {
            let size = buffer.size();
            return refuse(format!(
                "it has {size} bytes, and {bytes} from byte {offset} are needed"
            ));
        };
        let limits = gpu.device.limits();
        let alignment = u64::from(limits.min_storage_buffer_offset_alignment);
        let start = offset - offset % alignment;
        let size = end - start;
        if size > limits.max_storage_buffer_binding_size {
            return Err(GpuError::Limit {
                what: "the application's buffer".into(),
                needed: size,
                limit: "max_storage_buffer_binding_size",
                available: limits.max_storage_buffer_binding_size,
            });
        }
        Ok(Self { buffer, start, size, offset: ((offset - start) / 4) as u32 })
    }

    pub(crate) fn binding(&self) -> wgpu::BindingResource<'a> {
        wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: self.buffer,
            offset: self.start,
            size: wgpu::BufferSize::new(self.size),
        })
    }
}
