//! Holds vertices in place, by pins of the host and by masks of the application.

use std::collections::BTreeSet;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use wgpu::BufferUsages as Usage;

use crate::error::GpuError;
use crate::gpu::device::Gpu;
use crate::gpu::device::buffers::{filled, zeroed};
use crate::gpu::embed::window::Window;
use crate::gpu::encode::Encoder;
use crate::gpu::kernels::dispatch::dispatch;
use crate::gpu::kernels::form::Positions;
use crate::gpu::kernels::layouts::{MaskBindings, SlidingMaskBindings};
use crate::gpu::kernels::pipelines::Pipeline;
use crate::gpu::kernels::table::Kernel;
use crate::gpu::kernels::uniforms::{HELD, Mask};
use crate::gpu::mesh::{Changes, Curves, MeshBuffers};
use crate::gpu::scope::{check_alive, scoped, scoped_to_buffer};
use crate::layout::Problem;
use crate::run::multilevel::NONE;

/// Vertices that the host holds in place, by device number.
pub(crate) struct Pins {
    /// The flags [`FIXED`] and [`PINNED`] of each free or held vertex.
    flags: Mutex<Vec<u8>>,
    /// On the device: one bit for each vertex, set if it is fixed or pinned.
    bits: wgpu::Buffer,
    /// Whether a mask may hold vertices of which the host knows nothing.
    has_mask: AtomicBool,
}

/// Flag of the vertices of [`Mesh::fixed`](crate::Mesh::fixed), which stay whatever the pins.
const FIXED: u8 = 1;
const PINNED: u8 = 2;

/// Largest difference between the numbers of two changed vertices that are sent in one write, together with the
/// unchanged vertices between them. A separate write would cost more.
const GAP: u32 = 64;
/// Upper limit of ranges per call. If changes are in more ranges, a single range spans all of them.
const WRITES: usize = 32;

impl Pins {
    /// Creates pins that hold the vertices with the device numbers `fixed`.
    pub(crate) fn new(
        gpu: &Gpu,
        problem: &Problem,
        mesh: &MeshBuffers,
        fixed: &[u32],
    ) -> Result<Self, GpuError> {
        let words = problem.free_count().div_ceil(32).max(1);
        let bits = scoped(&gpu.device, || {
            zeroed(gpu, "pins", 4 * words as u64, Usage::STORAGE | Usage::COPY_DST)
        })?;
        let mut flags = vec![0; problem.free_count()];
        fixed.iter().for_each(|&place| flags[place as usize] = FIXED);
        let pins = Self { flags: Mutex::default(), bits, has_mask: AtomicBool::new(false) };
        pins.send(gpu, problem, mesh, &flags, &with(&flags, FIXED))?;
        *pins.flags() = flags;
        Ok(pins)
    }

    fn flags(&self) -> MutexGuard<'_, Vec<u8>> {
        self.flags.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Applies a change, sends the changed vertices to the device, and counts a change of the mesh. Does nothing if no
    /// vertex changes.
    pub(crate) fn change(
        &self,
        gpu: &Gpu,
        problem: &Problem,
        mesh: &MeshBuffers,
        change: &Change<'_>,
    ) -> Result<(), GpuError> {
        let mut flags = self.flags();
        let mut changed = Vec::new();
        let mut set = |flags: &mut [u8], places: &[u32], wanted: u8| {
            for &place in places {
                // Sweeps over the free vertices do not visit others.
                let Some(flag) = flags.get_mut(place as usize) else { continue };
                if *flag & PINNED != wanted {
                    *flag ^= PINNED;
                    changed.push(place);
                }
            }
        };
        match change {
            Change::Pin(places) => set(&mut flags, places, PINNED),
            Change::Unpin(places) => set(&mut flags, places, 0),
            Change::PinThese(places) => {
                let before = with(&flags, PINNED);
                set(&mut flags, &before, 0);
                set(&mut flags, places, PINNED);
            }
        }
        // A vertex that was unpinned and pinned again is listed twice.
        changed.sort_unstable();
        let once = changed.chunk_by(|a, b| a == b).filter(|same| same.len() == 1);
        let changed: Vec<u32> = once.map(|same| same[0]).collect();
        let changed: Vec<u32> =
            changed.into_iter().filter(|&place| flags[place as usize] & FIXED == 0).collect();
        if changed.is_empty() {
            return Ok(());
        }
        self.send(gpu, problem, mesh, &flags, &changed)?;
        mesh.changes.count(gpu)?;
        check_alive(&gpu.device)
    }

