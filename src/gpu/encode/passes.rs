//! Compute passes: a single pass for a call, or a timed pass per kernel.

use std::ops::{Deref, DerefMut};

use crate::error::GpuError;
use crate::gpu::encode::timestamps::{Spans, Timestamps};
use crate::gpu::kernels::pipelines::Pipeline;

/// A destination for kernels: an application's [`wgpu::CommandEncoder`], a [`wgpu::ComputePass`] that the application
/// has begun, or an encoder whose kernels are timed, made by [`Timestamps::time`].
///
/// In a pass of the application, each call sets another pipeline and bind group 0. A dispatch sees all writes of
/// earlier dispatches, including the application's own.
pub trait Encoder: sealed::Target {}

impl Encoder for wgpu::CommandEncoder {}
impl Encoder for wgpu::ComputePass<'_> {}
impl Encoder for Timed<'_> {}

/// Keeps other crates from implementing [`Encoder`].
pub(crate) mod sealed {
    use super::Passes;

    pub trait Target {
        /// Opens the passes of one call.
        fn passes(&mut self, label: &'static str) -> Passes<'_>;
    }
}

impl sealed::Target for wgpu::CommandEncoder {
    fn passes(&mut self, label: &'static str) -> Passes<'_> {
        let pass = self.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(label),
            timestamp_writes: None,
        });
        Passes(State::One { pass, set: None })
    }
}

impl sealed::Target for wgpu::ComputePass<'_> {
    fn passes(&mut self, _: &'static str) -> Passes<'_> {
        Passes(State::Given { pass: self, set: None })
    }
}

/// A pass that an application has begun, with any lifetime.
trait Given {
    fn with(&mut self, encode: &mut dyn FnMut(&mut wgpu::ComputePass<'_>));
}

impl Given for wgpu::ComputePass<'_> {
    fn with(&mut self, encode: &mut dyn FnMut(&mut wgpu::ComputePass<'_>)) {
        encode(self);
    }
}

/// The compute passes into which one call encodes its kernels.
pub struct Passes<'e>(State<'e>);

// Not boxed: the value lives on the stack during one call, and a box would cost more than the space.
#[allow(clippy::large_enum_variant)]
enum State<'e> {
    /// All kernels in one pass. `set` is the current pipeline of the pass.
    One { pass: wgpu::ComputePass<'e>, set: Option<wgpu::ComputePipeline> },
    /// All kernels in the application's pass. `set` holds the pipeline last set by this call.
    Given { pass: &'e mut (dyn Given + 'e), set: Option<wgpu::ComputePipeline> },
    /// Each kernel in its own pass, as core WebGPU takes timestamps only at the ends of passes.
    Timed { encoder: &'e mut wgpu::CommandEncoder, timestamps: &'e mut Timestamps },
}

impl<'e> Passes<'e> {
    /// Begins one pass for all kernels, with timestamps at the two ends of the pass.
    pub(crate) fn clocked(
        encoder: &'e mut wgpu::CommandEncoder,
        label: &'static str,
        timestamp_writes: wgpu::ComputePassTimestampWrites<'_>,
    ) -> Self {
        let pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(label),
            timestamp_writes: Some(timestamp_writes),
        });
        Self(State::One { pass, set: None })
    }

    pub(crate) fn timed(
        encoder: &'e mut wgpu::CommandEncoder,
        timestamps: &'e mut Timestamps,
    ) -> Self {
        Self(State::Timed { encoder, timestamps })
    }

    /// Encodes a kernel: `dispatch` binds and dispatches. `color` is the color of a sweep, for timestamps.
    pub(crate) fn run(
        &mut self,
        pipeline: &Pipeline,
        color: Option<u32>,
        dispatch: impl FnOnce(&mut wgpu::ComputePass<'_>),
    ) {
        pipeline.count_dispatch();
        match &mut self.0 {
            State::One { pass, set } => {
                if set.as_ref() != Some(&pipeline.raw) {
                    pass.set_pipeline(&pipeline.raw);
                    *set = Some(pipeline.raw.clone());
                }
                dispatch(pass);
            }
            State::Given { pass, set } => {
                let is_set = set.as_ref() == Some(&pipeline.raw);
                // The closure is called once.
                let mut dispatch = Some(dispatch);
                pass.with(&mut |pass| {
                    if !is_set {
                        pass.set_pipeline(&pipeline.raw);
                    }
                    if let Some(dispatch) = dispatch.take() {
                        dispatch(pass);
                    }
                });
                if !is_set {
                    *set = Some(pipeline.raw.clone());
                }
            }
            State::Timed { encoder, timestamps } => {
                let label = pipeline.kernel.label();
                let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                    label: Some(&label),
                    timestamp_writes: timestamps.next(&pipeline.kernel, color),
                });
                pass.set_pipeline(&pipeline.raw);
                dispatch(&mut pass);
            }
        }
    }
}

/// An application's encoder in which the kernels of this library are timed. All encoding calls of this library accept a
/// `Timed`. A `Timed` dereferences to the encoder, so that the application can encode untimed work of its own.
pub struct Timed<'t> {
    encoder: &'t mut wgpu::CommandEncoder,
    timestamps: &'t mut Timestamps,
}

impl Deref for Timed<'_> {
    type Target = wgpu::CommandEncoder;

    fn deref(&self) -> &wgpu::CommandEncoder {
        self.encoder
    }
}

impl DerefMut for Timed<'_> {
    fn deref_mut(&mut self) -> &mut wgpu::CommandEncoder {
        self.encoder
    }
}

impl sealed::Target for Timed<'_> {
    fn passes(&mut self, _: &'static str) -> Passes<'_> {
        Passes::timed(self.encoder, self.timestamps)
    }
}

impl Timestamps {
    /// Returns an encoder in which the kernels of this library are timed. Forgets the times of an earlier encoder.
    /// Submits nothing.
    pub fn time<'t>(&'t mut self, encoder: &'t mut wgpu::CommandEncoder) -> Timed<'t> {
        self.restart();
        Timed { encoder, timestamps: self }
    }
}

impl Timed<'_> {
    /// Ends the timing and encodes the copy of the times into a buffer. Without this call, kernels run, but their times
    /// are lost.
    ///
    /// # Errors
    /// [`GpuError::OutOfMemory`], or another [`GpuError`] if the device fails.
    pub fn resolve(self) -> Result<Spans, GpuError> {
        self.timestamps.resolve(self.encoder)
    }
}
