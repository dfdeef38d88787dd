//! The parameters of one sweep.

use crate::metric::Metric;

/// The parameters by which one sweep visits every free vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// The metric that the sweep lowers.
    pub metric: Metric,
    /// Over-relaxation: each Newton step is first tried at this multiple.
    pub omega: f64,
    /// The most Newton steps per visit of a vertex.
    pub inner: u32,
    /// log2 k of the exponent k of EDGE's p-norm.
    pub sharpness: u32,
    /// How the metric is differentiated.
    pub derivatives: Derivatives,
    /// The largest inverse mean ratio that a step may leave, unless the patch already had a larger one: the smaller of
    /// [`Plan::shape_guard`](super::Plan::shape_guard) and that of the metric, if it has no barrier, and of
    /// [`Plan::worst_guard`](super::Plan::worst_guard), less a reserve for rounding. Infinite for none.
    pub shape_guard: f64,
    /// How many times as long as Newton's a step may be tried where nearly flat triangles make up most of a patch's objective; 1
    /// for never.
    pub longest: f64,
}

/// How a metric is differentiated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Derivatives {
    /// Exactly, by formulas that tests hold against dual numbers.
    #[default]
    Analytic,
    /// By forward differences of the value, 16 evaluations per triangle, as Mesquite differentiates
    /// a metric without derivatives of its own (EDGE, AREA and RMS of Park & Shontz). Slower
    /// and no better: only there to test the paper's cost model.
    FiniteDifference,
}

/// The exponent k of the p-norm that replaces EDGE in Newton's method, for each sweep. Given as log2 k.
///
/// In runs with corrections from coarser levels, k doubles whenever a sweep with its correction gains little by the p-norm, not after a
/// number of sweeps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Sharpness {
    /// log2 k of the first sweep.
    pub first: u32,
    /// Number of sweeps alone after which k doubles; 0 keeps k constant, in any run.
    pub every: u32,
    /// log2 k of the largest k.
    pub last: u32,
}

impl Sharpness {
    /// k = 16 throughout: good after a few sweeps, and ends about 1 % above the best optimum.
    pub const FIXED: Self = Self { first: 4, every: 0, last: 4 };
    /// k from 2 to 512, doubling every 5 sweeps: finds the best optimum, after more sweeps.
    pub const CONTINUED: Self = Self { first: 1, every: 5, last: 9 };

    /// The largest log2 k that is allowed: beyond it even the ratio nearest to 1 vanishes in single precision.
    pub const MOST: u32 = 10;

    /// log2 k of a sweep; sweeps count from 1.
    pub fn of(self, sweep: u32) -> u32 {
        let doublings = sweep.saturating_sub(1).checked_div(self.every).unwrap_or(0);
        self.first.saturating_add(doublings).min(self.last.max(self.first))
    }

    /// log2 of the largest k.
    pub(crate) fn largest(self) -> u32 {
        if self.every == 0 { self.first } else { self.last.max(self.first) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sharpness_doubles_k_up_to_the_last() {
        let of = |k| Sharpness::CONTINUED.of(k);
        assert_eq!([of(1), of(5), of(6), of(40), of(41), of(1000)], [1, 1, 2, 8, 9, 9]);
        assert_eq!([Sharpness::FIXED.of(1), Sharpness::FIXED.of(99)], [4, 4]);
    }
}
