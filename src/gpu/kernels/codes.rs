//! Codes that the kernels give for the end of a run.

use crate::run::Stop;

impl Stop {
    /// The codes by which finish.wgsl names the reasons that a device can find; 0 means that the run continues.
    pub(crate) const CODES: [(Stop, u32); 4] =
        [(Stop::Reached, 1), (Stop::Converged, 2), (Stop::Stalled, 3), (Stop::MaxSweeps, 4)];

    /// Returns the reason that has a code.
    pub(crate) fn from_code(code: u32) -> Option<Self> {
        Self::CODES.iter().find(|&&(_, c)| c == code).map(|&(stop, _)| stop)
    }
}
