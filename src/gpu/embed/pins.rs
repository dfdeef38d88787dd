//! Vertices that are held where they are: on the host's word, or by a mask of the application.

use std::collections::BTreeSet;
use std::sync::{Mutex, MutexGuard, PoisonError};

use wgpu::BufferUsages as Usage;

use crate::error::GpuError;
use crate::gpu::device::Gpu;
use crate::gpu::device::buffers::{filled, zeroed};
use crate::gpu::embed::window::Window;
use crate::gpu::encode::Encoder;
use crate::gpu::kernels::dispatch::dispatch;
use crate::gpu::kernels::pipelines::Pipeline;
use crate::gpu::kernels::table::{Interface, Kernel, Positions};
use crate::gpu::kernels::uniforms::{HELD, Mask};
use crate::gpu::mesh::MeshBuffers;
use crate::gpu::scope::{scoped, scoped_to_buffer};
use crate::layout::Problem;

/// Which vertices the host holds. They are named by their numbers on the device.
pub(crate) struct Pins {
    /// Vertices of [`Mesh::fixed`](crate::Mesh::fixed), which always stay.
    fixed: BTreeSet<u32>,
    pinned: Mutex<BTreeSet<u32>>,
    /// On the device, a bit for each vertex that is fixed or pinned.
    bits: wgpu::Buffer,
}

/// Places between two changes that are sent with them: a write of its own costs more.
const GAP: u32 = 64;
/// The most writes in one call; more changes than that are sent as one range.
const WRITES: usize = 32;

impl Pins {
    /// Holds the fixed vertices of a mesh.
    pub(crate) fn new(
        gpu: &Gpu,
        problem: &Problem,
        mesh: &MeshBuffers,
        fixed: BTreeSet<u32>,
    ) -> Result<Self, GpuError> {
        let words = problem.free_count().div_ceil(32).max(1);
        let bits = scoped(&gpu.device, || {
            zeroed(gpu, "pins", 4 * words as u64, Usage::STORAGE | Usage::COPY_DST)
        })?;
        let pins = Self { fixed, pinned: Mutex::default(), bits };
        let all: Vec<u32> = pins.fixed.iter().copied().collect();
        pins.send(gpu, problem, mesh, &BTreeSet::new(), &all)?;
        Ok(pins)
    }

    fn pinned(&self) -> MutexGuard<'_, BTreeSet<u32>> {
        self.pinned.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Changes which vertices are pinned, and sends what is different to the device.
    pub(crate) fn change(
        &self,
        gpu: &Gpu,
        problem: &Problem,
        mesh: &MeshBuffers,
        change: impl FnOnce(&mut BTreeSet<u32>) -> Vec<u32>,
    ) -> Result<(), GpuError> {
        let mut pinned = self.pinned();
        let mut changed = change(&mut pinned);
        changed.retain(|place| !self.fixed.contains(place));
        if changed.is_empty() {
            return Ok(());
        }
        changed.sort_unstable();
        self.send(gpu, problem, mesh, &pinned, &changed)?;
        mesh.changes.count(gpu)
    }

    /// Sends to the device what holds for vertices that have changed, in ascending order.
    fn send(
        &self,
        gpu: &Gpu,
        problem: &Problem,
        mesh: &MeshBuffers,
        pinned: &BTreeSet<u32>,
        changed: &[u32],
    ) -> Result<(), GpuError> {
        let free = problem.free_count() as u32;
        let is_held = |place: u32| self.fixed.contains(&place) || pinned.contains(&place);
        let start = |place: u32| {
            problem.ring_start()[place as usize] | if is_held(place) { HELD } else { 0 }
        };
        let bits = |word: u32| {
            let bit = |i: u32| u32::from(is_held(32 * word + i)) << i;
            (0..32).fold(0, |bits, i| bits | bit(i))
        };
        scoped(&gpu.device, || {
            let write = |buffer: &wgpu::Buffer, first: u32, words: &[u32]| {
                gpu.queue.write_buffer(buffer, 4 * u64::from(first), bytemuck::cast_slice(words));
            };
            for (first, last) in ranges(changed) {
                let last = last.min(free - 1);
                let starts: Vec<u32> = (first..=last).map(start).collect();
                write(&mesh.ring_start, first, &starts);
                let words: Vec<u32> = (first / 32..=last / 32).map(bits).collect();
                write(&self.bits, first / 32, &words);
            }
        })
    }
}

/// The ranges, ends included, in which these places are sent.
fn ranges(places: &[u32]) -> Vec<(u32, u32)> {
    let parts = places.chunk_by(|&a, &b| b - a <= GAP);
    let ends = |part: &[u32]| part.first().copied().zip(part.last().copied());
    let ranges: Vec<(u32, u32)> = parts.filter_map(ends).collect();
    match ranges.len() <= WRITES {
        true => ranges,
        false => ends(places).into_iter().collect(),
    }
}

/// A mask in a buffer of the application, which holds vertices. Made by
/// [`DeviceMesh::bind_mask`](crate::gpu::DeviceMesh::bind_mask); it can be used after the mesh is dropped.
pub struct BoundMask {
    pipeline: Pipeline,
    bind_group: wgpu::BindGroup,
    count: u32,
}

impl BoundMask {
    pub(crate) fn new(
        gpu: &Gpu,
        (problem, vertex_count): (&Problem, usize),
        mesh: &MeshBuffers,
        numbers: &wgpu::Buffer,
        pins: &Pins,
        (buffer, offset): (&wgpu::Buffer, u64),
    ) -> Result<Self, GpuError> {
        let bytes = (vertex_count as u64).saturating_mul(size_of::<u32>() as u64);
        let window = Window::new(gpu, buffer, offset, bytes)?;
        let count = problem.free_count() as u32;
        let mask = Mask { vertices: count, offset: window.offset, padding: [0; 2] };
        let bind_group = scoped_to_buffer(&gpu.device, || {
            let uniform = filled(gpu, "mask", &[mask], Usage::UNIFORM);
            let resources = [
                uniform.as_entire_binding(),
                mesh.ring_start.as_entire_binding(),
                numbers.as_entire_binding(),
                pins.bits.as_entire_binding(),
                window.binding(),
                mesh.changes.buffer.as_entire_binding(),
            ];
            gpu.pipelines.bind(&gpu.device, Interface::Mask, Positions::Whole, &resources)
        })?;
        let pipeline = gpu.pipelines.get(&gpu.device, &Kernel::HoldByMask, Positions::Whole)?;
        Ok(Self { pipeline, bind_group, count })
    }

    /// Encodes the holding of vertices: when the command buffer runs, those whose word in the mask is not 0 then are held
    /// from there on, and the others are let go, but for vertices of [`Mesh::fixed`](crate::Mesh::fixed) and those that are
    /// [pinned](crate::gpu::DeviceMesh::pin). To be encoded again after the mask has changed, and after a vertex that the
    /// mask holds was unpinned.
    pub fn encode_mask(&self, encoder: &mut impl Encoder) {
        encoder.passes("gpu-smooth mask").run(&self.pipeline, None, |pass| {
            pass.set_bind_group(0, &self.bind_group, &[]);
            dispatch(pass, self.count);
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_are_sent_in_few_ranges_that_hold_them_all() {
        assert_eq!(ranges(&[]), []);
        assert_eq!(ranges(&[7]), [(7, 7)]);
        assert_eq!(ranges(&[0, 3, 67, 132, 1000]), [(0, 67), (132, 132), (1000, 1000)]);
        let scattered: Vec<u32> = (0..100).map(|i| 100 * i).collect();
        assert_eq!(ranges(&scattered), [(0, 9900)]);
    }
}
