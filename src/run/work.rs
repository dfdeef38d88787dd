//! The description of a run that a device needs before the first sweep.

use crate::run::sweep_params::SweepParams;

/// The work of a run, for which a device prepares before the first sweep.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Work {
    /// All distinct steps of the sweeps.
    pub(crate) steps: Vec<SweepParams>,
    pub(crate) ending: Ending,
    /// Whether a Newton step of all vertices measures the remaining gain at the end.
    pub(crate) is_measured: bool,
}

/// The method of a run after the first sweeps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ending {
    /// Further sweeps.
    Sweeps,
    /// Corrections from coarser levels.
    Corrections,
    /// Newton steps of all vertices, or corrections on an engine that takes no such steps.
    Steps,
}

impl Work {
    /// Returns the work of sweeps by `steps` alone.
    pub(crate) fn of_sweeps(steps: Vec<SweepParams>) -> Self {
        Self { steps, ending: Ending::Sweeps, is_measured: false }
    }
}
