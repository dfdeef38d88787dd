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
        let Some(([stage, at, length, attempts, taken, proposed, refused], rest)) =
            words.split_first_chunk()
        else {
            return false;
        };
        let Some((
            &[
                settled,
                accelerated,
                left_out,
                was_reopened,
                in_plane,
                from_end,
                has_slope,
                slope,
                ref estimates @ ..,
                alternated,
                sharpness,
                built,
                fitted,
                needs_double,
                can_step,
                least_ritz,
                forcing,
                idle,
                is_exact,
                agreed,
                steps,
                iterations,
            ],
            lowered,
        )) = rest.split_first_chunk::<{ 21 + ESTIMATES }>()
        else {
            return false;
        };
        let sharpness = u32::try_from(sharpness).ok();
        let Some(sharpness) = sharpness.filter(|k| exponents(&self.plan).contains(k)) else {
            return false;
        };
        let estimates: [u64; ESTIMATES] = *estimates;
        self.sharpness = sharpness;
        self.lowered = lowered.iter().map(|&f| f64::from_bits(f)).collect();
        if self.lowered.len() > evaluations || !self.lowered.iter().all(|f| f.is_finite()) {
            return false;
        }
        // No event can have occurred more often than the number of sweeps.
        let small = |word: &u64| u32::try_from(*word).ok().filter(|n| *n as usize <= evaluations);
        let (
            Some(attempts),
            Some(alternated),
            Some(taken),
            Some(proposed),
            Some(refused),
            Some(built),
            Some(fitted),
            Some(at),
        ) = (
            small(attempts),
            small(&alternated),
            small(taken),
            small(proposed),
            small(refused),
            small(&built).filter(|&n| (n as usize) < evaluations.max(1)),
            small(&fitted).filter(|&n| (n as usize) < evaluations.max(1)),
            u32::try_from(*at).ok(),
        )
        else {
            return false;
        };
        let (since, length) = (at as usize, f64::from_bits(*length));
        self.stage = match stage {
            0 if length == 0.0 => Stage::Before { until: since },
            1 if since < evaluations && length > 0.0 && length.is_finite() => {
                let proposed = if has_levels { proposed } else { 0 };
                Stage::Correcting(Correcting { since, length, proposed, refused })
            }
            2 if since < evaluations => Stage::Without { since },
            3 if can_step != 0 && self.can_step => Stage::Stepping { left: None },
            _ => return false,
        };
        (self.attempts, self.alternated, self.taken) = (attempts, alternated, taken);
        (self.built, self.fitted) = (built as usize, fitted as usize);
        (self.settled, self.accelerated) = (settled != 0, accelerated != 0);
        (self.was_left_out, self.has_levels) = (left_out != 0, has_levels);
        (self.was_reopened, self.from_end) = (was_reopened != 0, from_end != 0);
        self.needs_double = needs_double != 0;
        self.can_step &= can_step != 0;
        let Some(tail) =
            Tail::of_words([least_ritz, forcing, idle, is_exact, agreed, steps, iterations])
        else {
            return false;
        };
        self.tail = tail;
        if in_plane != 0 {
            self.problem.set_levels_in_plane();
        }
        self.slope = (has_slope != 0).then(|| f64::from_bits(slope));
        self.estimates = estimates.map(f64::from_bits);
        true
    }
}
