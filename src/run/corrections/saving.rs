//! The state of a run with corrections by name, as checkpoints hold it.

use super::plan_steps::exponents;
use super::state::{Correcting, Corrections, ESTIMATES, Stage};
use crate::run::named::Named;
use crate::run::truncated::Tail;

/// Names of the stages.
const BEFORE: &str = "sweeps before";
const CORRECTING: &str = "corrections";
const STEPPING: &str = "Newton steps";
const WITHOUT: &str = "sweeps without";

impl Corrections {
    /// Returns the state that determines how the run continues, for [`restore`](Self::restore).
    pub(crate) fn save(&self) -> Named {
        let mut out = Named::default();
        let name = match self.stage {
            Stage::Before { .. } => BEFORE,
            Stage::Correcting(_) => CORRECTING,
            Stage::Stepping { .. } => STEPPING,
            Stage::Without { .. } => WITHOUT,
        };
        out.add_list("stage", name.as_bytes());
        match self.stage {
            Stage::Before { until } => out.add("until", until as u64),
            Stage::Correcting(Correcting { since, length, proposed, refused }) => {
                out.add("since", since as u64);
                out.add("length", length);
                out.add("proposed", proposed);
                out.add("refused", refused);
            }
            Stage::Stepping { .. } => {}
            Stage::Without { since } => out.add("since", since as u64),
        }
        for (name, holds) in [
            ("settled", self.settled),
            ("accelerated", self.accelerated),
            ("no room for levels", self.is_left_out()),
            ("reopened", self.was_reopened),
            ("can step", self.can_step),
        ] {
            out.add_flag(name, holds);
        }
        for (name, number) in [
            ("attempts", self.attempts),
            ("taken", self.taken),
            ("alternated", self.alternated),
            ("exponent", self.sharpness),
            ("levels built", self.built as u32),
            ("levels fitted", self.fitted as u32),
            ("refused ends", self.refused_ends),
            ("unmeasured until", self.unmeasured_until as u32),
        ] {
            out.add(name, number);
        }
        if let Some(slope) = self.slope {
            out.add("slope", slope);
        }
        out.add_list("estimates", &self.estimates);
        out.add_list("lowered", &self.lowered);
        self.tail.save(&mut out);
        out
    }

    /// Restores the state that [`save`](Self::save) returned after `evaluations`. Without levels in the
    /// engine, the next correction begins by building levels. Returns false for an invalid state.
    pub(crate) fn restore(&mut self, from: &Named, evaluations: usize, has_levels: bool) -> bool {
        self.restored(from, evaluations, has_levels).is_some()
    }

    /// Restores the state as [`restore`](Self::restore) does. `None` for an invalid state.
    fn restored(&mut self, from: &Named, evaluations: usize, has_levels: bool) -> Option<()> {
        // No event can have occurred more often than the number of sweeps.
        let count = |name| from.one::<u32>(name).filter(|&n| n as usize <= evaluations);
        let index = |name| {
            let index = from.one::<u32>(name)? as usize;
            (index < evaluations.max(1)).then_some(index)
        };
        self.can_step &= from.flag("can step")?;
        self.stage = self.stage_in(from, evaluations, has_levels)?;
        self.sharpness = from.one("exponent").filter(|k| exponents(&self.plan).contains(k))?;
        self.lowered = from.list::<f64>("lowered")?;
        let is_log = |f: &[f64]| f.len() <= evaluations && f.iter().all(|f| f.is_finite());
        is_log(&self.lowered).then_some(())?;
        (self.attempts, self.taken) = (count("attempts")?, count("taken")?);
        self.alternated = count("alternated")?;
        (self.built, self.fitted) = (index("levels built")?, index("levels fitted")?);
        (self.settled, self.accelerated) = (from.flag("settled")?, from.flag("accelerated")?);
        (self.was_left_out, self.has_levels) = (from.flag("no room for levels")?, has_levels);
        self.was_reopened = from.flag("reopened")?;
        self.refused_ends = count("refused ends")?;
        self.unmeasured_until = from.one::<u32>("unmeasured until")? as usize;
        self.tail = Tail::saved_in(from)?;
        self.slope = from.one("slope");
        self.estimates = from.list_of("estimates", ESTIMATES)?.try_into().ok()?;
        Some(())
    }

    /// Returns the saved stage. `None` for an invalid state.
    fn stage_in(&self, from: &Named, evaluations: usize, has_levels: bool) -> Option<Stage> {
        let name = from.list::<u8>("stage")?;
        let since = || {
            let since = from.one::<u64>("since")?;
            (since < evaluations as u64).then_some(since as usize)
        };
        Some(match std::str::from_utf8(&name).ok()? {
            BEFORE => {
                Stage::Before { until: u32::try_from(from.one::<u64>("until")?).ok()? as usize }
            }
            CORRECTING => {
                let length = from.one("length").filter(|x: &f64| *x > 0.0 && x.is_finite())?;
                let [proposed, refused] = ["proposed", "refused"]
                    .map(|name| from.one::<u32>(name).filter(|&n| n as usize <= evaluations));
                let proposed = if has_levels { proposed? } else { 0 };
                let (since, refused) = (since()?, refused?);
                Stage::Correcting(Correcting { since, length, proposed, refused })
            }
            STEPPING if self.can_step => Stage::Stepping { left: None },
            WITHOUT => Stage::Without { since: since()? },
            _ => return None,
        })
    }
}
