//! Reads buffers back to the host. No other module maps buffers for reading.

use std::marker::PhantomData;
use std::ops::Range;

use bytemuck::Pod;
use futures_intrusive::channel::shared::{OneshotReceiver, oneshot_channel};
use web_time::Instant;

use crate::error::GpuError;
use crate::gpu::device::Gpu;
use crate::gpu::device::pending::Waiting;
use crate::gpu::scope::{Count, poll, scoped};
use crate::parallel::paced;

/// Number of values that are copied between two pauses.
const CHUNK: usize = 1 << 15;

/// Copies `count` values from the start of `source` to the host, after everything submitted so far.
pub(crate) async fn read<T: Pod + Send>(
    gpu: &Gpu,
    source: &wgpu::Buffer,
    count: usize,
    waiting: Waiting,
) -> Result<Vec<T>, GpuError> {
    submit_and_copy::<T>(gpu, |_| {}, source, count)?.values(waiting).await
}

/// Submits what `encode` encodes and, in the same submission, a copy of `count` values from the start of `source`. With
/// a separate submission for the copy, some drivers would block the thread until the earlier work is done.
pub(crate) fn submit_and_copy<'g, T: Pod>(
    gpu: &'g Gpu,
    encode: impl FnOnce(&mut wgpu::CommandEncoder),
    source: &wgpu::Buffer,
    count: usize,
) -> Result<Copied<'g, T>, GpuError> {
    let size = (count * size_of::<T>()) as u64;
    submit_and_copy_ranges(gpu, encode, &[(source, 0..size)])
}

/// Submits what `encode` encodes and, in the same submission, copies of ranges of bytes of buffers, one after the other.
pub(crate) fn submit_and_copy_ranges<'g, T: Pod>(
    gpu: &'g Gpu,
    encode: impl FnOnce(&mut wgpu::CommandEncoder),
    sources: &[(&wgpu::Buffer, Range<u64>)],
) -> Result<Copied<'g, T>, GpuError> {
    let size = sources.iter().map(|(_, range)| range.end - range.start).sum();
    let label = Some("gpu-smooth readback");
    let (sender, arrival) = oneshot_channel();
    let staging = scoped(&gpu.device, || {
        let staging = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label,
            size,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let mut encoder =
            gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label });
        encode(&mut encoder);
        let mut at = 0;
        for (source, range) in sources {
            let length = range.end - range.start;
            encoder.copy_buffer_to_buffer(source, range.start, &staging, at, length);
            at += length;
        }
        gpu.queue.submit([encoder.finish()]);
        staging.map_async(wgpu::MapMode::Read, .., move |result| {
            // The receiver is dropped only if this function has already failed.
            let _ = sender.send(result);
        });
        staging
    })?;
    Ok(Copied { gpu, staging, arrival, values: PhantomData })
}

/// Values in a staging buffer whose mapping to the host is under way.
pub(crate) struct Copied<'g, T> {
    gpu: &'g Gpu,
    staging: wgpu::Buffer,
    arrival: OneshotReceiver<Result<(), wgpu::BufferAsyncError>>,
    values: PhantomData<fn() -> T>,
}

impl<T: Pod + Send> Copied<'_, T> {
    /// Waits for the values and returns the first, as [`values`](Self::values) does.
    pub(crate) async fn first(self, waiting: Waiting) -> Result<T, GpuError> {
        let empty = || GpuError::Lost("the readback is empty".into());
        self.values(waiting).await?.into_iter().next().ok_or_else(empty)
    }

    /// Waits for the values and returns them. Returns [`GpuError::WouldBlock`] for [`Waiting::Block`] in a browser, and
    /// [`GpuError::Lost`] if the device is lost.
    pub(crate) async fn values(self, waiting: Waiting) -> Result<Vec<T>, GpuError> {
        let Self { gpu, staging, arrival, .. } = self;
        let (counters, began) = (gpu.device.counters(), Instant::now());
        if waiting == Waiting::Block {
            if cfg!(target_arch = "wasm32") {
                return Err(GpuError::WouldBlock);
            }
            let polled = poll(&gpu.device, wgpu::PollType::wait_indefinitely());
            gpu.device.check()?;
            polled?;
        }
        match arrival.receive().await {
            Some(Ok(())) => gpu.device.check_async().await?,
            Some(Err(error)) => {
                // A refused copy leaves a buffer that cannot be mapped, and a browser reports the refusal itself.
                gpu.device.check_async().await?;
                return Err(GpuError::Lost(error.to_string()));
            }
            None => return Err(GpuError::Lost("the readback was abandoned".into())),
        }
        let view =
            staging.get_mapped_range(..).map_err(|error| GpuError::Lost(error.to_string()))?;
        counters.add_wait(began.elapsed());
        counters.add(Count::ReadBack, view.len() as u64);
        let mut values = vec![T::zeroed(); view.len() / size_of::<T>()];
        paced::in_order(values.len(), CHUNK, |range| {
            let bytes = range.start * size_of::<T>()..range.end * size_of::<T>();
            bytemuck::cast_slice_mut(&mut values[range]).copy_from_slice(&view[bytes]);
        })
        .await;
        drop(view);
        staging.unmap();
        Ok(values)
    }
}
