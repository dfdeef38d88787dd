//! The end of a run by ACUTE: a few rounds of Newton steps around the triangles that are still nearly right or obtuse.

use crate::cpu::objective;
use crate::error::MeshError;
use crate::measure::{InnerEdge, inner_edges};
use crate::metric::Metric;
use crate::options::{Guard, Options};
use crate::outcome::LargeAngles;
use crate::whole::Improvement;
use crate::whole::altitude::{self, Limits};
use crate::worst::Penalties;

use super::prepared::Smoother;
use super::rounds::{Aim, Movable, PlacedCorner, Present};

/// Weight of the penalties in the first round. Each round doubles the weight.
const FIRST_WEIGHT: f64 = 1000.0;
/// Cotangent of 36 degrees, the largest angle below which angles have a penalty.
const LARGEST_SMALL: f64 = 1.376_381_920_471_173_5;

/// [`InnerEdge::flow_link`] below which, and [`InnerEdge::orthogonality`] above which, solvers refuse an edge.
const REFUSED: EdgeLimits = EdgeLimits { flow_link: 0.1, orthogonality: 0.5 };
/// The limits beyond which penalties on both triangles of an edge are larger.
const NEAR_REFUSED: EdgeLimits = EdgeLimits { flow_link: 0.12, orthogonality: 0.4 };

/// Limits of the edges between two elements.
struct EdgeLimits {
    flow_link: f64,
    orthogonality: f64,
}

impl EdgeLimits {
    fn are_broken_by(&self, edge: &InnerEdge) -> bool {
        edge.flow_link < self.flow_link || edge.orthogonality > self.orthogonality
    }
}

/// The edges that solvers refuse, the triangles that are obtuse, and all triangles with a large angle.
struct Failing {
    edges: usize,
    obtuse: usize,
    triangles: usize,
}

impl Failing {
    async fn of(movable: &Movable<'_>, aim: &ToAcute, points: &[[f64; 2]]) -> Self {
        let edges = inner_edges(movable.surface, points, &movable.smoother.topology);
        let edges = edges.iter().filter(|edge| REFUSED.are_broken_by(edge)).count();
        let triangles = movable.chosen(points, |corner| aim.is_beyond(corner)).await.len();
        /// Cotangent of 90.006 degrees. Sweeps end near right angles that are best, and rounding must not decide.
        const OBTUSE: f64 = -1e-4;
        let is_obtuse =
            |corner: PlacedCorner<'_>| !corner.is_right && corner.least_cotangent() < OBTUSE;
        let obtuse = movable.chosen(points, is_obtuse).await.len();
        Self { edges, obtuse, triangles }
    }

    /// Returns whether solvers refuse fewer edges than `before`, or as many with fewer large angles, where obtuse angles count
    /// twice.
    fn is_better_than(&self, before: &Self) -> bool {
        let score = |of: &Self| (of.edges, of.triangles + of.obtuse);
        score(self) < score(before)
    }
}

/// The rounds at the end of a run by ACUTE.
struct ToAcute {
    /// Cotangent of the angle below which angles have a penalty: the least angle after the sweeps, but at most 36 degrees.
    small: f64,
    /// The limits that keep the improvement of the worst triangles.
    limits: [f64; 2],
}

impl Aim for ToAcute {
    const ROUNDS: u32 = 5;
    const RINGS: u32 = 3;

    fn penalties(&self, round: u32) -> Penalties {
        Penalties::on_large_angles(self.small, FIRST_WEIGHT * 2f64.powi(round as i32))
    }

    fn limits(&self) -> [f64; 2] {
        self.limits
    }

    fn is_beyond(&self, corner: PlacedCorner<'_>) -> bool {
        // The right angles of quadrilaterals are no large angles.
        !corner.is_right && corner.least_cotangent() < LargeAngles::COTANGENT
    }

