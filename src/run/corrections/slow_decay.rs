//! The remaining gain of a run with many corrections, estimated from gains over several sweeps.

use crate::run::stop::{MIN_SCALE, StopRule};

/// Number of sweeps in the shortest window. In a slow decay, the gains of several successive sweeps may be small by
/// chance.
pub(super) const WINDOW: usize = 8;
/// Share of the tolerance that the gain over a window must exceed, or the estimate of the window is ignored.
const SMALL: f64 = 0.5;

/// Returns the largest estimate of the remaining gain, as a share of f, over windows of 8, 16, 32 and more sweeps at the
/// end of the history `f`. Infinite if the gain over the last 8 sweeps is no smaller than the gain over the 8 sweeps
/// before. `None` if no window has a gain above `noise`, the relative error of f on the engine.
///
/// Longer windows see modes that gain little with each sweep. A longer window has at most a quarter of the sweeps, as
/// the first sweeps gain much. Its estimate is ignored if gains do not decay, because f may fall faster at the end than
/// before.
pub(super) fn remaining_over_windows(rule: &StopRule, f: &[f64], noise: f64) -> Option<f64> {
    let last = f.len().checked_sub(1)?;
    let scale = f[last].max(MIN_SCALE);
    let windows = std::iter::successors(Some(WINDOW), |w| Some(2 * w));
    let estimate = |w: usize| {
        let is_seen = (f[last - w] - f[last]) / scale > (SMALL * rule.tolerance).max(noise);
        match w {
            _ if !is_seen => None,
            WINDOW => Some(rule.remaining(f, w).unwrap_or(f64::INFINITY)),
            _ => rule.remaining_over(f, w).map(|left| 0.5 * left),
        }
    };
    windows
        .take_while(|&w| 2 * w <= last && (w == WINDOW || 4 * w <= last))
        .filter_map(estimate)
        .reduce(f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rule() -> StopRule {
        StopRule { target: None, tolerance: 1e-6, max_sweeps: 1000 }
    }

    /// In turns of three sweeps, a run gains most in the first sweep. Gains of single sweeps then predict too little.
    #[test]
    fn a_slow_decay_with_irregular_gains_is_not_estimated_too_low() {
        let slow =
            |k: i32| 1.0 + 1e-3 * 0.98f64.powi(3 * (k / 3)) * [1.0, 0.97, 0.965][k as usize % 3];
        let history: Vec<f64> = (0..300).map(slow).collect();
        for n in 60..300 {
            let left = history[n - 1] - 1.0;
            let estimate = remaining_over_windows(&rule(), &history[..n], 1e-9);
            if let Some(estimate) = estimate {
                assert!(estimate >= 0.5 * left, "{estimate:e} for {left:e} after {n}");
            } else {
                assert!(left < 5e-6, "{left:e} after {n}");
            }
        }
    }

    #[test]
    fn gains_below_the_noise_are_ignored() {
        let history: Vec<f64> = (0..60).map(|k| 1.0 + 1e-8 * f64::from(60 - k)).collect();
        assert_eq!(remaining_over_windows(&rule(), &history, 1e-6), None);
        assert_eq!(remaining_over_windows(&rule(), &[], 1e-6), None);
    }
}
