//! Codes by which kernels report the reason for the end of a run.

use crate::run::Stop;

impl Stop {
    /// The codes by which finish.wgsl names the reasons that a device can find; 0 means that the run continues.
    pub(crate) const CODES: [(Stop, u32); 4] =
        [(Stop::Reached, 1), (Stop::Converged, 2), (Stop::Stalled, 3), (Stop::MaxSweeps, 4)];

    /// Returns the reason with this code; `None` for 0 and unknown codes.
    pub(crate) fn from_code(code: u32) -> Option<Self> {
        Self::CODES.iter().find(|&&(_, c)| c == code).map(|&(stop, _)| stop)
    }
}
