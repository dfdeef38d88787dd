//! Measures the device's time for each kernel.

use wgpu::BufferUsages as Usage;

use crate::error::GpuError;
use crate::gpu::device::Gpu;
use crate::gpu::device::buffers::zeroed;
use crate::gpu::device::pending::{Pending, Waiting};
use crate::gpu::device::readback;
use crate::gpu::kernels::table::Kernel;
use crate::gpu::scope::scoped;

/// Number of spans in a query set. WebGPU allows 4096 queries in a set.
const SET: usize = 1024;
/// Bytes of a span: two timestamps.
const SPAN: u64 = 2 * wgpu::QUERY_SIZE as u64;

/// Measures by the device's clock how long the kernels of this library take. Needs a device with
/// [`Features::TIMESTAMP_QUERY`](wgpu::Features::TIMESTAMP_QUERY), see [`Gpu::optional_features`].
///
/// Each timed kernel, and each color of a sweep, gets its own pass. A timed frame therefore takes a little longer.
///
/// ```no_run
/// # use gpu_smooth::{*, gpu::*};
/// # fn f(gpu: &Gpu, sweeps: &mut Sweeps, vertices: &BoundVertices) -> Result<(), GpuError> {
/// let mut timestamps = Timestamps::new(gpu)?;
///
/// let mut encoder = gpu.device().create_command_encoder(&Default::default());
/// let mut timed = timestamps.time(&mut encoder);
/// vertices.encode_import(&mut timed);
/// sweeps.encode_sweeps(&mut timed, 5);
/// vertices.encode_export(&mut timed);
/// let spans = timed.resolve()?;
/// gpu.queue().submit([encoder.finish()]);
///
/// for span in spans.read().block()? {
///     println!("{} {:?}: {} ns", span.kernel.label(), span.color, span.nanoseconds);
/// }
/// # Ok(())
/// # }
/// ```
pub struct Timestamps {
    gpu: Gpu,
    /// Query sets, reused for each encoder. Another set is created when the spans of an encoder exceed the sets.
    sets: Vec<wgpu::QuerySet>,
    /// The timed kernels in the order of encoding, with their colors.
    taken: Vec<(Kernel, Option<u32>)>,
    failed: Option<GpuError>,
}

impl Timestamps {
    /// Creates timestamps for one device. The object can time many encoders in succession.
    ///
    /// # Errors
    /// [`GpuError::Feature`] if the device was created without `TIMESTAMP_QUERY`.
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        if !gpu.device.features().contains(Gpu::optional_features()) {
            return Err(GpuError::Feature { what: "timing", feature: "TIMESTAMP_QUERY" });
        }
        Ok(Self { gpu: gpu.clone(), sets: Vec::new(), taken: Vec::new(), failed: None })
    }

    /// Forgets the spans of the last encoder.
    pub(crate) fn restart(&mut self) {
        self.taken.clear();
        self.failed = None;
    }

    /// Encodes the copy of the times into a buffer.
    pub(crate) fn resolve(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
    ) -> Result<Spans, GpuError> {
        let Self { gpu, sets, taken, failed } = self;
        if let Some(error) = failed.take() {
            return Err(error);
        }
        let taken = std::mem::take(taken);
        let times = scoped(&gpu.device, || {
            let bytes = SPAN * taken.len().max(1) as u64;
            zeroed(gpu, "timestamps", bytes, Usage::QUERY_RESOLVE | Usage::COPY_SRC)
        })?;
        for (set, (query_set, part)) in sets.iter().zip(taken.chunks(SET)).enumerate() {
            let to = set as u64 * SET as u64 * SPAN;
            encoder.resolve_query_set(query_set, 0..2 * part.len() as u32, &times, to);
        }
        Ok(Spans { gpu: gpu.clone(), times, taken })
    }

    /// Returns the queries to which the next pass, with this kernel, writes its times. `None` if a query set could not
    /// be created; [`resolve`](Self::resolve) then returns the error.
    pub(crate) fn next(
        &mut self,
        kernel: &Kernel,
        color: Option<u32>,
    ) -> Option<wgpu::ComputePassTimestampWrites<'_>> {
        let (set, first) = (self.taken.len() / SET, 2 * (self.taken.len() % SET) as u32);
        if set == self.sets.len() {
            let made = scoped(&self.gpu.device, || {
                self.gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
                    label: Some("gpu-smooth timestamps"),
                    ty: wgpu::QueryType::Timestamp,
                    count: 2 * SET as u32,
                })
            });
            match made {
                Ok(made) => self.sets.push(made),
                Err(error) => self.failed = Some(error),
            }
        }
        let query_set = self.sets.get(set)?;
        self.taken.push((kernel.clone(), color));
        Some(wgpu::ComputePassTimestampWrites {
            query_set,
            beginning_of_pass_write_index: Some(first),
            end_of_pass_write_index: Some(first + 1),
        })
    }
}

/// The times of one encoder's kernels, to be read once its command buffer has been submitted.
pub struct Spans {
    gpu: Gpu,
    times: wgpu::Buffer,
    taken: Vec<(Kernel, Option<u32>)>,
}

/// The measured time of a kernel's pass.
#[derive(Clone, Debug, PartialEq)]
pub struct Span {
    /// The kernel; [`Kernel::label`] names it.
    pub kernel: Kernel,
    /// Color of the swept vertices, from 0 on; `None` for kernels that sweep no color.
    pub color: Option<u32>,
    /// Time from the start of the first timed kernel to the start of this kernel, in nanoseconds.
    pub start: f64,
    /// Time from the start to the end of this kernel's pass, in nanoseconds.
    pub nanoseconds: f64,
}

impl Spans {
    /// Returns the times in the order of encoding, once the device has finished all submitted work.
    ///
    /// # Errors
    /// [`GpuError::Lost`] if the device is lost.
    pub fn read(self) -> Pending<'static, Vec<Span>> {
        Pending::new(|waiting| Box::pin(self.wait(waiting)))
    }

    pub(crate) async fn wait(self, waiting: Waiting) -> Result<Vec<Span>, GpuError> {
        let Self { gpu, times, taken } = self;
        if taken.is_empty() {
            return Ok(Vec::new());
        }
        let times: Vec<[u64; 2]> = readback::read(&gpu, &times, taken.len(), waiting).await?;
        let period = f64::from(gpu.queue.get_timestamp_period());
        let origin = times.first().map_or(0, |&[start, _]| start);
        // Clocks of devices are known to jump back now and then.
        let between = |from: u64, to: u64| to.saturating_sub(from) as f64 * period;
        let spans = taken.into_iter().zip(times).map(|((kernel, color), [start, end])| {
            let nanoseconds = between(start, end);
            Span { kernel, color, start: between(origin, start), nanoseconds }
        });
        Ok(spans.collect())
    }
}
