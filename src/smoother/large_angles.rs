//! The end of a run by ACUTE: a few rounds of Newton steps around the triangles that are still nearly right or obtuse.

use glam::DVec2;

use crate::error::MeshError;
use crate::layout::Problem;
use crate::measure::{InnerEdge, inner_edges};
use crate::metric::Metric;
use crate::options::{Guard, Options};
use crate::outcome::LargeAngles;
use crate::slide::OnCurves;
use crate::whole::altitude;
use crate::worst::Penalties;

use super::prepared::Smoother;
use super::rounds::{Aim, Movable, PlacedCorner, Present};

/// Weight of the penalties in the first round. Each round doubles the weight.
const FIRST_WEIGHT: f64 = 1000.0;
/// Cotangent of 36 degrees, the largest angle below which angles have a penalty.
const LARGEST_SMALL: f64 = 1.376_381_920_471_173_5;

/// [`InnerEdge::flow_link`] below which, and [`InnerEdge::orthogonality`] above which, penalties on both triangles of an
/// edge are larger. Solvers refuse edges beyond 0.1 and 0.5.
const SHORT_LINK: f64 = 0.12;
const FAR_FROM_ORTHOGONAL: f64 = 0.4;

/// The rounds at the end of a run by ACUTE.
struct ToAcute {
    /// Cotangent of the angle below which angles have a penalty: the least angle after the sweeps, but at most 36 degrees.
    small: f64,
}

impl Aim for ToAcute {
    const ROUNDS: u32 = 5;
    const RINGS: u32 = 3;

    fn penalties(&self, round: u32) -> Penalties {
        Penalties::on_large_angles(self.small, FIRST_WEIGHT * 2f64.powi(round as i32))
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
        let is_bad = |edge: &InnerEdge| {
            edge.flow_link < SHORT_LINK || edge.orthogonality > FAR_FROM_ORTHOGONAL
        };
        let edges = inner_edges(movable.surface, points, topology);
        let bad = edges.iter().filter(|edge| is_bad(edge)).flat_map(|edge| edge.elements);
        // Quadrilaterals have no penalties on large angles.
        bad.filter_map(|element| topology.triangles().get(element as usize).copied()).collect()
    }
}

impl Smoother<'_> {
    /// Lessens the large angles that a run by ACUTE has left at `points`, its result as stored, which are those of
    /// `positions`. Returns the record of the rounds. `None` if the run has another base metric, if its targets
    /// belong to places or are no concern of the metric, if no sweep is to be made, or if no triangle that can move has a large angle.
    /// `None` too, and the points are unchanged, if vertices that slide would exceed the guard of the worst triangle.
    pub(super) async fn lessen_large_angles(
        &self,
        options: &Options,
        problem: &Problem,
        mut curves: Option<&mut OnCurves>,
        positions: &[DVec2],
        points: &mut Vec<[f64; 2]>,
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
        let aim = ToAcute { small: worst.cotangent.max(LARGEST_SMALL) };
        let count = async |points: &[[f64; 2]]| {
            movable.chosen(points, |corner| aim.is_beyond(corner)).await.len()
        };
        let before = count(points).await;
        if before == 0 {
            return Ok(None);
        }
        let (swept, swept_curves) = (points.clone(), curves.as_deref().cloned());
        let present = Present { problem, curves: curves.as_deref_mut(), positions, points };
        movable.descend(&aim, options, present, goes_on).await;
        while self.certified(points, Some(options.stored)).await? > 0
            || options.keep_altitude
                && altitude::restore(&self.topology, &self.mesh.points, points, f64::INFINITY) > 0
        {
        }
        // Rounds move vertices along curves without the guard.
        if options.guard == Guard::Worst {
            let lists = [&self.mesh.points[..], &swept, points];
            let [given, swept_to, now] = movable.worst_shapes(lists).await;
            // Sweeps in single precision may exceed the guard by rounding.
            if !now.has_imr_of(given) && !now.has_imr_of(swept_to) {
                *points = swept;
                curves.zip(swept_curves).into_iter().for_each(|(now, swept)| *now = swept);
                return Ok(None);
            }
        }
        let moved = points.iter().zip(&swept).filter(|(to, from)| to != from).count();
        Ok(Some(LargeAngles { moved, triangles: [before, count(points).await], f: [0.0; 2] }))
    }
}
