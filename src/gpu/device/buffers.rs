//! Buffers: creating them filled or zeroed, and binding parts of them.

use std::collections::VecDeque;
use std::ops::Range;

use web_time::Instant;
use wgpu::BufferUsages as Usage;

use crate::error::GpuError;
use crate::gpu::device::Gpu;
use crate::gpu::scope::{Count, poll, scoped};
use crate::parallel::pace::pause;

/// Returns the binding of one uniform of type `T`, read at a dynamic offset.
pub(crate) fn uniform<T>(buffer: &wgpu::Buffer) -> wgpu::BindingResource<'_> {
    bytes(buffer, 0..size_of::<T>() as u64)
}

/// Returns the binding of a range of a buffer's rows, each of `size` bytes.
pub(crate) fn rows<'b>(
    buffer: &'b wgpu::Buffer,
    range: &Range<u32>,
    size: u64,
) -> wgpu::BindingResource<'b> {
    bytes(buffer, u64::from(range.start) * size..u64::from(range.end) * size)
}

pub(crate) fn bytes(buffer: &wgpu::Buffer, range: Range<u64>) -> wgpu::BindingResource<'_> {
    wgpu::BindingResource::Buffer(wgpu::BufferBinding {
        buffer,
        offset: range.start,
        size: wgpu::BufferSize::new(range.end - range.start),
    })
}

/// Size of one write to a large buffer, in bytes.
const PIECE: usize = 16 << 20;
/// Size of one write between two pauses, in bytes.
const SMALL: usize = 2 << 20;
/// Limit of the pieces in flight: before a further write, the oldest is waited for. With fewer than eight million
/// vertices nothing waits.
const UNDER_WAY: usize = 8;

/// Creates a buffer that holds `contents`. To be called in an error scope.
pub(crate) fn filled<T: bytemuck::NoUninit>(
    gpu: &Gpu,
    label: &str,
    contents: &[T],
    usage: Usage,
) -> wgpu::Buffer {
    let bytes: &[u8] = bytemuck::cast_slice(contents);
    let is_large = bytes.len() > PIECE;
    gpu.device.counters().add(Count::Allocated, bytes.len() as u64);
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(&format!("gpu-smooth {label}")),
        size: (bytes.len() as u64).next_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT),
        usage: if is_large { usage | Usage::COPY_DST } else { usage },
        mapped_at_creation: !is_large,
    });
    if is_large {
        write_by_pieces(gpu, &buffer, 0, bytes);
        return buffer;
    }
    // Mapping fails on a device that is lost or out of memory. The error scope or a later call reports the fault;
    // wgpu's own `create_buffer_init` would panic.
    if let Ok(mut view) = buffer.get_mapped_range_mut(..) {
        view.slice(..bytes.len()).copy_from_slice(bytes);
        gpu.device.counters().add(Count::Uploaded, bytes.len() as u64);
    }
    buffer.unmap();
    buffer
}

/// Writes to a buffer in pieces, from the byte `first` on. A piece in flight takes its size in memory again, so at most
/// [`UNDER_WAY`] pieces are in flight at once.
pub(crate) fn write_by_pieces(gpu: &Gpu, buffer: &wgpu::Buffer, first: u64, bytes: &[u8]) {
    let mut under_way = VecDeque::new();
    for (at, piece) in (first..).step_by(PIECE).zip(bytes.chunks(PIECE)) {
        if under_way.len() == UNDER_WAY {
            wait_for(gpu, under_way.pop_front());
        }
        gpu.queue.write_buffer(buffer, at, piece);
        under_way.push_back(gpu.queue.submit([]));
    }
}

/// Waits for a submission. If the device is lost, reading back the results reports it.
fn wait_for(gpu: &Gpu, submission_index: Option<wgpu::SubmissionIndex>) {
    let began = Instant::now();
    let _ = poll(&gpu.device, wgpu::PollType::Wait { submission_index, timeout: None });
    gpu.device.counters().add_wait(began.elapsed());
}

/// Creates a buffer that holds `arrays` one after the other, with pauses between its pieces. The size of `T` must be a
/// multiple of [`wgpu::COPY_BUFFER_ALIGNMENT`].
pub(crate) async fn filled_with_pauses<T: bytemuck::NoUninit + Sync>(
    gpu: &Gpu,
    label: &str,
    arrays: &[&[T]],
    usage: Usage,
) -> Result<wgpu::Buffer, GpuError> {
    let size: usize = arrays.iter().map(|&array| size_of_val(array)).sum();
    if size <= SMALL {
        return scoped(&gpu.device, || filled(gpu, label, &arrays.concat(), usage));
    }
    let usage = usage | Usage::COPY_DST;
    let buffer = scoped(&gpu.device, || zeroed(gpu, label, size as u64, usage))?;
    // As in `write_by_pieces`, with smaller pieces.
    let mut under_way = VecDeque::new();
    let pieces = arrays.iter().flat_map(|array| bytemuck::cast_slice::<T, u8>(array).chunks(SMALL));
    let mut end = 0;
    for piece in pieces {
        let at = end;
        end += piece.len() as u64;
        pause().await;
        let oldest = match under_way.len() == UNDER_WAY * (PIECE / SMALL) {
            true => under_way.pop_front(),
            false => None,
        };
        under_way.push_back(scoped(&gpu.device, || {
            if oldest.is_some() {
                wait_for(gpu, oldest);
            }
            gpu.queue.write_buffer(&buffer, at, piece);
            gpu.queue.submit([])
        })?);
    }
    Ok(buffer)
}

/// Creates a buffer of zeros. To be called in an error scope.
pub(crate) fn zeroed(gpu: &Gpu, label: &str, size: u64, usage: Usage) -> wgpu::Buffer {
    gpu.device.counters().add(Count::Allocated, size);
    gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(&format!("gpu-smooth {label}")),
        size,
        usage,
        mapped_at_creation: false,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::device::pending::Waiting;
    use crate::gpu::device::readback;
    use crate::parallel::pace::now;

    #[test]
    fn buffers_hold_their_contents_however_large() {
        let gpu = Gpu::open(None).block().unwrap();
        let piece = PIECE / size_of::<u32>();
        for length in [1, piece, piece + 1, (UNDER_WAY + 1) * piece - 1] {
            let contents: Vec<u32> =
                (0..length as u32).map(|i| i.wrapping_mul(0x9e37_79b1)).collect();
            let (left, right) = contents.split_at(length / 3);
            let parts = [left, &[], right];
            let usage = Usage::STORAGE | Usage::COPY_SRC;
            let buffer = scoped(&gpu.device, || filled(&gpu, "test", &contents, usage)).unwrap();
            let paced = now(filled_with_pauses(&gpu, "test", &parts, usage)).unwrap();
            for buffer in [&buffer, &paced] {
                let read = readback::read::<u32>(&gpu, buffer, length, Waiting::Block);
                assert!(pollster::block_on(read).unwrap() == contents, "{length} numbers");
            }
        }
    }
}
