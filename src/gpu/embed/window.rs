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
    /// Checks that the first `bytes` bytes of `slice` can be bound as storage. Returns [`GpuError::Buffer`] if the usage,
    /// the alignment or the size is wrong, and [`GpuError::Limit`] if the range exceeds a binding.
    pub(crate) fn new(
        gpu: &Gpu,
        slice: wgpu::BufferSlice<'a>,
        bytes: u64,
    ) -> Result<Self, GpuError> {
        let refuse = |problem: String| Err(GpuError::Buffer(problem));
        let (buffer, offset) = (slice.buffer(), slice.offset());
        if !buffer.usage().contains(Usage::STORAGE) {
            let usage = buffer.usage();
            return refuse(format!("it was made for {usage:?}, and needs STORAGE as well"));
        }
        if !offset.is_multiple_of(4) {
            return refuse(format!("the offset is {offset} bytes, not a multiple of 4"));
        }
        check_size(slice, bytes)?;
        let limits = gpu.device.limits();
        let alignment = u64::from(limits.min_storage_buffer_offset_alignment);
        let start = offset - offset % alignment;
        let size = offset - start + bytes;
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

    /// Returns the range with the bytes before it that alignment requires.
    pub(crate) fn binding(&self) -> wgpu::BindingResource<'a> {
        wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: self.buffer,
            offset: self.start,
            size: wgpu::BufferSize::new(self.size),
        })
    }
}

/// Returns [`GpuError::Buffer`] if a slice has fewer than `bytes` bytes.
pub(crate) fn check_size(slice: wgpu::BufferSlice<'_>, bytes: u64) -> Result<(), GpuError> {
    let (size, offset) = (slice.size(), slice.offset());
    match bytes <= size {
        true => Ok(()),
        false => Err(GpuError::Buffer(format!(
            "it has {size} bytes from byte {offset} on, and {bytes} are needed"
        ))),
    }
}
