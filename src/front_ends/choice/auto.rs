//! The choice of a backend.

use crate::error::GpuError;
#[cfg(feature = "gpu")]
use crate::front_ends::choice::kept::Kept;
use crate::front_ends::choice::reason::BackendReason;
use crate::mesh::MeshSize;
use crate::options::Options;
use crate::smoother::Backend;

impl Backend {
    /// Returns the backend on which a run is estimated to end soonest, and the reason. The estimate includes the start
    /// of the GPU's driver.
    ///
    /// Meshes that are too small for any GPU to be faster start no driver. A software adapter is never chosen;
    /// `Gpu::open` opens one. The estimate assumes slow GPUs, as no graphics card has been measured yet:
    /// `gpu-smooth bench` measures which backend is fastest. Without the feature `gpu`, the CPU is chosen.
    pub fn auto(size: MeshSize, options: &Options) -> (Self, BackendReason) {
        Self::auto_tried(size, options, || Ok(()))
    }

    /// Chooses like [`auto`](Self::auto), but calls `try_drivers` before a driver is started in this process, as a
    /// driver that crashes would end the process. `try_drivers` may start the drivers in a separate process and watch
    /// that process, as the `gpu-smooth` command does. If `try_drivers` returns an error, such as
    /// [`GpuError::Crashed`], the CPU is chosen. `try_drivers` is not called for meshes that are too small for any GPU
    /// to be faster.
    pub fn auto_tried(
        size: MeshSize,
        options: &Options,
        try_drivers: impl FnOnce() -> Result<(), GpuError>,
    ) -> (Self, BackendReason) {
        BackendChooser::new().choose(size, options, try_drivers)
    }
}

/// Chooses backends for many runs. The best adapter and its device are kept: each choice of the GPU returns a handle to
/// the same [`Gpu`](crate::Gpu), so that drivers start once, and kernels are compiled once.
///
/// Any thread may choose. A choice waits while another thread starts the drivers. A process that was forked from a
/// process with an open device must not choose, as drivers do not survive a fork.
#[derive(Default)]
pub struct BackendChooser {
    #[cfg(feature = "gpu")]
    kept: Kept,
}

impl BackendChooser {
    /// Creates a chooser without an adapter. No driver is started.
    pub const fn new() -> Self {
        Self {
            #[cfg(feature = "gpu")]
            kept: Kept::new(),
        }
    }

    /// Chooses like [`Backend::auto_tried`]. Equal arguments have equal results, whether or not a device is open: the
    /// estimate always includes the start of the driver, so that a mesh does not get other bits because of earlier runs.
    ///
    /// `try_drivers` is called before each search for adapters: in the first choice that considers a GPU, and after the
    /// loss of the device, which a new device replaces. An error of `try_drivers` is kept, and later choices return the CPU.
    #[cfg(feature = "gpu")]
    pub fn choose(
        &self,
        size: MeshSize,
        options: &Options,
        try_drivers: impl FnOnce() -> Result<(), GpuError>,
    ) -> (Backend, BackendReason) {
        crate::front_ends::choice::estimate::choose(&self.kept, size, options, try_drivers)
    }

    /// Returns the CPU, the only engine of a build without the feature `gpu`.
    #[cfg(not(feature = "gpu"))]
    pub fn choose(
        &self,
        _: MeshSize,
        _: &Options,
        _: impl FnOnce() -> Result<(), GpuError>,
    ) -> (Backend, BackendReason) {
        (Backend::Cpu, BackendReason::OnlyCpu)
    }
}

#[cfg(all(test, not(feature = "gpu")))]
mod tests {
    use super::*;

    #[test]
    fn the_cpu_is_chosen_where_there_is_no_other_engine() {
        let size = MeshSize { vertices: 100_000_000, triangles: 200_000_000 };
        let tried = || panic!("there is no driver to try");
        let (backend, reason) = Backend::auto_tried(size, &Options::default(), tried);
        assert!(matches!((backend, &reason), (Backend::Cpu, BackendReason::OnlyCpu)), "{reason}");
    }
}
