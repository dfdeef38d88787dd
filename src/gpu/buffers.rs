//! A mesh on the device.

use std::collections::VecDeque;
use std::ops::Range;

use glam::DVec2;
use wgpu::BufferUsages as Usage;

use super::device::{Gpu, GpuError, scoped};
use super::layout::split;
use super::parts::{Parts, of_part};
use super::readback::{self, Waiting};
use super::size::{NUMBER, POSITION, TRIANGLE};
use crate::problem::Problem;

/// The buffers that live as long as a mesh stays on the device.
pub(crate) struct MeshBuffers {
    pub(crate) positions: wgpu::Buffer,
    pub(crate) ring_start: wgpu::Buffer,
    pub(crate) ring: wgpu::Buffer,
    pub(crate) triangles: wgpu::Buffer,
    /// How they are bound.
    pub(crate) parts: Parts,
}

impl MeshBuffers {
    /// Uploads a problem with its vertices at `positions`.
    pub(crate) fn new(gpu: &Gpu, problem: &Problem, positions: &[DVec2]) -> Result<Self, GpuError> {
        let parts = Parts::new(problem, &gpu.device.limits())?;
        let positions = laid_out(positions, parts.low_positions);
        scoped(&gpu.device, || Self {
            positions: filled(gpu, "positions", &positions, Usage::STORAGE | Usage::COPY_SRC),
            ring_start: filled(
                gpu,
                "ring starts",
                problem.ring_start(),
                Usage::STORAGE | Usage::COPY_DST,
            ),
            ring: filled(gpu, "one-rings", problem.ring(), Usage::STORAGE),
            triangles: filled(gpu, "triangles", problem.triangles(), Usage::STORAGE),
            parts,
        })
    }

    /// The positions, and their low parts where they are by themselves.
    pub(crate) fn bind_positions(
        &self,
    ) -> (wgpu::BindingResource<'_>, Option<wgpu::BindingResource<'_>>) {
        match self.parts.low_positions {
            None => (self.positions.as_entire_binding(), None),
            Some(low) => (
                bytes(&self.positions, 0..low),
                Some(bytes(&self.positions, low..self.positions.size())),
            ),
        }
    }

    /// Reads back the first `count` positions, after everything submitted so far.
    pub(crate) async fn read_positions(
        &self,
        gpu: &Gpu,
        count: usize,
        waiting: Waiting,
    ) -> Result<Vec<[f32; 4]>, GpuError> {
        let Some(low) = self.parts.low_positions else {
            return readback::read(gpu, &self.positions, count, waiting).await;
        };
        let low = (low / PART) as usize;
        let parts: Vec<[f32; 2]> =
            readback::read(gpu, &self.positions, low + count, waiting).await?;
        let joined = parts.iter().zip(&parts[low..]).map(|(&[x, y], &[a, b])| [x, y, a, b]);
        Ok(joined.collect())
    }

    /// The one-rings of a part.
    pub(crate) fn bind_ring(&self, part: usize) -> wgpu::BindingResource<'_> {
        rows(&self.ring, &of_part(&self.parts.rings, part).entries, NUMBER)
    }

    /// The triangles of a part.
    pub(crate) fn bind_triangles(&self, part: usize) -> wgpu::BindingResource<'_> {
        rows(&self.triangles, of_part(&self.parts.triangles, part), TRIANGLE)
    }
}

/// Bytes of the high or the low parts of a position.
const PART: u64 = POSITION / 2;

/// The numbers of the buffer of positions: vertex by vertex, or all the low parts from a byte on.
fn laid_out(positions: &[DVec2], low: Option<u64>) -> Vec<[f32; 2]> {
    let count = positions.len();
    let (step, low, length) = match low {
        None => (2, 1, 2 * count),
        Some(low) => (1, (low / PART) as usize, (low / PART) as usize + count),
    };
    let mut parts = vec![[0.0; 2]; length];
    for (v, &p) in positions.iter().enumerate() {
        let [x, y, x_low, y_low] = split(p);
        parts[step * v] = [x, y];
        parts[step * v + low] = [x_low, y_low];
    }
    parts
}

