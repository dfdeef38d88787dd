//! The question to the observer in the middle of a long step.

use std::time::Duration;

use web_time::Instant;

use crate::run::{CheckpointPolicy, Observer, Progress};

/// Time between two questions in the middle of a step.
const QUESTION: Duration = Duration::from_millis(100);

/// Asks the observer in the middle of a long step whether the run goes on.
pub(super) struct Patience<'p> {
    now: Progress,
    observe: &'p mut dyn Observer,
    /// The policy of a run that can save checkpoints.
    policy: Option<&'p mut dyn CheckpointPolicy>,
    /// Time of the last question.
    asked: Instant,
    /// Whether the observer has ended the run.
    has_ended: bool,
    /// Whether the policy wants a checkpoint at the end, so that the step is finished: a checkpoint in the middle of a step
    /// would not continue with the bits of an uninterrupted run.
    finishes_step: bool,
}

impl<'p> Patience<'p> {
    /// Begins a batch of sweeps. `now` is the progress before.
    pub(super) fn new(
        now: Progress,
        observe: &'p mut dyn Observer,
        policy: Option<&'p mut dyn CheckpointPolicy>,
    ) -> Self {
        let asked = Instant::now();
        Self { now, observe, policy, asked, has_ended: false, finishes_step: false }
    }

    /// Returns whether the step in progress goes on. Asks the observer if the last question was [`QUESTION`] ago.
    #[cfg_attr(target_family = "wasm", expect(dead_code))]
    pub(super) fn goes_on(&mut self) -> bool {
        if !self.has_ended && self.asked.elapsed() >= QUESTION {
            self.has_ended = (self.observe)(&self.now).is_break();
            let policy = self.policy.as_mut().filter(|_| self.has_ended);
            self.finishes_step = policy.is_some_and(|policy| policy.wants_checkpoint(true));
            self.asked = Instant::now();
        }
        !self.is_canceled()
    }

    /// Returns whether the observer has ended the run.
    pub(super) fn has_ended(&self) -> bool {
        self.has_ended
    }

    /// Returns whether the run has ended in the middle of a step.
    pub(super) fn is_canceled(&self) -> bool {
        self.has_ended && !self.finishes_step
    }
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use super::*;
    use crate::run::Phase;

    /// A policy that wants a checkpoint at the end of the run, or none.
    struct Wants(bool);

    impl CheckpointPolicy for Wants {
        fn wants_checkpoint(&mut self, is_ending: bool) -> bool {
            self.0 && is_ending
        }
    }

    #[test]
    fn a_run_ends_in_the_middle_of_a_step_unless_its_checkpoint_must_hold_whole_steps() {
        for wants in [false, true] {
            let mut questions = 0;
            let mut observe = |now: &Progress| {
                assert_eq!((now.sweep, now.f), (3, 1.5));
                questions += 1;
                if questions == 2 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            };
            let now = Progress { phase: Phase::Smoothing, sweep: 3, f: 1.5 };
            let mut policy = Wants(wants);
            let mut patience = Patience::new(now, &mut observe, Some(&mut policy));
            let mut ask = || {
                patience.asked -= QUESTION;
                patience.goes_on()
            };
            assert_eq!([ask(), ask(), ask()], [true, wants, wants]);
            assert_eq!((patience.has_ended(), patience.is_canceled()), (true, !wants));
            assert_eq!(questions, 2);
        }
    }

    #[test]
    fn the_observer_is_not_asked_between_two_quick_iterations() {
        let mut observe = |_: &Progress| -> ControlFlow<()> { panic!("asked too soon") };
        let now = Progress { phase: Phase::Smoothing, sweep: 0, f: 1.0 };
        let mut patience = Patience::new(now, &mut observe, None);
        // A question would be due only if the test itself took longer than the time between two questions.
        patience.asked += QUESTION;
        assert!(patience.goes_on() && !patience.is_canceled());
    }
}
