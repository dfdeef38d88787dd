//! The interface of stages: the work of a run on the host between sweeps, and the decision whether the run ends.

use glam::DVec2;

use crate::error::MeshError;
use crate::run::records::{Reader, Writer};
use crate::run::{Stop, StopRule};
use crate::whole::host::Host;

/// Work on the host between sweeps on the engine.
pub(crate) trait Stage: Send + Sync {
    /// The name of the stage in checkpoints.
    fn name(&self) -> &'static str;

    /// The most sweeps before the stage works again.
    fn period(&self) -> u32;

    /// Works on the state after some sweeps. Before it moves vertices in another way than the sweeps did, it asks
    /// `allows`, which answers for the stages before it.
    ///
    /// # Errors
    /// [`MeshError::NotFinite`] if a target has no finite place.
    fn work(
        &mut self,
        host: &mut Host<'_>,
        allows: &dyn Fn(&[DVec2]) -> bool,
    ) -> Result<Worked, MeshError>;

    /// Whether the stage allows the free vertices to be at these positions.
    fn allows(&self, _positions: &[DVec2]) -> bool {
        true
    }

    /// Takes note that a later stage has moved free vertices.
    fn follow(&mut self, _host: &mut Host<'_>) {}

    /// Decides whether the run ends. The driver asks the last stage of the run alone.
    fn judge(&mut self, period: &Period) -> Judged;

    /// Writes the state of the stage between two periods.
    fn save(&self, out: &mut Writer);

    /// Returns to a state that [`save`](Self::save) wrote, with the vertices of `host` where they were then. `None` if the
    /// state is not of a run on this mesh.
    fn restore(&mut self, host: &mut Host<'_>, from: &mut Reader<'_>) -> Option<()>;
}

/// The result of the work of a stage.
#[derive(Clone, Copy)]
pub(crate) struct Worked {
    /// Whether the run may end, as far as the stage knows.
    pub(crate) is_settled: bool,
    /// Whether the stage has moved free vertices otherwise than the sweeps did.
    pub(crate) has_moved_free: bool,
}

/// A period consists of sweeps and the work of all stages after the sweeps.
pub(crate) struct Period {
    /// f by the base metric before and after the period.
    pub(crate) f: [f64; 2],
    /// The reason why the sweeps ended, if they ended by themselves.
    pub(crate) swept: Option<Stop>,
    /// The share of f that is left to gain, as estimated from the sweeps alone.
    pub(crate) remaining: Option<f64>,
    /// Whether every stage is settled.
    pub(crate) is_settled: bool,
    /// Whether all free vertices are held.
    pub(crate) all_held: bool,
    /// Whether no more sweeps may be done.
    pub(crate) is_last: bool,
}

/// The judgement after a period.
pub(crate) struct Judged {
    /// The reason why the run ends, if it does.
    pub(crate) stop: Option<Stop>,
    /// The share of f that is estimated to be left to gain.
    pub(crate) remaining: Option<f64>,
}

/// Number of estimates in a row that must agree before a run ends, as the gains of periods are irregular.
const ESTIMATES: u32 = 2;

/// The stop rule of a run, applied to f at the ends of periods.
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

    pub(crate) fn judge(&mut self, period: &Period) -> Judged {
        self.f.push(period.f[1]);
        let judged = self.rule.judge(&self.f, self.f.len() - 1, 1);
        let agrees = judged.is_some() && period.is_settled;
        self.estimates = if agrees { self.estimates.saturating_add(1) } else { 0 };
        let stop = match judged {
            Some(Stop::Reached) => judged,
            Some(_) if self.estimates >= ESTIMATES => judged,
            _ => period.is_last.then_some(Stop::MaxSweeps),
        };
        Judged { stop, remaining: self.rule.remaining(&self.f, 1) }
    }
}
