//! The place where the sweeps of a run are computed.

/// Where the sweeps of a run are computed.
pub enum Backend {
    /// All cores of the CPU, in double precision.
    Cpu,
    /// A wgpu device.
    #[cfg(feature = "gpu")]
    Gpu(crate::gpu::Gpu),
}
