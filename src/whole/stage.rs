//! The interface of stages: work on the host between sweeps, and the decision whether the run ends.

use crate::error::MeshError;
use crate::run::records::{Reader, Writer};
use crate::run::{Stop, StopRule};
use crate::whole::host::Host;

/// A stage of a run: work on the host between sweeps on the engine.
pub(crate) trait Stage: Send + Sync {
    /// Returns the name of the stage in checkpoints.
    fn name(&self) -> &'static str;

    /// Returns the largest number of sweeps before the stage works again.
    fn period(&self) -> u32;

    /// Returns whether the stage also moves vertices that no sweep has moved.
    fn moves_without_sweeps(&self) -> bool {
        false
    }

    /// Works on the state after some sweeps. A stage that moves free vertices otherwise than the sweeps did first asks
    /// [`Host::is_sound`], which applies the bounds of the problem.
    ///
    /// # Errors
    /// [`MeshError::NotFinite`] if the stage must evaluate a target at an infinite or NaN position.
    fn work(&mut self, host: &mut Host<'_>) -> Result<(), MeshError>;

    /// Decides whether the run ends. The driver asks only the last stage of a run.
    fn judge(&mut self, period: &Period) -> Judgment;

    /// Writes the state of the stage between two periods to a checkpoint.
    fn save(&self, out: &mut Writer);

    /// Restores a state that [`save`](Self::save) wrote. The vertices of `host` have the positions of the saved period.
    /// `None` if the state belongs to a run on another mesh.
    fn restore(&mut self, host: &mut Host<'_>, from: &mut Reader<'_>) -> Option<()>;
}

/// A finished period: sweeps, and the work of all stages after the sweeps.
pub(crate) struct Period {
    /// f by the base metric before and after the period.
    pub(crate) f: [f64; 2],
    /// Whether the run has reached its largest number of sweeps.
    pub(crate) is_last: bool,
}

/// A decision after a period.
pub(crate) struct Judgment {
    /// Reason why the run ends. `None` if the run continues.
    pub(crate) stop: Option<Stop>,
    /// Estimated remaining gain as a share of f. `None` without an estimate.
    pub(crate) remaining: Option<f64>,
}

/// Number of consecutive estimates that must agree before a run ends, as the gains of periods are irregular.
const ESTIMATES: u32 = 2;

/// The stop rule of a run, applied to f at the end of each period.
pub(crate) struct PeriodRule {
    rule: StopRule,
    f: Vec<f64>,
    estimates: u32,
}

impl PeriodRule {
    pub(crate) fn new(rule: StopRule) -> Self {
        let rule = StopRule { max_sweeps: u32::MAX, ..rule };
        Self { rule, f: Vec::new(), estimates: 0 }
    }

    pub(crate) fn save(&self, out: &mut Writer) {
        out.reals(&self.f);
        out.number(self.estimates.into());
    }

    pub(crate) fn restore(&mut self, from: &mut Reader<'_>) -> Option<()> {
        (self.f, self.estimates) = (from.reals()?, from.count()?);
        Some(())
    }

    pub(crate) fn judge(&mut self, period: &Period) -> Judgment {
        self.f.push(period.f[1]);
        let judged = self.rule.judge(&self.f, self.f.len() - 1, 1);
        self.estimates = if judged.is_some() { self.estimates.saturating_add(1) } else { 0 };
        let stop = match judged {
            Some(Stop::Reached) => judged,
            Some(_) if self.estimates >= ESTIMATES => judged,
            _ => period.is_last.then_some(Stop::MaxSweeps),
        };
        let level = (stop == Some(Stop::Converged)).then(|| self.rule.level(&self.f, 1));
        Judgment { stop, remaining: self.rule.remaining(&self.f, 1).or(level) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A former defect: a run with stages whose f was constant converged without a remaining gain.
    #[test]
    fn a_constant_f_is_convergence_with_the_tolerance_as_remaining_gain() {
        let tolerance = 1e-6;
        let mut rule = PeriodRule::new(StopRule { target: None, tolerance, max_sweeps: 1000 });
        let period = || Period { f: [1.5, 1.5], is_last: false };
        let judged: Vec<Judgment> = (0..4).map(|_| rule.judge(&period())).collect();
        assert!(judged[..3].iter().all(|judged| judged.stop.is_none()));
        assert_eq!((judged[3].stop, judged[3].remaining), (Some(Stop::Converged), Some(tolerance)));
    }
}
