//! Reads buffers in each frame without waiting for the device.

use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};

use bytemuck::Pod;
use wgpu::BufferUsages as Usage;

use crate::error::GpuError;
use crate::gpu::device::Gpu;
use crate::gpu::device::buffers::zeroed;
use crate::gpu::embed::window::check_size;
use crate::gpu::scope::{WatchedDevice, check_alive, scoped, scoped_to_buffer};

/// Limit of the copies in flight. A device with three copies in flight gets no further copy.
const COPIES: usize = 3;

/// Reads a range of a buffer in each frame: [`ObjectiveValues`](crate::gpu::ObjectiveValues), the vertices or the share
/// of a move. Calls in a frame never wait: [`latest`](Self::latest) returns the values that have arrived, usually from
/// a frame or two ago. The application polls the device, as for its own work.
///
/// ```no_run
/// # use gpu_smooth::{*, gpu::*};
/// # fn f(
/// #     gpu: &Gpu, numbers: &wgpu::Buffer, objective: &BoundObjective, encoder: &mut wgpu::CommandEncoder,
/// # ) -> Result<(), GpuError> {
/// // Once; the buffer has usage COPY_SRC.
/// let mut readback = Readback::<ObjectiveValues>::new(gpu, numbers.slice(..), 1)?;
/// // In each frame.
/// objective.encode_objective(encoder);
/// readback.encode_readback(encoder);
/// if let Some([values]) = readback.latest()? {
///     println!("{} triangles are inverted", values.inverted);
/// }
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct Readback<T> {
    device: WatchedDevice,
    source: wgpu::Buffer,
    offset: u64,
    bytes: u64,
    copies: Vec<Staged>,
    /// Number of copies requested so far, including refused ones.
    requested: u64,
    latest: Vec<T>,
    /// Number of the latest copy that has arrived, counted from 0.
    arrived: Option<u64>,
    /// Number of the copy that the last call of [`latest`](Self::latest) returned.
    returned: Option<u64>,
}

/// A staging buffer.
#[derive(Debug)]
struct Staged {
    staging: wgpu::Buffer,
    state: Arc<AtomicU8>,
    /// Number of the copy in the staging buffer, among all requested copies.
    number: u64,
}

const FREE: u8 = 0;
const UNDER_WAY: u8 = 1;
const ARRIVED: u8 = 2;
const LOST: u8 = 3;

/// Reports the arrival of a copy. If the copy never arrives, as the command buffer was dropped, the staging buffer
/// becomes free again.
struct Arrival(Arc<AtomicU8>);

impl Arrival {
    fn tell(&self, result: Result<(), wgpu::BufferAsyncError>) {
        let state = if result.is_ok() { ARRIVED } else { LOST };
        self.0.store(state, Ordering::Release);
    }
}

impl Drop for Arrival {
    fn drop(&mut self) {
        let (from, to) = (UNDER_WAY, FREE);
        // This exchange fails if the copy has arrived, which is fine.
        let _ = self.0.compare_exchange(from, to, Ordering::AcqRel, Ordering::Relaxed);
    }
}

impl<T: Pod> Readback<T> {
    /// Creates a readback of the first `count` values of a slice of an application's buffer. Three staging buffers take
    /// three times the size of the values.
    ///
    /// # Errors
    /// [`GpuError::Buffer`] if the slice is too small, or if its buffer was created without `COPY_SRC` or belongs to
    /// another device; if the start of the slice or the total size, in bytes, is no multiple of 4; or if the size is 0.
    /// Another [`GpuError`] if the device fails.
    pub fn new(gpu: &Gpu, values: wgpu::BufferSlice<'_>, count: usize) -> Result<Self, GpuError> {
        let refuse = |problem: String| Err(GpuError::Buffer(problem));
        let (buffer, offset) = (values.buffer(), values.offset());
        if !buffer.usage().contains(Usage::COPY_SRC) {
            let usage = buffer.usage();
            return refuse(format!("it was made for {usage:?}, and needs COPY_SRC as well"));
        }
        let bytes = (count as u64).saturating_mul(size_of::<T>() as u64);
        if !offset.is_multiple_of(4) || !bytes.is_multiple_of(4) || bytes == 0 {
            return refuse(format!(
                "{bytes} bytes from byte {offset} on cannot be copied: size and offset must be multiples of 4, and the size at least 4"
            ));
        }
        check_size(values, bytes)?;
        let usage = Usage::COPY_DST | Usage::MAP_READ;
        let copies: Vec<Staged> = scoped(&gpu.device, || {
            let copy = |_| Staged {
                staging: zeroed(gpu, "readback", bytes, usage),
                state: Arc::new(AtomicU8::new(FREE)),
                number: 0,
            };
            (0..COPIES).map(copy).collect()
        })?;
        // This copy is never submitted, and finds a buffer of another device now, not in a frame.
        scoped_to_buffer(&gpu.device, || {
            let descriptor = wgpu::CommandEncoderDescriptor::default();
            let mut encoder = gpu.device.create_command_encoder(&descriptor);
            encoder.copy_buffer_to_buffer(buffer, offset, &copies[0].staging, 0, bytes);
            drop(encoder.finish());
        })?;
        check_alive(&gpu.device)?;
        let (device, source) = (gpu.device.clone(), buffer.clone());
        let (requested, latest, arrived, returned) = (0, Vec::new(), None, None);
        Ok(Self { device, source, offset, bytes, copies, requested, latest, arrived, returned })
    }

