//! The state of a run with corrections, encoded as words of a checkpoint.

use super::plan_steps::exponents;
use super::state::{Correcting, Corrections, ESTIMATES, Stage};
use crate::run::truncated::Tail;

impl Corrections {
    /// Returns the state that determines how the run continues, as words for [`restore`](Self::restore).
    pub(crate) fn save(&self) -> Vec<u64> {
        let (stage, at, length, proposed, refused) = match self.stage {
            Stage::Before { until } => (0, until, 0.0, 0, 0),
            Stage::Correcting(Correcting { since, length, proposed, refused }) => {
                (1, since, length, proposed, refused)
            }
            Stage::Without { since } => (2, since, 0.0, 0, 0),
            Stage::Stepping { .. } => (3, 0, 0.0, 0, 0),
        };
        let counts = [self.attempts, self.taken, proposed, refused].map(u64::from);
        let levels = [self.built as u64, self.fitted as u64];
        let in_plane = self.problem.are_levels_in_plane();
        let (settled, left_out) = (self.settled, self.is_left_out());
        let flags =
            [settled, self.accelerated, left_out, self.was_reopened, in_plane, self.from_end];
        let flags = flags.map(u64::from);
        let slope = [self.slope.is_some().into(), self.slope.unwrap_or(0.0).to_bits()];
        let mut words = vec![stage, at as u64, length.to_bits()];
        words.extend(counts.into_iter().chain(flags).chain(slope));
        words.extend(self.estimates.map(f64::to_bits));
        words.extend([self.alternated, self.sharpness].map(u64::from));
        words.extend(levels);
        words.extend([self.needs_double, self.can_step].map(u64::from));
        words.extend(self.tail.words());
        words.extend(self.lowered.iter().map(|f| f.to_bits()));
        words
    }

    /// Restores the state from the words that [`save`](Self::save) returned after `evaluations`. Without levels in the
    /// engine, the next correction begins by building levels. Returns false for invalid words.
    pub(crate) fn restore(&mut self, words: &[u64], evaluations: usize, has_levels: bool) -> bool {
        self.restored(words, evaluations, has_levels).is_some()
    }

    /// Restores the state as [`restore`](Self::restore) does. `None` for invalid words.
    fn restored(&mut self, words: &[u64], evaluations: usize, has_levels: bool) -> Option<()> {
        let (&[stage, at, length], rest) = words.split_first_chunk()?;
        let (&[attempts, taken, proposed, refused], rest) = rest.split_first_chunk()?;
        let (flags, rest) = rest.split_first_chunk()?;
        let [settled, accelerated, left_out, was_reopened, in_plane, from_end] =
            flags.map(|flag: u64| flag != 0);
        let (&[has_slope, slope], rest) = rest.split_first_chunk()?;
        let (estimates, rest) = rest.split_first_chunk::<ESTIMATES>()?;
        let (&[alternated, sharpness, built, fitted], rest) = rest.split_first_chunk()?;
        let (&[needs_double, can_step], rest) = rest.split_first_chunk()?;
        let (tail, lowered) = rest.split_first_chunk()?;
        let sharpness = u32::try_from(sharpness).ok()?;
        self.sharpness = Some(sharpness).filter(|k| exponents(&self.plan).contains(k))?;
        self.lowered = lowered.iter().map(|&f| f64::from_bits(f)).collect();
        let is_log = |f: &[f64]| f.len() <= evaluations && f.iter().all(|f| f.is_finite());
        is_log(&self.lowered).then_some(())?;
        // No event can have occurred more often than the number of sweeps.
        let small = |word: u64| u32::try_from(word).ok().filter(|n| *n as usize <= evaluations);
        let index = |word: u64| small(word).map(|n| n as usize).filter(|&n| n < evaluations.max(1));
        self.attempts = small(attempts)?;
        (self.alternated, self.taken) = (small(alternated)?, small(taken)?);
        (self.built, self.fitted) = (index(built)?, index(fitted)?);
        let (proposed, refused) = (small(proposed)?, small(refused)?);
        let (since, length) = (u32::try_from(at).ok()? as usize, f64::from_bits(length));
        self.stage = match stage {
            0 if length == 0.0 => Stage::Before { until: since },
            1 if since < evaluations && length > 0.0 && length.is_finite() => {
                let proposed = if has_levels { proposed } else { 0 };
                Stage::Correcting(Correcting { since, length, proposed, refused })
            }
            2 if since < evaluations => Stage::Without { since },
            3 if can_step != 0 && self.can_step => Stage::Stepping { left: None },
            _ => return None,
        };
        (self.settled, self.accelerated) = (settled, accelerated);
        (self.was_left_out, self.has_levels) = (left_out, has_levels);
        (self.was_reopened, self.from_end) = (was_reopened, from_end);
        self.needs_double = needs_double != 0;
        self.can_step &= can_step != 0;
        self.tail = Tail::of_words(*tail)?;
        if in_plane {
            self.problem.set_levels_in_plane();
        }
        self.slope = (has_slope != 0).then(|| f64::from_bits(slope));
        self.estimates = estimates.map(f64::from_bits);
        Some(())
    }
}
