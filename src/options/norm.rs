//! The exponent of the p-norm that replaces EDGE in Newton's method.

/// The exponent k of the p-norm that replaces EDGE in Newton's method, sweep by sweep, as binary logarithms.
///
/// In runs with corrections from coarser levels, k doubles whenever a sweep with its correction gains little by the
/// p-norm, instead of after a fixed number of sweeps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct PNormExponent {
    /// Binary logarithm of k in the first sweep.
    pub first: u32,
    /// Number of sweeps alone after which k doubles. 0 keeps k constant in any run.
    pub every: u32,
    /// Binary logarithm of the largest k.
    pub last: u32,
}

impl PNormExponent {
    /// k = 16 in every sweep: good after a few sweeps, but f ends about 1 % above the best optimum.
    pub const FIXED: Self = Self { first: 4, every: 0, last: 4 };
    /// k from 2 to 512, doubled every 5 sweeps, for sweeps alone. f ends some 3e-4 above its own minimum, after more
    /// sweeps than with [`FIXED`](Self::FIXED).
    pub const CONTINUED: Self = Self { first: 1, every: 5, last: 9 };

    /// k from 2 to 8192, the default of runs with corrections. f ends within some 2e-5 of its own minimum. In sweeps
    /// without corrections, k doubles every 5 sweeps.
    pub const CORRECTED: Self = Self { first: 1, every: 5, last: 13 };

    /// k times the relative distance of f at the minimum of EDGE's p-norm from a nearby minimum of f itself: 0.15 to
    /// 0.16 on meshes of 1,500 to 6,000 vertices.
    pub(crate) const ABOVE: f64 = 0.16;

    /// Returns [`Self::CORRECTED`] with the largest k reduced so far that the p-norm's distance from the minimum of f
    /// uses up half of `tolerance`. A tolerance of 0 reduces nothing.
    pub(crate) fn corrected_to(tolerance: f64) -> Self {
        let Self { first, last, .. } = Self::CORRECTED;
        let enough = (2.0 * Self::ABOVE / tolerance).log2().ceil();
        let last = enough.clamp(first.into(), last.into()) as u32;
        Self { last, ..Self::CORRECTED }
    }

    /// Largest binary logarithm of k that is allowed: at 2¹³, powers of ratios have an error of 1e-3 in single
    /// precision.
    pub const MAX: u32 = 13;

    /// Returns the binary logarithm of k in a sweep; sweeps count from 1.
    pub fn of(self, sweep: u32) -> u32 {
        let doublings = sweep.saturating_sub(1).checked_div(self.every).unwrap_or(0);
        self.first.saturating_add(doublings).min(self.last.max(self.first))
    }

    /// Returns the binary logarithm of the largest k.
    pub(crate) fn largest(self) -> u32 {
        if self.every == 0 { self.first } else { self.last.max(self.first) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exponent_doubles_up_to_the_last() {
        let of = |k| PNormExponent::CONTINUED.of(k);
        assert_eq!([of(1), of(5), of(6), of(40), of(41), of(1000)], [1, 1, 2, 8, 9, 9]);
        assert_eq!([PNormExponent::FIXED.of(1), PNormExponent::FIXED.of(99)], [4, 4]);
    }

    #[test]
    fn the_last_exponent_follows_from_the_tolerance() {
        let last = |tolerance| PNormExponent::corrected_to(tolerance).last;
        assert_eq!([0.0, 1e-9, 1e-6, 1e-4].map(last), [13, 13, 13, 12]);
        assert_eq!([1e-3, 1e-2, 1.0, 1e9].map(last), [9, 5, 1, 1]);
    }
}
