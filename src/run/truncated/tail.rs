//! The decisions about the Newton steps at the end of a run: the accuracy of each step, the gain that remains after the step, and
//! the return to sweeps. No decision depends on the history of f.

use crate::run::named::Named;
use crate::run::stop::NOISE;
use crate::run::truncated::{NewtonStep, StepRequest};

/// Bounds of the accuracy of conjugate gradients, as a share of the model's gain. Within the bounds it is the relative
/// discrepancy of model and objective in the step before. In a prototype, 0.05 or 0.2 as the smaller bound
/// changed the time of runs by 4 % at most.
const FORCING: [f64; 2] = [0.1, 0.5];
/// Smallest Ritz value before any solution has shown one. The smallest eigenvalues of ordinary meshes are 0.12 to 0.25, and
/// solutions of two iterations do not show them: with 1, 0.25 and 0.15, 5 of 32, 1 of 112 and 0 of 80 runs on perturbed meshes
/// left more than twice the reported gain. With 0.15, lattices stretched 1:100 still left more.
const FIRST_RITZ: f64 = 0.1;
/// Share of the tolerance to which conjugate gradients solve at most.
const SOLVED: f64 = 0.5;
/// Smallest tolerance. Rounding hides smaller gains.
const LEAST_TOLERANCE: f64 = 1e-13;
/// Number of successive idle steps, after which a run goes back to sweeps: shortened steps, or steps with negative
/// curvature, that gained little together with their sweeps.
const MOST_IDLE: u32 = 8;
/// Number of idle steps for which a step counts that triangles or the guard have shortened. A guard that binds shortens all
/// later steps too: runs by `rms` that it held back took 18 sweeps where corrections took 6.
const BROKEN: u32 = 4;
/// Smallest decrease of the excess of f over its lower limit, as a share, by a step that is not idle.
const BUSY: f64 = 0.02;

/// Gain of a whole step as a share of f, below which the next step counts negative curvatures from the bend of curves. Far from
/// the end, these curvatures lead to worse minima.
const NEAR: f64 = 1e-4;
/// Number of successive steps that must agree on the end of a run while sliding vertices stay at bounds.
const AGREED_IF_HELD: u32 = 2;

/// The state of the Newton steps of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Tail {
    /// Smallest Ritz value that any solution without negative curvature has shown, [`FIRST_RITZ`] at first.
    least_ritz: f64,
    forcing: f64,
    /// Number of successive idle steps.
    idle: u32,
    /// Whether the next step counts negative curvatures from the bend of curves.
    is_exact: bool,
    /// Number of successive steps whose remaining gain is within the tolerance.
    agreed: u32,
    /// Number of steps and of iterations of conjugate gradients.
    steps: u32,
    iterations: u32,
}

impl Tail {
    pub(crate) fn new() -> Self {
        Self {
            least_ritz: FIRST_RITZ,
            forcing: FORCING[1],
            idle: 0,
            is_exact: false,
            agreed: 0,
            steps: 0,
            iterations: 0,
        }
    }

    /// Returns the smallest tolerance by which the steps of a run with the given tolerance judge it.
    pub(crate) fn tolerance(of_run: f64) -> f64 {
        of_run.max(LEAST_TOLERANCE)
    }

    /// Returns how the engine takes the next step. `objective` is f before the sweep, and `tolerance` that of the run.
    pub(crate) fn request(&self, objective: f64, tolerance: f64) -> StepRequest {
        let least_gain = SOLVED * Self::tolerance(tolerance);
        let Self { forcing, least_ritz, is_exact, .. } = *self;
        StepRequest { objective, forcing, least_gain, least_ritz, is_exact }
    }

    /// Returns the request for a measurement of the remaining gain. `objective` is f, and `tolerance` that of the run.
    pub(crate) fn measuring(objective: f64, tolerance: f64) -> StepRequest {
        let accurate = Self { forcing: FORCING[0], is_exact: true, ..Self::new() };
        accurate.request(objective, tolerance)
    }

