//! Visits of free vertices: safeguarded Newton steps on their patches, four vertices at a time.

use fearless_simd::prelude::*;

use crate::cpu::differences;
use crate::metric::{Dual, Formulas, Properties};
use crate::options::Derivatives;
use crate::patch::lanes::{Lanes, Mask, Points};
use crate::patch::{Direction, MetricObjective, Objective, Rings, SearchRule, newton_step};
use crate::run::{SweepParams, line_search};

/// Visits four vertices at `at`, and returns their new positions.
#[inline(always)]
pub(crate) fn visit<S: Simd, const MAPPED: bool>(
    formulas: impl Formulas,
    rings: &Rings<S, MAPPED>,
    mut at: Points<S>,
    step: &SweepParams,
) -> Points<S> {
    let mut going = Mask::splat(at[0].simd, true);
    let (smoothing, shape_guard) = (step.smoothing(), step.shape_guard);
    let objective = SweepObjective {
        metric: MetricObjective { patch: rings, formulas, smoothing, shape_guard },
        derivatives: step.derivatives,
    };
    let rule = rule_of(formulas.metric().properties(), step);
    for _ in 0..step.newton_steps {
        let from = at;
        (at, going) = newton_step(&objective, at, going, &rule);
        if step.newton_steps > 1 && step.derivatives == Derivatives::Analytic {
            going &= !settled(rings, from, at);
        }
        if going.all_false() {
            break;
        }
    }
    at
}

/// Returns the line search of a visit by `step`.
pub(super) fn search_rule(step: &SweepParams) -> SearchRule {
    rule_of(step.metric.properties(), step)
}

/// Returns the line search of a visit by `step`, given the properties of its metric.
#[inline(always)]
fn rule_of(properties: &Properties, step: &SweepParams) -> SearchRule {
    SearchRule {
        first_length: step.omega,
        sufficient_decrease: match properties.quadratic {
            true => None,
            false => SearchRule::SWEEP.sufficient_decrease,
        },
        eigenvalue_floor: properties.eigenvalue_floor,
        max_lengthening: properties.barrier.then_some(step.max_lengthening),
        ..SearchRule::SWEEP
    }
}

/// Returns the lanes whose step was so short that the visit ends; see [`line_search::SETTLED`].
#[inline(always)]
pub(super) fn settled<S: Simd, const MAPPED: bool>(
    rings: &Rings<S, MAPPED>,
    from: Points<S>,
    to: Points<S>,
) -> Mask<S> {
    let (x, y) = (to[0] - from[0], to[1] - from[1]);
    let least = line_search::SETTLED * line_search::SETTLED;
    (x * x + y * y).simd_lt(rings.squared_edge(from) * least)
}

/// The objective of a sweep, differentiated by formulas or by finite differences.
pub(super) struct SweepObjective<'a, P, F> {
    pub(super) metric: MetricObjective<'a, P, F>,
    pub(super) derivatives: Derivatives,
}

impl<S: Simd, const MAPPED: bool, F: Formulas> Objective<Lanes<S>>
    for SweepObjective<'_, Rings<'_, S, MAPPED>, F>
{
    #[inline(always)]
    fn expansion(&self, at: Points<S>) -> Dual<Lanes<S>> {
        let MetricObjective { patch, formulas, smoothing, .. } = self.metric;
        match self.derivatives {
            Derivatives::FiniteDifference => {
                differences::derivatives(patch, formulas, at, smoothing)
            }
            Derivatives::Analytic => self.metric.expansion(at),
        }
    }

    #[inline(always)]
    fn trial(&self, to: Points<S>, max_imr: Lanes<S>) -> (Lanes<S>, Mask<S>) {
        self.metric.trial(to, max_imr)
    }

    #[inline(always)]
    fn direction(&self, here: &Dual<Lanes<S>>, eigenvalue_floor: f64) -> Direction<Lanes<S>> {
        self.metric.direction(here, eigenvalue_floor)
    }

    #[inline(always)]
    fn squares(&self, value: Lanes<S>) -> Lanes<S> {
        Objective::<Lanes<S>>::squares(&self.metric, value)
    }

    #[inline(always)]
    fn shape_guard(&self) -> f64 {
        self.metric.shape_guard
    }

    #[inline(always)]
    fn worst_shape(&self, at: Points<S>) -> Lanes<S> {
        self.metric.worst_shape(at)
    }
}
