//! The progress of a run, and the callback that receives it.

use std::ops::ControlFlow;

/// A callback that receives the progress of a run and can end the run: any `FnMut(&Progress) -> ControlFlow<()>` that
/// is `Send`. Browsers have no threads, so `Send` is not required there.
#[cfg(not(target_family = "wasm"))]
pub trait Observer: FnMut(&Progress) -> ControlFlow<()> + Send {}

#[cfg(not(target_family = "wasm"))]
impl<F: FnMut(&Progress) -> ControlFlow<()> + Send + ?Sized> Observer for F {}

/// A callback that receives the progress of a run and can end the run: any `FnMut(&Progress) -> ControlFlow<()>`.
#[cfg(target_family = "wasm")]
pub trait Observer: FnMut(&Progress) -> ControlFlow<()> {}

#[cfg(target_family = "wasm")]
impl<F: FnMut(&Progress) -> ControlFlow<()> + ?Sized> Observer for F {}

/// Returns whether a run goes on, asked in the middle of a long step.
pub(crate) type GoesOn<'o> = dyn FnMut() -> bool + Send + 'o;

/// The progress of a run, as reported to an [`Observer`].
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// The part of the run in progress.
    pub phase: Phase,
    /// Number of completed sweeps. [`Phase::Reference`] takes up to three runs, each counted from 0.
    pub sweep: u32,
    /// Objective by the base metric of the scheme in use.
    pub f: f64,
}

/// A part of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Phase {
    /// The search for the optimum, if [`Goal::desired`](crate::Goal::desired) is `None`.
    Reference,
    /// The smoothing of the mesh.
    Smoothing,
    /// The stage after the last sweep that improves the worst triangles
    /// ([`Options::improve_worst`](crate::Options::improve_worst)). The stage counts passes instead of sweeps.
    Improving,
}