    /// Sends ring starts and bits of the vertices in `changed`, which is in ascending order, to the device.
    fn send(
        &self,
        gpu: &Gpu,
        problem: &Problem,
        mesh: &MeshBuffers,
        flags: &[u8],
        changed: &[u32],
    ) -> Result<(), GpuError> {
        let is_held = |place: usize| flags.get(place).is_some_and(|&flags| flags != 0);
        let start =
            |place: usize| problem.ring_start()[place] | if is_held(place) { HELD } else { 0 };
        let bits =
            |word: usize| (0..32).fold(0, |bits, i| bits | u32::from(is_held(32 * word + i)) << i);
        scoped(&gpu.device, || {
            let write = |buffer: &wgpu::Buffer, first: usize, words: &[u32]| {
                gpu.queue.write_buffer(buffer, 4 * first as u64, bytemuck::cast_slice(words));
            };
            // A write between changed vertices would release those that a mask holds.
            let of_starts = match self.has_mask.load(Ordering::Acquire) {
                true => runs(changed, 1),
                false => ranges(changed),
            };
            for (first, last) in of_starts {
                let starts: Vec<u32> = (first as usize..=last as usize).map(start).collect();
                write(&mesh.ring_start, first as usize, &starts);
            }
            for (first, last) in ranges(changed) {
                let (first, last) = (first as usize, last as usize);
                let words: Vec<u32> = (first / 32..=last / 32).map(bits).collect();
                write(&self.bits, first / 32, &words);
            }
        })
    }
}

/// Sliding vertices that the host holds in place, by device number. A pinned vertex holds its partner.
#[derive(Default)]
pub(crate) struct SlidingPins(Mutex<BTreeSet<u32>>);

impl SlidingPins {
    /// Applies a change, sends the changed vertices to the device, and counts a change of the mesh. Does nothing if no
    /// vertex changes.
    pub(crate) fn change(
        &self,
        gpu: &Gpu,
        curves: &Curves,
        changes: &Changes,
        change: &Change<'_>,
    ) -> Result<(), GpuError> {
        let mut pinned = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let before = pinned.clone();
        match change {
            Change::Pin(places) => pinned.extend(*places),
            Change::Unpin(places) => places.iter().for_each(|place| _ = pinned.remove(place)),
            Change::PinThese(places) => *pinned = places.iter().copied().collect(),
        }
        // A vertex without a partner has `NONE` in its place, as has a pinned vertex of no triangle.
        let holds = |pins: &BTreeSet<u32>, pair: &[u32; 2]| {
            pair.iter().any(|v| *v != NONE && pins.contains(v))
        };
        let all = curves.pairs.iter().enumerate();
        let now = all.map(|(index, pair)| (index, holds(&before, pair), holds(&pinned, pair)));
        let changed: Vec<_> = now.filter(|(_, before, now)| before != now).collect();
        if changed.is_empty() {
            return Ok(());
        }
        scoped(&gpu.device, || {
            changed.iter().for_each(|&(index, _, now)| curves.pin(gpu, index, now));
        })?;
        changes.count(gpu)
    }
}

