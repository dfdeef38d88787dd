//! The engine of a run: the CPU or a device.

/// The engine that computes the sweeps of a run.
#[derive(Clone, Debug)]
pub enum Backend {
    /// All cores of the CPU, in double precision.
    Cpu,
    /// A wgpu device.
    #[cfg(feature = "gpu")]
    Gpu(crate::gpu::Gpu),
}
