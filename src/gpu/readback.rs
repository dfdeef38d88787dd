//! Getting bytes back: the one place that maps a buffer.

use bytemuck::Pod;
use futures_intrusive::channel::shared::oneshot_channel;

use super::device::{Gpu, GpuError, scoped};

/// Copies `count` values from the start of `source` to the host, after everything submitted so far.
pub(crate) fn read<T: Pod>(
    gpu: &Gpu,
    source: &wgpu::Buffer,
    count: usize,
) -> Result<Vec<T>, GpuError> {
    let size = (count * size_of::<T>()) as u64;
    let staging = scoped(&gpu.device, || {
        let staging = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("gpu-smooth readback"),
            size,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor {
            label: Some("gpu-smooth readback"),
        });
        encoder.copy_buffer_to_buffer(source, 0, &staging, 0, size);
        gpu.queue.submit([encoder.finish()]);
        staging
    })?;
    let (sender, receiver) = oneshot_channel();
    staging.map_async(wgpu::MapMode::Read, .., move |result| {
        // The receiver is only gone if this function has already failed.
        let _ = sender.send(result);
    });
    let polled = gpu.device.poll(wgpu::PollType::wait_indefinitely());
    gpu.check()?;
    polled.map_err(|error| GpuError::Lost(error.to_string()))?;
    match pollster::block_on(receiver.receive()) {
        Some(Ok(())) => {}
        Some(Err(error)) => return Err(GpuError::Lost(error.to_string())),
        None => return Err(GpuError::Lost("the readback was abandoned".into())),
    }
    let view = staging.get_mapped_range(..).map_err(|error| GpuError::Lost(error.to_string()))?;
    let values = bytemuck::pod_collect_to_vec(&view[..]);
    drop(view);
    staging.unmap();
    Ok(values)
}