/// A change of the pinned vertices, given by device numbers.
pub(crate) enum Change<'a> {
    Pin(&'a [u32]),
    Unpin(&'a [u32]),
    /// Pins exactly these vertices and unpins all others.
    PinThese(&'a [u32]),
}

/// Returns the vertices with a flag, in ascending order.
fn with(flags: &[u8], flag: u8) -> Vec<u32> {
    let has = |&(_, flags): &(u32, &u8)| flags & flag != 0;
    (0..).zip(flags).filter(has).map(|(place, _)| place).collect()
}

/// Returns the ranges, with inclusive ends, in which these vertices are sent.
fn ranges(places: &[u32]) -> Vec<(u32, u32)> {
    let ranges = runs(places, GAP);
    if ranges.len() <= WRITES { ranges } else { runs(places, u32::MAX) }
}

/// Returns ranges, with inclusive ends, of ascending vertices whose numbers differ by at most `gap` from one to the next.
fn runs(places: &[u32], gap: u32) -> Vec<(u32, u32)> {
    let parts = places.chunk_by(|&a, &b| b - a <= gap);
    parts.filter_map(|part| part.first().copied().zip(part.last().copied())).collect()
}

/// A mask in an application's buffer, which holds vertices in place. Created by
/// [`DeviceMesh::bind_mask`](crate::gpu::DeviceMesh::bind_mask), and usable after the mesh is dropped.
pub struct BoundMask {
    pipeline: Pipeline,
    bind_group: wgpu::BindGroup,
    count: u32,
    /// The kernel for sliding vertices, with its bind group and their number. `None` if no vertex slides.
    sliding: Option<(Pipeline, wgpu::BindGroup, u32)>,
}

impl BoundMask {
    pub(crate) fn new(
        gpu: &Gpu,
        problem: &Problem,
        mesh: &MeshBuffers,
        numbers: &wgpu::Buffer,
        pins: &Pins,
        window: &Window<'_>,
    ) -> Result<Self, GpuError> {
        pins.has_mask.store(true, Ordering::Release);
        let count = problem.free_count() as u32;
        let mask = Mask { vertices: count, offset: window.offset, padding: [0; 2] };
        let bind_group = scoped_to_buffer(&gpu.device, || {
            let uniform = filled(gpu, "mask", &[mask], Usage::UNIFORM);
            let bindings = MaskBindings {
                to_hold: uniform.as_entire_binding(),
                ring_start: mesh.ring_start.as_entire_binding(),
                numbers: numbers.as_entire_binding(),
                pins: pins.bits.as_entire_binding(),
                mask: window.binding(),
                changes: mesh.changes.buffer.as_entire_binding(),
            };
            gpu.pipelines.bind(&gpu.device, Positions::Whole, bindings)
        })?;
        let pipeline = gpu.pipelines.get(&gpu.device, &Kernel::HoldByMask, Positions::Whole)?;
        let Some(curves) = &mesh.curves else {
            return Ok(Self { pipeline, bind_group, count, sliding: None });
        };
        let slides = curves.pairs.len() as u32;
        let of_sliding = scoped_to_buffer(&gpu.device, || {
            let mask = Mask { vertices: slides, ..mask };
            let uniform = filled(gpu, "mask of sliding vertices", &[mask], Usage::UNIFORM);
            let bindings = SlidingMaskBindings {
                to_hold: uniform.as_entire_binding(),
                sliding: curves.vertices.as_entire_binding(),
                numbers: numbers.as_entire_binding(),
                mask: window.binding(),
                changes: mesh.changes.buffer.as_entire_binding(),
            };
            gpu.pipelines.bind(&gpu.device, Positions::Whole, bindings)
        })?;
        let kernel = Kernel::HoldSlidingByMask;
        let hold = gpu.pipelines.get(&gpu.device, &kernel, Positions::Whole)?;
        Ok(Self { pipeline, bind_group, count, sliding: Some((hold, of_sliding, slides)) })
    }

    /// Encodes the holding of vertices by the mask. When the command buffer runs, vertices with a nonzero word in the
    /// mask become held, and all other vertices are released. Vertices of [`Mesh::fixed`](crate::Mesh::fixed) and
    /// [pinned](crate::gpu::DeviceMesh::pin) vertices stay held. Encode this call again after any change of the mask,
    /// and after unpinning a masked vertex.
    pub fn encode_mask(&self, encoder: &mut impl Encoder) {
        let mut passes = encoder.passes("gpu-smooth mask");
        passes.run(&self.pipeline, None, |pass| {
            pass.set_bind_group(0, &self.bind_group, &[]);
            dispatch(pass, self.count);
        });
        let Some((pipeline, bind_group, count)) = &self.sliding else { return };
        passes.run(pipeline, None, |pass| {
            pass.set_bind_group(0, bind_group, &[]);
            dispatch(pass, *count);
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
