//! Newton rounds that bring triangles back within limits of angle and inverse mean ratio.

use glam::DVec2;

use crate::layout::Problem;
use crate::parallel::paced;
use crate::worst::penalties::Penalties;
use crate::worst::region::{MoveConstraints, Region};

/// Number of visits of each vertex in a round.
pub(crate) const VISITS: u32 = 5;

/// Does a round: visits the free vertices of each region [`VISITS`] times. Returns the vertices of the problem that have
/// moved, with their normalized positions.
pub(crate) async fn round(
    problem: &Problem,
    rules: &MoveConstraints<'_>,
    penalties: Penalties,
    positions: &[DVec2],
    regions: Vec<Vec<u32>>,
) -> Vec<(u32, DVec2)> {
    let visited = paced::map_futures(regions, |vertices| async {
        Region::new(problem, rules, positions, vertices).descend(penalties, VISITS).await
    });
    visited.await.concat()
}