    /// Returns the triangles on both sides of edges with a short flow link, or far from orthogonal to it. Both triangles
    /// of such an edge have nearly right angles opposite the edge. If their penalties are larger, other triangles around
    /// the vertices at these angles become less acute instead.
    fn heavy(&self, movable: &Movable<'_>, points: &[[f64; 2]]) -> Vec<[u32; 3]> {
        let topology = &movable.smoother.topology;
        let edges = inner_edges(movable.surface, points, topology);
        let bad = edges.iter().filter(|edge| NEAR_REFUSED.are_broken_by(edge));
        let bad = bad.flat_map(|edge| edge.elements);
        // Quadrilaterals have no penalties on large angles.
        bad.filter_map(|element| topology.triangles().get(element as usize).copied()).collect()
    }
}

/// Limits of a result beyond which the rounds at the end of a run by ACUTE are undone.
pub(super) struct RoundLimits<'i> {
    /// Largest objective.
    pub(super) most: f64,
    /// The improvement of the worst triangles before the rounds, if the options ask for that.
    pub(super) improving: Option<&'i Improvement>,
}

impl Smoother<'_> {
    /// Lessens the large angles that a run by ACUTE has left at `points`, its result as stored, which are those of
    /// `positions`. Returns the record of the rounds. `None` if the run has another base metric, if its targets
    /// belong to places or are no concern of the metric, if no sweep is to be made, or if no triangle that can move has a large angle.
    /// `None` too, and the points are unchanged, if the rounds lessen neither the edges that solvers refuse nor the large
    /// angles, if f would exceed its limit, if the worst triangles would lose more than a tenth of their improvement, or if vertices that slide would
    /// exceed the guard of the worst triangle.
    pub(super) async fn lessen_large_angles(
        &self,
        options: &Options,
        RoundLimits { most, improving }: RoundLimits<'_>,
        Present { problem, mut curves, positions, points }: Present<'_>,
        goes_on: impl FnMut() -> bool,
    ) -> Result<Option<LargeAngles>, MeshError> {
        let has_field = self.field.is_some();
        let is_acute = match options.scheme.base() {
            Metric::Acute => self.problem.targets().is_none(),
            // The penalties see triangles in the plane, and a target may want large angles there.
            Metric::AcuteSize => self.problem.targets().is_none() || !self.problem.is_stretched(),
            _ => false,
        };
        if !is_acute || has_field || options.max_sweeps == 0 {
            return Ok(None);
        }
        let movable = Movable::new(self);
        let [worst] = movable.worst_shapes([points]).await;
        let limits = improving.map_or([f64::INFINITY, 0.0], Improvement::limits);
        let aim = ToAcute { small: worst.cotangent.max(LARGEST_SMALL), limits };
        let before = Failing::of(&movable, &aim, points).await;
        if before.triangles == 0 {
            return Ok(None);
        }
        let (swept, swept_curves) = (points.to_vec(), curves.as_deref().cloned());
        let present = Present { problem, curves: curves.as_deref_mut(), positions, points };
        movable.descend(&aim, options, present, goes_on).await;
        while self.certified(points, Some(self.storage(options))).await? > 0
            || options.keep_altitude
                && altitude::restore(&self.topology, &self.mesh.points, points, Limits::ALTITUDE)
                    > 0
        {}
        let now = Failing::of(&movable, &aim, points).await;
        let at = self.problem.normalized(points, Vec::new()).await;
        let f = objective(options.scheme.base(), problem, &at).await;
        let mut is_kept = now.is_better_than(&before) && f <= most;
        if let Some(improving) = improving {
            is_kept &= improving.holds_at(problem, &at).await;
        }
        // Rounds move vertices along curves without the guard.
        if options.guard == Guard::Worst {
            let lists = [&self.mesh.points[..], &swept, points];
            let [given, swept_to, now] = movable.worst_shapes(lists).await;
            // Sweeps in single precision may exceed the guard by rounding.
            is_kept &= now.has_imr_of(given) || now.has_imr_of(swept_to);
        }
        if !is_kept {
            points.copy_from_slice(&swept);
            curves.zip(swept_curves).into_iter().for_each(|(now, swept)| *now = swept);
            return Ok(None);
        }
        let moved = points.iter().zip(&swept).filter(|(to, from)| to != from).count();
        let triangles = [&before, &now].map(|failing| failing.triangles);
        let obtuse = [before, now].map(|failing| failing.obtuse);
        Ok(Some(LargeAngles { moved, triangles, obtuse, f: [0.0; 2] }))
    }
}