    /// Records a step. `scale` is f, relative to which gains are judged, and `noise` the relative error of f on the engine.
    /// Returns an upper limit of the remaining gain, as a share of f, and whether the step was whole. The limit is `None` after a
    /// shortened step, and after a step whose bound is of another function: with negative curvature, or with curvatures of curves
    /// left out. The limit is `None` too if the step would end the run and another step must agree.
    pub(crate) fn record(
        &mut self,
        step: &NewtonStep,
        scale: f64,
        tolerance: f64,
        noise: f64,
    ) -> (Option<f64>, bool) {
        self.steps += 1;
        self.iterations += step.iterations;
        if !step.is_curved_down {
            self.least_ritz = self.least_ritz.min(step.least_ritz);
        }
        // Rounding of f hides tiny gains, so that no length lowers f enough.
        let is_tiny = step.length == 0.0 && step.model_gain + step.bound <= noise * scale;
        let is_whole = (step.length == 1.0 || is_tiny) && !step.is_curved_down;
        let seen = step.swept - step.excess;
        let off = (seen - step.model_gain).abs();
        // Single precision hides small gains and discrepancies. The model's gain then stands for both, as at the end of any run.
        let (gain, discrepancy) = match noise > NOISE && off <= noise * scale {
            true => (step.model_gain, off.min(step.model_gain.abs())),
            false => (seen, off),
        };
        let [low, high] = FORCING;
        self.forcing = match discrepancy / step.model_gain {
            share if is_whole && share.is_finite() => share.clamp(low, high),
            _ => high,
        };
        // Where the model misses much of the gain, successive gains shrink slowly, and the next may be as large as this one.
        let is_far = discrepancy > low * step.model_gain.abs();
        let next = if is_far { gain } else { 0.0 };
        let left = (step.bound + discrepancy).max(next) / scale;
        let is_solved = step.bound <= SOLVED * tolerance * scale;
        self.is_exact = is_whole && gain < NEAR * scale || !step.is_exact && is_solved;
        let is_within = is_whole && step.is_exact && left <= Self::tolerance(tolerance);
        self.agreed = if is_within { self.agreed + 1 } else { 0 };
        let asked = if step.held > 0 { AGREED_IF_HELD } else { 1 };
        let is_known = is_whole && step.is_exact && (!is_within || self.agreed >= asked);
        (is_known.then_some(left), is_whole)
    }

    /// Records whether the last step was idle. A step that is not whole was shortened or met negative curvature.
    /// `excess` are those of f over its lower limit before the sweep and after the step. Returns whether the run goes back
    /// to sweeps.
    pub(crate) fn is_stuck(
        &mut self,
        step: &NewtonStep,
        is_whole: bool,
        [before, after]: [f64; 2],
    ) -> bool {
        let is_busy = is_whole || before - after >= BUSY * before;
        let more = if step.is_broken { BROKEN } else { 1 };
        self.idle = if is_busy { 0 } else { self.idle + more };
        let is_stuck = self.idle >= MOST_IDLE;
        if is_stuck {
            self.idle = 0;
        }
        is_stuck
    }

    /// Returns the number of steps, and of iterations in all steps.
    pub(crate) fn counts(&self) -> [u32; 2] {
        [self.steps, self.iterations]
    }

    /// Adds the state to that of a run.
    pub(crate) fn save(&self, out: &mut Named) {
        let Self { least_ritz, forcing, idle, is_exact, agreed, steps, iterations } = *self;
        out.add("least Ritz value", least_ritz);
        out.add("forcing", forcing);
        out.add_flag("exact", is_exact);
        out.add_list("idle, agreed, steps and iterations", &[idle, agreed, steps, iterations]);
    }

