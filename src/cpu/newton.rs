//! Visits of free vertices: safeguarded Newton steps on their patches, for one vertex in each lane.

use crate::cpu::differences;
use crate::cpu::within::{LaneBounds, Within};
use crate::metric::{Dual, Formulas, Properties};
use crate::options::Derivatives;
use crate::patch::numbers::{Mask, Numbers};
use crate::patch::{Direction, LanePatch, MetricObjective, Objective, SearchRule, newton_step};
use crate::run::{SweepParams, line_search};

/// Visits vertices at `at` within their bounds, and returns their new positions. Only `GENERAL` copies of the code know
/// bounds.
#[inline(always)]
pub(crate) fn visit<T: Numbers, P: LanePatch<T>, const GENERAL: bool>(
    formulas: impl Formulas,
    rings: &P,
    mut at: [T; 2],
    bounds: Option<LaneBounds<T>>,
    step: &SweepParams,
) -> [T; 2] {
    let mut going = at[0].mask(true);
    let (smoothing, shape_guard) = (step.smoothing(), step.shape_guard);
    let metric = MetricObjective { patch: rings, formulas, smoothing, shape_guard };
    let objective = SweepObjective { metric, derivatives: step.derivatives };
    let mut rule = rule_of(formulas.metric().properties(), step);
    if GENERAL && bounds.is_some() {
        // A projected step need not end at the least value of a quadratic metric.
        rule.sufficient_decrease = SearchRule::SWEEP.sufficient_decrease;
    }
    for _ in 0..step.newton_steps {
        let from = at;
        (at, going) = match GENERAL {
            true => {
                newton_step(&Within { objective: &objective, rings, at, bounds }, at, going, &rule)
            }
            false => newton_step(&objective, at, going, &rule),
        };
        if step.newton_steps > 1 && step.derivatives == Derivatives::Analytic {
            going = going & !settled(rings, from, at);
        }
        if going.none() {
            break;
        }
    }
    at
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
fn settled<T: Numbers>(rings: &impl LanePatch<T>, from: [T; 2], to: [T; 2]) -> T::Mask {
    let (x, y) = (to[0] - from[0], to[1] - from[1]);
    let least = line_search::SETTLED * line_search::SETTLED;
    (x * x + y * y).lt(rings.squared_edge(from) * least)
}

/// The objective of a sweep, differentiated by formulas or by finite differences.
struct SweepObjective<'a, P, F> {
    metric: MetricObjective<'a, P, F>,
    derivatives: Derivatives,
}

impl<T: Numbers, P: LanePatch<T>, F: Formulas> Objective<T> for SweepObjective<'_, P, F> {
    #[inline(always)]
    fn expansion(&self, at: [T; 2]) -> Dual<T> {
        let MetricObjective { patch, formulas, smoothing, .. } = self.metric;
        match self.derivatives {
            Derivatives::FiniteDifference => {
                let corners = differences::derivatives(patch, formulas, at, smoothing);
                self.metric.with_opposite_angles(corners, at)
            }
            Derivatives::Analytic => self.metric.expansion(at),
        }
    }

    #[inline(always)]
    fn trial(&self, to: [T; 2], max_imr: T) -> (T, T::Mask) {
        self.metric.trial(to, max_imr)
    }

    #[inline(always)]
    fn direction(&self, here: &Dual<T>, eigenvalue_floor: f64) -> Direction<T> {
        self.metric.direction(here, eigenvalue_floor)
    }

    #[inline(always)]
    fn squares(&self, value: T) -> T {
        Objective::<T>::squares(&self.metric, value)
    }

    #[inline(always)]
    fn shape_guard(&self) -> f64 {
        self.metric.shape_guard
    }

    #[inline(always)]
    fn worst_shape(&self, at: [T; 2]) -> T {
        self.metric.worst_shape(at)
    }
}
