//! Common to runs in rounds: the check of their options, and the evaluation of positions between sweeps on the engine.

use glam::DVec2;

use crate::cpu::mean_excess;
use crate::error::SmoothError;
use crate::layout::Problem;
use crate::parallel::map_parts;
use crate::run::{Derivatives, Desired, Goal, Objectives, Options, Plan};

/// Checks that a run with these options can go in rounds, which `option` requires.
pub(crate) fn check(
    option: &'static str,
    options: &Options,
    is_continued: bool,
) -> Result<(), SmoothError> {
    let refuse = |remedy| Err(SmoothError::Option { option, value: "on".to_owned(), remedy });
    if options.scheme.period() > 1 || !options.scheme.is_monotone() {
        return refuse("it needs one metric other than edge, such as imr");
    }
    if options.derivatives != Derivatives::Analytic {
        return refuse("it needs analytic derivatives");
    }
    if matches!(options.goal, Some(Goal { desired: Desired::Auto, .. })) {
        return refuse(
            "such a run cannot search for the desired f: give its value as Desired::Value",
        );
    }
    match is_continued {
        true => refuse("such a run cannot continue from a checkpoint: start it without one"),
        false => Ok(()),
    }
}

/// Evaluates the objectives that a plan tracks.
pub(crate) fn objectives(problem: &Problem, plan: &Plan, positions: &[DVec2]) -> Objectives {
    let mut objectives = Objectives::untracked();
    for metric in plan.tracked() {
        let excess = mean_excess(metric, problem, positions);
        objectives.set(metric, metric.ideal_squared() + excess);
    }
    objectives
}

/// Whether a move leaves no triangle inverted or flat, and none with an inverse mean ratio that is both worse than
/// before and above `guard`.
pub(crate) fn is_sound(problem: &Problem, before: &[DVec2], after: &[DVec2], guard: f64) -> bool {
    let ratio = |positions: &[DVec2], t: &[u32; 3]| {
        problem.corner(t, |v| positions[v as usize]).inverse_mean_ratio()
    };
    let is_sound = |t: &[u32; 3]| {
        let now = ratio(after, t);
        now.is_finite() && (now <= guard || now <= ratio(before, t))
    };
    let parts = map_parts(problem.triangles().chunks(4096), |_, part| part.iter().all(is_sound));
    parts.into_iter().all(|is_sound| is_sound)
}
