//! Sliding vertices at the bounds of their lines: neighbors at a common bound have one unknown.
//!
//! A line between two neighbors must stay near the given vertices. Where the line is at its bound, the two move on together
//! such that the distance stays. This is an active set of the limits, without which neighbors would block each other.

use crate::slide::curve::Limit;
use crate::slide::track::Track;

/// Share of a bound from which on a limit may be active. In a prototype, 0.9 left f up to 2e-3 higher on five coasts, and
/// 0.9999 took up to twice the iterations.
const NEAR: f64 = 0.97;
/// Number of passes that find the multipliers of the limits.
const PASSES: usize = 50;
/// Largest ratio of the moves of neighbors that keep a distance.
const MOST_RATIO: f64 = 1000.0;
/// Step of the differences that find the second derivative of a limit, as a share of the length of an edge.
const DIFFERENCE: f64 = 1e-4;

/// A limit that the moves of a step keep: the edge after a vertex of a track.
#[derive(Clone, Copy, Debug)]
struct Active {
    /// Indices of the ends.
    ends: [usize; 2],
    /// Derivatives by the lengths of the ways of both ends; 0 at an end that stays.
    slopes: [f64; 2],
    multiplier: f64,
    /// Whether the edge has another limit near its bound.
    is_doubled: bool,
}

/// The vertices of a track that move together in a step, because limits join them.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Cluster {
    /// Indices of the vertices in order along the curve, with the share of each in the common unknown. The sum of squares of
    /// the shares is 1.
    pub(super) members: Vec<(usize, f64)>,
    /// Whether all members stay: the cluster is joined to a vertex that stays, or no common move keeps its limits.
    pub(super) is_held: bool,
    /// Second derivative of the limits times their multipliers by the common unknown.
    pub(super) curvature: f64,
}

impl Track {
    /// Returns the clusters of a track with its vertices at `params`. For each vertex, `slopes` has the derivative of the
    /// objective by the length of its way, `speeds` the length by parameter, and `stays` whether the vertex stays anyway.
    pub(super) fn clusters(
        &self,
        params: &[f64],
        slopes: &[f64],
        speeds: &[f64],
        stays: &[bool],
    ) -> Vec<Cluster> {
        let moves = |k: usize| self.slides(k) && !stays[k];
        let mut active = Vec::new();
        for k in 0..params.len() {
            let Some((next, high)) = self.edge(params, k) else { continue };
            let limits = self.sides.iter().flat_map(|side| side.curve.limits(params[k], high, k));
            let near = limits.filter(|limit| limit.used >= NEAR).count();
            if near == 0 {
                continue;
            }
            let Some(limit) = self.limit(params[k], high, k) else { continue };
            let slope = |k: usize, slope: f64| if moves(k) { slope / speeds[k] } else { 0.0 };
            let slopes = [slope(k, limit.slopes[0]), slope(next, limit.slopes[1])];
            let is_doubled = near > self.sides.len();
            active.push(Active { ends: [k, next], slopes, multiplier: 0.0, is_doubled });
        }
        find_multipliers(&mut active, slopes);
        active.retain(|limit| limit.multiplier > 0.0);
        let mut clusters = Vec::new();
        let mut chain: Vec<Active> = Vec::new();
        // On a closed curve, the first chain may go on from the last.
        let is_joined = |a: Option<&Active>, b: &Active| a.is_some_and(|a| a.ends[1] == b.ends[0]);
        let start = (0..active.len()).find(|&k| {
            !is_joined(active.get(k.checked_sub(1).unwrap_or(active.len() - 1)), &active[k])
        });
        active.rotate_left(start.unwrap_or(0));
        for limit in active {
            if !chain.is_empty() && !is_joined(chain.last(), &limit) {
                clusters.push(self.cluster(&chain, params, speeds, &moves));
                chain.clear();
            }
            chain.push(limit);
        }
        if !chain.is_empty() {
            clusters.push(self.cluster(&chain, params, speeds, &moves));
        }
        clusters
    }

