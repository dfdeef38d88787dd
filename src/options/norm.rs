//! The exponent of the p-norm that stands for EDGE in Newton's method.

/// The exponent k of the p-norm that replaces EDGE in Newton's method, for each sweep. Given as log2 k.
///
/// In runs with corrections from coarser levels, k doubles whenever a sweep with its correction gains little by the
/// p-norm, not after a number of sweeps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct PNormExponent {
    /// The log2 of k in the first sweep.
    pub first: u32,
    /// Number of sweeps alone after which k doubles. 0 keeps k constant in any run.
    pub every: u32,
    /// The log2 of the largest k.
    pub last: u32,
}

impl PNormExponent {
    /// k = 16 throughout: good after a few sweeps, but it ends about 1 % above the best optimum.
    pub const FIXED: Self = Self { first: 4, every: 0, last: 4 };
    /// k from 2 to 512, doubling every 5 sweeps: for sweeps alone, which end some 3e-4 above a minimum of f with it, after more sweeps.
    pub const CONTINUED: Self = Self { first: 1, every: 5, last: 9 };

    /// k from 2 to 8192: what runs with corrections take, which end within some 2e-5 of a minimum of f with it. Where there are
    /// none, k doubles every 5 sweeps.
    pub const CORRECTED: Self = Self { first: 1, every: 5, last: 13 };

    /// Where EDGE's p-norm with the exponent k is least, f is this share over k above a minimum of its own near by: 0.15 to 0.16 on
    /// meshes of 1,500 to 6,000 vertices.
    pub(crate) const ABOVE: f64 = 0.16;

    /// [`Self::CORRECTED`] up to where half of this tolerance is left to f; as it is for 0.
    pub(crate) fn corrected_to(tolerance: f64) -> Self {
        let Self { first, last, .. } = Self::CORRECTED;
        let enough = (2.0 * Self::ABOVE / tolerance).log2().ceil();
        let last = enough.clamp(first.into(), last.into()) as u32;
        Self { last, ..Self::CORRECTED }
    }

    /// The largest log2 k that is allowed: powers of ratios have an error of 1e-3 by then in single precision.
    pub const MAX: u32 = 13;

    /// Returns the log2 of k in a sweep; sweeps count from 1.
    pub fn of(self, sweep: u32) -> u32 {
        let doublings = sweep.saturating_sub(1).checked_div(self.every).unwrap_or(0);
        self.first.saturating_add(doublings).min(self.last.max(self.first))
    }

    /// Returns the log2 of the largest k.
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
