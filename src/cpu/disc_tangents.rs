//! Directions of corrections for free vertices within discs around their given positions.

use glam::{DVec2, Vec2};

use crate::cpu::along::disc;
use crate::layout::Problem;
use crate::parallel::paced;
use crate::patch::{AT_DISC, Circle};

/// The free vertices at the circles of their discs whose descent leads outward, with the unit tangents of the circles at
/// the positions. A correction moves these vertices along their tangents.
#[derive(Default)]
pub(super) struct DiscTangents(Vec<(u32, DVec2)>);

impl DiscTangents {
    /// Number of vertices that one task tests.
    const TESTED: usize = 1 << 12;

    /// Returns the tangents for the gradient of f at the free vertices.
    pub(super) async fn at(problem: &Problem, positions: &[DVec2], gradient: &[Vec2]) -> Self {
        if problem.radii().is_none() {
            return Self::default();
        }
        let coordinates = problem.coordinates();
        let tangent = |v: usize| {
            let Circle { center, radius } = disc(problem, v)?;
            let away = coordinates.at(positions[v]) - center;
            let [slope, _] = coordinates.slopes(positions[v]);
            // The conormal of the circle in the coordinates of positions.
            let normal = DVec2::new(away.x, away.y * slope).normalize_or_zero();
            let is_held = away.length() >= AT_DISC * radius;
            let leads_out = gradient[v].as_dvec2().dot(normal) < 0.0 || normal == DVec2::ZERO;
            (is_held && leads_out).then(|| normal.perp())
        };
        let found = paced::map_ranges(gradient.len(), Self::TESTED, |range| -> Vec<(u32, DVec2)> {
            range.filter_map(|v| Some((v as u32, tangent(v)?))).collect()
        });
        Self(found.await.concat())
    }

    /// Projects vectors at the free vertices onto the tangents.
    pub(super) fn project(&self, vectors: &mut [Vec2]) {
        for &(v, tangent) in &self.0 {
            let vector = &mut vectors[v as usize];
            *vector = (tangent * tangent.dot(vector.as_dvec2())).as_vec2();
        }
    }
}