    /// Returns the state that [`save`](Self::save) has added. `None` for an invalid state.
    pub(crate) fn saved_in(from: &Named) -> Option<Self> {
        let counts = from.list_of::<u32>("idle, agreed, steps and iterations", 4)?;
        let [idle, agreed, steps, iterations] = counts.try_into().ok()?;
        let least_ritz = from.one("least Ritz value").filter(|&least| least > 0.0)?;
        let forcing = from.one("forcing").filter(|f| (FORCING[0]..=FORCING[1]).contains(f))?;
        let is_exact = from.flag("exact")?;
        Some(Self { least_ritz, forcing, idle, is_exact, agreed, steps, iterations })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TOLERANCE: f64 = 1e-6;
    /// A step that follows several others.
    const STEP: NewtonStep = NewtonStep {
        swept: 0.5,
        excess: 0.4,
        model_gain: 0.09,
        bound: 0.001,
        least_ritz: 0.05,
        length: 1.0,
        is_curved_down: false,
        is_broken: false,
        is_exact: true,
        slides: false,
        held: 0,
        iterations: 7,
    };

    #[test]
    fn only_a_whole_step_without_negative_curvature_bounds_the_rest() {
        let mut tail = Tail::new();
        let near = tail
            .record(&NewtonStep { model_gain: 0.095, ..STEP }, 2.0, TOLERANCE, NOISE)
            .0
            .unwrap();
        assert!((near - 0.003).abs() < 1e-12, "{near}");
        // The model misses a ninth of the gain.
        let far = tail.record(&STEP, 2.0, TOLERANCE, NOISE).0.unwrap();
        assert!((far - 0.05).abs() < 1e-12, "{far}");
        assert_eq!(tail.request(1.0, 1e-6).least_ritz, 0.05);
        assert!((tail.request(1.0, 0.0).forcing - 1.0 / 9.0).abs() < 1e-12);
        assert_eq!(
            tail.record(&NewtonStep { length: 0.5, ..STEP }, 2.0, TOLERANCE, NOISE),
            (None, false)
        );
        assert_eq!(tail.request(1.0, 0.0).forcing, 0.5);
        let curved = NewtonStep { is_curved_down: true, least_ritz: 0.01, ..STEP };
        assert_eq!(tail.record(&curved, 2.0, TOLERANCE, NOISE), (None, false));
        assert_eq!((tail.request(1.0, 1e-6).least_ritz, tail.counts()), (0.05, [4, 28]));
    }

    /// At the end, rounding of f refuses every length, and the model's gain is what remains.
    #[test]
    fn a_gain_below_rounding_remains() {
        let step = NewtonStep { excess: 0.5, model_gain: 1e-15, bound: 1e-16, length: 0.0, ..STEP };
        let left = Tail::new().record(&step, 1.0, TOLERANCE, NOISE).0.unwrap();
        assert!((left - 1.1e-15).abs() < 1e-20);
        let larger = NewtonStep { model_gain: 1e-3, ..step };
        assert_eq!(Tail::new().record(&larger, 1.0, TOLERANCE, NOISE), (None, false));
    }

    /// A device in single precision does not see whether a small step gained what the model promised.
    #[test]
    fn a_discrepancy_below_the_error_of_f_counts_as_the_gain_of_the_model() {
        let noise = 2e-7;
        let step = NewtonStep { excess: 0.5 - 9e-8, model_gain: 1e-9, bound: 1e-10, ..STEP };
        let left = |noise| Tail::new().record(&step, 1.0, TOLERANCE, noise).0.unwrap();
        assert!((left(noise) - 1.1e-9).abs() < 1e-15, "{}", left(noise));
        // The same step on the CPU shows that the model is wrong.
        assert!(left(NOISE) > 8e-8);
        let seen = NewtonStep { excess: 0.5 - 9e-7, ..step };
        assert!(Tail::new().record(&seen, 1.0, TOLERANCE, noise).0.unwrap() > 8e-7);
    }

    #[test]
    fn idle_steps_in_succession_lead_back_to_sweeps() {
        let mut tail = Tail::new();
        assert!((1..MOST_IDLE).all(|_| !tail.is_stuck(&STEP, false, [1.0, 0.99])));
        let again = tail;
        assert!(tail.is_stuck(&STEP, false, [1.0, 0.99]));
        // A run that takes steps again later begins to count again.
        assert!(!tail.is_stuck(&STEP, false, [1.0, 0.99]));
        for (is_whole, after) in [(true, 1.0), (false, 0.5)] {
            let mut tail = again;
            assert!(!tail.is_stuck(&STEP, is_whole, [1.0, after]));
            let broken = NewtonStep { is_broken: true, ..STEP };
            assert!(
                !tail.is_stuck(&broken, false, [1.0; 2]) && tail.is_stuck(&broken, false, [1.0; 2])
            );
        }
    }

    /// With negative curvatures of curves left out, a step bounds another function. Vertices at bounds may be released later, so
    /// two steps must agree.
    #[test]
    fn steps_on_curves_end_a_run_only_if_they_are_exact_and_agree_at_bounds() {
        let mut tail = Tail::new();
        let small = NewtonStep { swept: 0.4 + 1e-9, model_gain: 1e-9, bound: 1e-10, ..STEP };
        assert!(!tail.request(1.0, TOLERANCE).is_exact);
        let inexact = NewtonStep { is_exact: false, ..small };
        assert_eq!(tail.record(&inexact, 1.0, TOLERANCE, NOISE), (None, true));
        assert!(tail.request(1.0, TOLERANCE).is_exact);
        let held = NewtonStep { held: 3, ..small };
        assert_eq!(tail.record(&held, 1.0, TOLERANCE, NOISE), (None, true));
        assert!(tail.record(&held, 1.0, TOLERANCE, NOISE).0.is_some_and(|left| left < TOLERANCE));
        assert!(Tail::new().record(&small, 1.0, TOLERANCE, NOISE).0.is_some());
    }

    #[test]
    fn the_state_comes_back_by_name() {
        let mut tail = Tail::new();
        tail.record(&STEP, 1.0, TOLERANCE, NOISE);
        tail.is_stuck(&STEP, false, [1.0, 1.0]);
        let mut saved = Named::default();
        tail.save(&mut saved);
        assert_eq!(Tail::saved_in(&saved), Some(tail));
        saved.0[0].1.copy_from_slice(&f64::NAN.to_ne_bytes());
        assert_eq!(Tail::saved_in(&saved), None);
    }
}
