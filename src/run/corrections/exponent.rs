//! The exponent of EDGE's p-norm in a run with corrections: its doublings, its last value, and the remaining gain of f.

use super::plan_steps::exponents;
use super::state::{Correcting, Corrections, Stage};
use crate::options::PNormExponent;
use crate::run::history::History;

/// Relative decrease of the p-norm by a sweep with its correction, times the exponent k, below which k doubles. A third
/// of this number costs a few more sweeps and ends slightly lower. Three times as much leaves more sweeps to the last
/// exponents, which gain little with each sweep.
const RAISED_BELOW: f64 = 3e-3;
/// Smallest tolerance of the p-norm, as a share of the distance [`above`](Corrections::above) from the minimum of f.
/// With the last exponent, a closer minimum of the p-norm would hardly lower f.
const PART: f64 = 0.3;

impl Corrections {
    /// Returns the present exponent k of EDGE's p-norm.
    pub(super) fn exponent(&self) -> f64 {
        f64::from(1u32 << self.sharpness)
    }

    /// Returns the distance of f at the minimum of the p-norm from the minimum of f itself, as a share of f: about
    /// 0.16/k. 0 if the exponent cannot grow, as when the caller has fixed it.
    pub(super) fn above(&self) -> f64 {
        let exponents = exponents(&self.plan);
        if exponents.start() < exponents.end() {
            PNormExponent::ABOVE / self.exponent()
        } else {
            0.0
        }
    }

    /// Returns the tolerance for the objective that corrections lower. f is then within `tolerance`, as far as the
    /// exponent allows.
    pub(super) fn tolerance_of_norm(&self, tolerance: f64) -> f64 {
        let above = self.above();
        if tolerance > 0.0 && above > 0.0 {
            (tolerance - above).max(PART * above)
        } else {
            tolerance
        }
    }

    /// Returns whether the exponent has doubled to its last value.
    pub(super) fn has_grown(&self) -> bool {
        self.above() > 0.0 && self.is_sharpest()
    }

    /// Returns whether the exponent has reached its last value.
    pub(super) fn is_sharpest(&self) -> bool {
        self.sharpness == *exponents(&self.plan).end()
    }

    /// Returns whether the last sweep and its correction lowered the objective too little for the present exponent.
    pub(super) fn gains_little(&self, history: &History) -> bool {
        let of_stage = match self.stage {
            Stage::Before { .. } | Stage::Stepping { .. } => return false,
            Stage::Correcting(_) => &self.lowered[..],
            Stage::Without { since } => &history.f()[since..],
        };
        let gained_little = match of_stage {
            [.., before, f] => before - f < RAISED_BELOW * f / self.exponent(),
            _ => false,
        };
        gained_little || self.settled
    }

    /// Doubles the exponent of EDGE's p-norm after the evaluation of index `last`.
    pub(super) fn raise_exponent(&mut self, last: usize) {
        self.sharpness += 1;
        self.settled = false;
        match self.stage {
            Stage::Before { .. } | Stage::Stepping { .. } => {}
            Stage::Correcting(Correcting { length, .. }) => self.begin_correcting(last, length),
            // The guard may accept corrections with the next exponent that it refuses with the present one.
            Stage::Without { .. } if self.has_levels => self.begin_correcting(last, 1.0),
            Stage::Without { .. } => self.stage = Stage::Without { since: last },
        }
    }
}
