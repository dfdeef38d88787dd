//! The exponent of EDGE's p-norm in a run with corrections: when it doubles, how far it does, and what it leaves of f.

use super::plan_steps::exponents;
use super::state::{Correcting, Corrections, Stage};
use crate::options::PNormExponent;
use crate::run::history::History;

/// The exponent k of EDGE's p-norm doubles once a sweep with its correction lowers the p-norm by less than this share over k. A third of it
/// takes a few sweeps more and ends a little lower; three times as much leaves more to the last exponents, which gain little a sweep.
const RAISED_BELOW: f64 = 3e-3;
/// The p-norm with the last exponent is lowered to within this part of what that leaves of f.
const PART: f64 = 0.3;

impl Corrections {
    /// The present exponent of EDGE's p-norm.
    pub(super) fn exponent(&self) -> f64 {
        f64::from(1u32 << self.sharpness)
    }

    /// The share of f by which the exponent keeps it above a minimum of its own. None is told of an exponent that the caller has chosen.
    pub(super) fn above(&self) -> f64 {
        let exponents = exponents(&self.plan);
        if exponents.start() < exponents.end() {
            PNormExponent::ABOVE / self.exponent()
        } else {
            0.0
        }
    }

    /// The tolerance of what corrections lower, such that f is within this one as far as the exponent allows.
    pub(super) fn tolerance_of_norm(&self, tolerance: f64) -> f64 {
        let above = self.above();
        if tolerance > 0.0 && above > 0.0 {
            (tolerance - above).max(PART * above)
        } else {
            tolerance
        }
    }

    /// Whether the exponent has doubled as often as it is going to.
    pub(super) fn has_grown(&self) -> bool {
        self.above() > 0.0 && self.is_sharpest()
    }

    /// Whether the exponent is not going to double any more.
    pub(super) fn is_sharpest(&self) -> bool {
        self.sharpness == *exponents(&self.plan).end()
    }

    /// Whether the last sweep, with its correction if it has one, has lowered the objective by little.
    pub(super) fn gains_little(&self, history: &History) -> bool {
        let of_stage = match self.stage {
            Stage::Before { .. } => return false,
            Stage::Correcting(_) => &self.lowered[..],
            Stage::Without { since } => &history.f()[since..],
        };
        let gained_little = match of_stage {
            [.., before, f] => before - f < RAISED_BELOW * f / self.exponent(),
            _ => false,
        };
        gained_little || self.settled
    }

    /// Doubles the exponent of EDGE's p-norm after the evaluation `last`.
    pub(super) fn raise_exponent(&mut self, last: usize) {
        self.sharpness += 1;
        self.settled = false;
        match self.stage {
            Stage::Before { .. } => {}
            Stage::Correcting(Correcting { length, .. }) => self.begin_correcting(last, length),
            // Corrections that the guard refuses by one exponent may be taken by the next.
            Stage::Without { .. } if self.has_levels => self.begin_correcting(last, 1.0),
            Stage::Without { .. } => self.stage = Stage::Without { since: last },
        }
    }
}
