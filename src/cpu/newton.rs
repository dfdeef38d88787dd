//! Visits of free vertices: safeguarded Newton steps on their patches, four vertices at a time.

use fearless_simd::prelude::*;

use crate::cpu::differences;
use crate::cpu::lanes::{Lanes, Mask, Points};
use crate::cpu::patch::Patches;
use crate::metric::{Dual, Formulas, Real};
use crate::options::Derivatives;
use crate::run::{Step, line_search};

/// Visits four vertices at `at`. Returns their new positions.
#[inline(always)]
pub(crate) fn visit<S: Simd, const MAPPED: bool>(
    formulas: impl Formulas,
    patches: &Patches<S, MAPPED>,
    mut at: Points<S>,
    step: &Step,
) -> Points<S> {
    let mut going = Mask::splat(at[0].simd, true);
    for _ in 0..step.inner {
        let from = at;
        (at, going) = newton_step(formulas, patches, at, going, step);
        if step.inner > 1 && step.derivatives == Derivatives::Analytic {
            going &= !settled(patches, from, at);
        }
        if going.all_false() {
            break;
        }
    }
    at
}

/// The vertices whose step was so short that their visit is over.
#[inline(always)]
fn settled<S: Simd, const MAPPED: bool>(
    patches: &Patches<S, MAPPED>,
    from: Points<S>,
    to: Points<S>,
) -> Mask<S> {
    let (x, y) = (to[0] - from[0], to[1] - from[1]);
    let least = line_search::SETTLED * line_search::SETTLED;
    (x * x + y * y).simd_lt(patches.squared_edge(from) * least)
}

/// One Newton step with its line search, for the vertices in `going`. Returns the new positions, and
/// which vertices took a step.
#[inline(always)]
fn newton_step<S: Simd, const MAPPED: bool>(
    formulas: impl Formulas,
    patches: &Patches<S, MAPPED>,
    at: Points<S>,
    going: Mask<S>,
    step: &Step,
) -> (Points<S>, Mask<S>) {
    let (metric, properties) = (formulas.metric(), formulas.metric().properties());
    let sum = match step.derivatives {
        Derivatives::FiniteDifference => {
            differences::derivatives(patches, formulas, at, step.smoothing())
        }
        Derivatives::Analytic => patches.derivatives(formulas, at, step.smoothing()),
    };
    let floor = properties.eigenvalue_floor;
    let ([dx, dy], slope, descends) = match patches.inverse_map() {
        Some(inverse) if MAPPED => {
            // The floor is meant for nearly equilateral triangles, so it is applied in the coordinates of the target
            // map.
            let (direction, slope, descends) = descent(&inverse.pull_back(sum), floor);
            (inverse.apply(direction), slope, descends)
        }
        _ => descent(&sum, floor),
    };
    let squares = sum.value + patches.degree() as f64 * metric.ideal_squared();
    let most = sum.value + squares * line_search::SLACK;
    let wanted = slope * line_search::SUFFICIENT_DECREASE;

    let mut length = at[0].constant(step.omega);
    if properties.barrier {
        let share = -slope / squares;
        let flat =
            share.simd_gt(line_search::MOSTLY_FLAT) & squares.simd_gt(line_search::LEAST_FLAT);
        let rest = Real::max(
            share.constant(1.0) - share * line_search::BENT,
            share.constant(1.0 / step.longest),
        );
        // A triangle may be as flat as positions are coarse. A step no longer than that would be rounded away.
        let coarse = Real::max(at[0].abs(), at[1].abs()) * line_search::LEAST_MOVE;
        let far = Real::max(length / rest, coarse / Real::sqrt(dx * dx + dy * dy));
        length = flat.select(far, length);
    }
    let mut searching = going & descends;
    let (mut end, mut found) = (at, Mask::splat(at[0].simd, false));
    // A triangle may stay as bad as the worst of the patch. Few trials break the guard, so the worst is computed when
    // one does.
    let mut limit = at[0].constant(step.shape_guard);
    let guarded = step.shape_guard.is_finite();
    let mut worst_is_known = !guarded;
    let mut trial = 0;
    while trial < line_search::TRIALS {
        let to = [at[0] + dx * length, at[1] + dy * length];
        let (value, feasible) = patches.objective(formulas, to, step.smoothing(), limit, guarded);
        if !worst_is_known && !(!searching | feasible).all_true() {
            worst_is_known = true;
            limit = Real::max(limit, patches.worst_shape(formulas, at));
            continue;
        }
        trial += 1;
        let mut taken = searching & feasible;
        if !properties.quadratic {
            taken &= value.simd_le(most + wanted * length);
        }
        end = [taken.select(to[0], end[0]), taken.select(to[1], end[1])];
        found |= taken;
        searching &= !taken;
        if searching.all_false() {
            break;
        }
        let shorter = length * line_search::SHORTEN;
        length = feasible.select(shorter, length * line_search::SHORTEN_INFEASIBLE);
    }
    (end, found)
}

/// The Newton direction d = -H⁻¹g, the slope g·d, and the vertices where d descends. H is made positive definite:
/// eigenvalues become absolute, and at least `floor` times the largest. There is no descent where the objective is flat
/// or not finite.
#[inline(always)]
pub(crate) fn descent<S: Simd>(at: &Dual<Lanes<S>>, floor: f64) -> (Points<S>, Lanes<S>, Mask<S>) {
    let [xx, xy, yy] = at.hessian;
    let scale = Real::max(Real::max(xx.abs(), xy.abs()), yy.abs());
    let one = scale.constant(1.0);
    let usual = scale.simd_gt(0.0) & scale.simd_lt(f64::INFINITY);
    let unit = one / scale;
    let (gx, gy) = (at.gradient[0] * unit, at.gradient[1] * unit);
    let [xx, xy, yy] = [xx * unit, xy * unit, yy * unit];
    let (mean, half) = ((xx + yy) * 0.5, (xx - yy) * 0.5);
    let radius = Real::sqrt(half * half + xy * xy);
    let (high, low) = ((mean + radius).abs(), (mean - radius).abs());
    let least = Real::max(high, low) * floor;
    let (high, low) = (one / Real::max(high, least), one / Real::max(low, least));
    // H = mean + R with R² = radius², so the projector on the upper eigenvector is (1 + R/radius)/2.
    let split = radius.simd_gt(0.0);
    let inverse = split.select(one / radius, radius);
    let ux = split.select((gx + (half * gx + xy * gy) * inverse) * 0.5, gx);
    let uy = split.select((gy + (xy * gx - half * gy) * inverse) * 0.5, gy);
    let (dx, dy) = (-(ux * high + (gx - ux) * low), -(uy * high + (gy - uy) * low));
    let slope = (dx * gx + dy * gy) * scale;
    ([dx, dy], slope, usual & slope.simd_lt(0.0))
}