    /// Encodes a copy of the bound range at this point of the command buffer, and returns true. Encodes nothing and
    /// returns false while three copies are in flight, because the device is behind or nobody polls the device. Takes
    /// the values of copies that have arrived, so that [`latest`](Self::latest) need not be called in each frame. Copies
    /// in encoders that are never submitted have no effect.
    pub fn encode_readback(&mut self, encoder: &mut wgpu::CommandEncoder) -> bool {
        self.encode(encoder).is_some()
    }

    /// Encodes a copy and returns its number, counted from 0 and with refused copies; `None` while three copies are in
    /// flight.
    pub(crate) fn encode(&mut self, encoder: &mut wgpu::CommandEncoder) -> Option<u64> {
        // A lost copy stays lost, and `latest` returns the error.
        let _ = self.collect();
        let Self { source, offset, bytes, copies, requested, .. } = self;
        let number = *requested;
        *requested += 1;
        let copy = copies.iter_mut().find(|copy| copy.state.load(Ordering::Acquire) == FREE)?;
        copy.number = number;
        copy.state.store(UNDER_WAY, Ordering::Release);
        let arrival = Arrival(Arc::clone(&copy.state));
        encoder.copy_buffer_to_buffer(source, *offset, &copy.staging, 0, *bytes);
        let tell = move |result| arrival.tell(result);
        encoder.map_buffer_on_submit(&copy.staging, wgpu::MapMode::Read, .., tell);
        Some(copy.number)
    }

    /// Returns the values of the latest copy that has arrived; `None` before the first arrival. Never waits.
    ///
    /// # Errors
    /// [`GpuError::Lost`] if the device is lost. In a browser also the errors of earlier calls, as
    /// [`Gpu::errors`] describes.
    pub fn latest(&mut self) -> Result<Option<&[T]>, GpuError> {
        self.device.check()?;
        self.collect()?;
        // A device that the application destroys reports the copies in flight as lost. Other losses leave the copies under way,
        // and without a copy, only a trial shows any loss.
        let all_are =
            |state| self.copies.iter().all(|own| own.state.load(Ordering::Acquire) == state);
        if all_are(FREE) || all_are(UNDER_WAY) {
            check_alive(&self.device)?;
        }
        self.returned = self.arrived;
        Ok(self.arrived.is_some().then_some(&self.latest[..]))
    }

    /// Returns the values of the latest copy that has arrived, as [`latest`](Self::latest) does, but without a check of the device
    /// and of earlier calls.
    pub(crate) fn latest_unchecked(&mut self) -> Option<&[T]> {
        self.collect().ok()?;
        self.arrived.is_some().then_some(&self.latest[..])
    }

    /// Returns how many copies were requested after the copy that [`latest`](Self::latest) returned, including copies
    /// that [`encode_readback`](Self::encode_readback) refused: 0 for the newest. `None` before `latest` has returned
    /// values.
    pub fn age(&self) -> Option<u64> {
        self.returned.map(|number| self.requested - 1 - number)
    }

    /// Returns the number of the latest copy that has arrived, counted from 0.
    pub(crate) fn arrived(&self) -> Option<u64> {
        self.arrived
    }

    /// Takes the values of the copies that have arrived, and frees their staging buffers.
    fn collect(&mut self) -> Result<(), GpuError> {
        let lost = || GpuError::Lost("a buffer could not be read back".into());
        for copy in &self.copies {
            match copy.state.load(Ordering::Acquire) {
                LOST => return Err(lost()),
                ARRIVED => {}
                _ => continue,
            }
            if self.arrived.is_none_or(|number| number < copy.number) {
                let view = copy.staging.get_mapped_range(..).map_err(|_| lost())?;
                self.latest.clear();
                match bytemuck::try_cast_slice(&view) {
                    Ok(values) => self.latest.extend_from_slice(values),
                    // The alignment of a value may be larger than that of mapped memory.
                    Err(_) => {
                        let values = view.chunks_exact(size_of::<T>());
                        self.latest.extend(values.map(bytemuck::pod_read_unaligned::<T>));
                    }
                }
                self.arrived = Some(copy.number);
            }
            copy.staging.unmap();
            copy.state.store(FREE, Ordering::Release);
        }
        Ok(())
    }
}