/// A uniform that stands at a dynamic offset.
pub(crate) fn uniform<T>(buffer: &wgpu::Buffer) -> wgpu::BindingResource<'_> {
    bytes(buffer, 0..size_of::<T>() as u64)
}

/// Some rows of a buffer, each of `size` bytes.
pub(crate) fn rows<'b>(
    buffer: &'b wgpu::Buffer,
    range: &Range<u32>,
    size: u64,
) -> wgpu::BindingResource<'b> {
    bytes(buffer, u64::from(range.start) * size..u64::from(range.end) * size)
}

fn bytes(buffer: &wgpu::Buffer, range: Range<u64>) -> wgpu::BindingResource<'_> {
    wgpu::BindingResource::Buffer(wgpu::BufferBinding {
        buffer,
        offset: range.start,
        size: wgpu::BufferSize::new(range.end - range.start),
    })
}

/// Bytes of a large buffer that are sent at once, and pieces that are on their way before one is waited for: with
/// fewer than eight million vertices nothing ever waits.
const PIECE: usize = 16 << 20;
const UNDER_WAY: usize = 8;

/// A buffer holding `contents`. To be called in an error scope.
pub(crate) fn filled<T: bytemuck::NoUninit>(
    gpu: &Gpu,
    label: &str,
    contents: &[T],
    usage: Usage,
) -> wgpu::Buffer {
    let bytes: &[u8] = bytemuck::cast_slice(contents);
    let is_large = bytes.len() > PIECE;
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(&format!("gpu-smooth {label}")),
        size: (bytes.len() as u64).next_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT),
        usage: if is_large { usage | Usage::COPY_DST } else { usage },
        mapped_at_creation: !is_large,
    });
    if is_large {
        write_by_pieces(gpu, &buffer, bytes);
        return buffer;
    }
    // A device that is lost or out of memory maps nothing, and the error scope hears of it: no reason
    // to panic, as wgpu's own `create_buffer_init` does.
    if let Ok(mut view) = buffer.get_mapped_range_mut(..) {
        view.slice(..bytes.len()).copy_from_slice(bytes);
    }
    buffer.unmap();
    buffer
}

/// Fills a large buffer. What is on its way takes as much memory again, until the device has it: so there is only
/// so much of it.
fn write_by_pieces(gpu: &Gpu, buffer: &wgpu::Buffer, bytes: &[u8]) {
    let mut under_way = VecDeque::new();
    for (at, piece) in (0..).step_by(PIECE).zip(bytes.chunks(PIECE)) {
        if under_way.len() == UNDER_WAY {
            let submission_index = under_way.pop_front();
            // That the device is lost, whoever waits for results is told.
            let _ = gpu.device.poll(wgpu::PollType::Wait { submission_index, timeout: None });
        }
        gpu.queue.write_buffer(buffer, at, piece);
        under_way.push_back(gpu.queue.submit([]));
    }
}

/// A buffer of zeros. To be called in an error scope.
pub(crate) fn zeroed(gpu: &Gpu, label: &str, size: u64, usage: Usage) -> wgpu::Buffer {
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

    #[test]
    fn buffers_hold_their_contents_however_large() {
        let gpu = Gpu::open(None).unwrap();
        let piece = PIECE / size_of::<u32>();
        for length in [1, piece, piece + 1, (UNDER_WAY + 1) * piece - 1] {
            let contents: Vec<u32> =
                (0..length as u32).map(|i| i.wrapping_mul(0x9e37_79b1)).collect();
            let usage = Usage::STORAGE | Usage::COPY_SRC;
            let buffer = scoped(&gpu.device, || filled(&gpu, "test", &contents, usage)).unwrap();
            let read = readback::read::<u32>(&gpu, &buffer, length, Waiting::Block);
            assert!(pollster::block_on(read).unwrap() == contents, "{length} numbers");
        }
    }
}