    /// Returns the cluster of a chain of limits.
    fn cluster(
        &self,
        chain: &[Active],
        params: &[f64],
        speeds: &[f64],
        moves: &impl Fn(usize) -> bool,
    ) -> Cluster {
        let mut members = vec![(chain[0].ends[0], 1.0)];
        let mut is_held = !moves(chain[0].ends[0]);
        for &Active { ends: [_, next], slopes: [a, b], is_doubled, .. } in chain {
            let ratio = -a / b;
            let is_closed = next == members[0].0;
            let is_even = (1.0 / MOST_RATIO..=MOST_RATIO).contains(&ratio.abs());
            is_held |= is_doubled || is_closed || !is_even || !moves(next);
            if is_closed {
                break;
            }
            let share = members[members.len() - 1].1;
            members.push((next, if is_even { share * ratio } else { share }));
        }
        let length = members.iter().map(|(_, share)| share * share).sum::<f64>().sqrt();
        members.iter_mut().for_each(|(_, share)| *share /= length);
        let mut cluster = Cluster { members, is_held, curvature: 0.0 };
        if !cluster.is_held {
            cluster.curvature = self.curvature_of(chain, &cluster.members, params, speeds);
        }
        cluster
    }

    /// Returns the sum of the multipliers times the second derivatives of the limits by the common unknown of the members.
    fn curvature_of(
        &self,
        chain: &[Active],
        members: &[(usize, f64)],
        params: &[f64],
        speeds: &[f64],
    ) -> f64 {
        let pairs = members.windows(2).zip(chain);
        let of_limit = |(pair, limit): (&[(usize, f64)], &Active)| {
            let [(k, a), (next, b)] = [pair[0], pair[1]];
            let Some((_, high)) = self.edge(params, k) else { return 0.0 };
            let (a, b) = (a / speeds[k], b / speeds[next]);
            let h = DIFFERENCE * (high - params[k]) / a.abs().max(b.abs());
            let slope = |by: f64| {
                let limit = self.limit(params[k] + a * by, high + b * by, k);
                limit.map_or(0.0, |Limit { slopes, .. }| a * slopes[0] + b * slopes[1])
            };
            limit.multiplier * (slope(h) - slope(-h)) / (2.0 * h)
        };
        pairs.map(of_limit).sum()
    }
}

/// Finds the multipliers, none negative, for which the slopes of the limits cancel those of the objective as far as possible:
/// the method of Gauss and Seidel for the sum of squares. A limit away from which the objective falls gets 0.
fn find_multipliers(active: &mut [Active], slopes: &[f64]) {
    let mut rest = slopes.to_vec();
    for _ in 0..PASSES {
        let mut change = 0.0_f64;
        for limit in &mut *active {
            let Active { ends: [k, next], slopes: [a, b], .. } = *limit;
            let square = a * a + b * b;
            if square == 0.0 {
                continue;
            }
            let better = (limit.multiplier - (a * rest[k] + b * rest[next]) / square).max(0.0);
            let by = better - limit.multiplier;
            limit.multiplier = better;
            (rest[k], rest[next]) = (rest[k] + by * a, rest[next] + by * b);
            change = change.max(by.abs() / better.max(f64::MIN_POSITIVE));
        }
        if change < 1e-9 {
            break;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn multipliers_cancel_slopes_that_lead_outward_and_release_others() {
        let limit = |k: usize, slopes| Active {
            ends: [k, k + 1],
            slopes,
            multiplier: 0.0,
            is_doubled: false,
        };
        // The objective falls toward the first limit and away from the second.
        let mut active = [limit(0, [1.0, -1.0]), limit(2, [0.5, -1.0])];
        find_multipliers(&mut active, &[-2.0, 2.0, 1.0, -1.0]);
        assert_eq!([active[0].multiplier, active[1].multiplier], [2.0, 0.0]);
        // Three vertices in a chain.
        let mut active = [limit(0, [1.0, -1.0]), limit(1, [1.0, -1.0])];
        find_multipliers(&mut active, &[-1.0, 0.0, 1.0]);
        assert!(active.iter().all(|limit| (limit.multiplier - 1.0).abs() < 1e-6), "{active:?}");
    }
}
