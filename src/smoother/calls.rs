//! The calls that begin a run and block until the run ends.

use std::ops::ControlFlow;

use crate::error::SmoothError;
use crate::mesh::Mesh;
use crate::outcome::Outcome;
use crate::run::{Checkpoint, Keeper, NoKeeper, Observer, Options, Progress};

use super::backend::Backend;
use super::prepared::Smoother;

impl Smoother<'_> {
    /// Smooths the mesh. Blocks until the run ends.
    ///
    /// # Errors
    /// [`SmoothError::Option`] if an option is out of its range, [`SmoothError::Gpu`] if the device fails. If the mesh
    /// does not fit the device, the error holds [`GpuError::Limit`](crate::GpuError::Limit) or
    /// [`GpuError::TooLarge`](crate::GpuError::TooLarge), and is returned before anything is done.
    pub fn run(&self, options: &Options, backend: &Backend) -> Result<Outcome, SmoothError> {
        self.run_observed(options, backend, &mut unobserved)
    }

    /// Smooths the mesh as [`run`](Self::run) does. `observe` is called every few sweeps and can end the run; the best state
    /// so far is then returned.
    ///
    /// # Errors
    /// [`SmoothError::Option`] or [`SmoothError::Gpu`]; [`run`](Self::run) gives the conditions.
    pub fn run_observed(
        &self,
        options: &Options,
        backend: &Backend,
        observe: &mut (impl Observer + ?Sized),
    ) -> Result<Outcome, SmoothError> {
        self.run_kept(options, backend, None, &mut NoKeeper, observe)
    }

    /// Smooths the mesh as [`run`](Self::run) does. `keeper` decides which checkpoints are taken, from which the run
    /// can continue later, and whether the run continues on the CPU if the device fails.
    ///
    /// With `from`, the run continues from a checkpoint of a run on the same mesh with the same options. On the engine
    /// that took the checkpoint it gives the same bits as if that run had never been interrupted. A run whose
    /// checkpoint was taken on the CPU continues there, with any backend.
    ///
    /// # Errors
    /// [`SmoothError::Checkpoint`] if the checkpoint is from another run; [`SmoothError::Option`] or [`SmoothError::Gpu`]
    /// under the conditions that [`run`](Self::run) gives.
    pub fn run_kept(
        &self,
        options: &Options,
        backend: &Backend,
        from: Option<&Checkpoint>,
        keeper: &mut (impl Keeper + ?Sized),
        observe: &mut (impl Observer + ?Sized),
    ) -> Result<Outcome, SmoothError> {
        let device = match backend {
            Backend::Cpu => None,
            #[cfg(feature = "gpu")]
            Backend::Gpu(gpu) => Some(crate::whole::Device::blocking(gpu)),
        };
        pollster::block_on(self.run_at(options, device, from, keeper, observe))
    }
}

/// An observer that never ends the run.
pub(super) fn unobserved(_: &Progress) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// Smooths a mesh given as slices, in one blocking call. `points` are positions in any unit, `triangles` zero-based
/// vertex triples in either winding. The boundary stays fixed. Returns the positions in the order of `points`.
///
/// # Errors
/// [`SmoothError::Mesh`] under the conditions that [`Smoother::new`] gives, [`SmoothError::Option`] or
/// [`SmoothError::Gpu`] under those of [`Smoother::run`].
pub fn smooth(
    points: &[[f64; 2]],
    triangles: &[[u32; 3]],
    options: &Options,
    backend: &Backend,
) -> Result<Vec<[f64; 2]>, SmoothError> {
    let mesh = Mesh { points: points.to_vec(), triangles: triangles.to_vec(), fixed: Vec::new() };
    let smoother = Smoother::new(&mesh)?;
    Ok(smoother.run(options, backend)?.points)
}
