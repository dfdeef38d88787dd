//! The front: the vertices of walls above which rows may begin.

use crate::layers::march::OFFSET;
use crate::layers::measure::Measure;
use crate::layers::sectors::{NONE, Sectors};
use crate::layers::vector::{length, minus};

/// Least aspect of the first row at a seed, up to rounding: 2. Rows of lower aspect are no layers.
pub(super) const SEED_ASPECT: f64 = 2.0 - 1e-9;

/// Number of vertices in a gap that closes whatever its heights.
const GAP: usize = 2;

/// Angle of the fluid, in degrees, below which a corner separates fronts. There, inlets meet walls.
pub(super) const CORNER: f64 = 120.0;

/// Returns the seeds: the nodes of walls whose nearest inner neighbor is above the node, at a small height.
pub(super) fn seeds(sectors: &Sectors) -> Vec<bool> {
    (0..sectors.len() as u32)
        .map(|node| {
            first(sectors, node).is_some_and(|m| m.offset <= OFFSET && m.aspect >= SEED_ASPECT)
        })
        .collect()
}

/// Measures the inner neighbor of a wall's node that is the nearest, preferring neighbors right above the node.
fn first(sectors: &Sectors, node: u32) -> Option<Measure> {
    if !sectors.is_wall(node) {
        return None;
    }
    let beside = &sectors.wall[node as usize];
    let inner = sectors.neighbors(node).iter().filter(|n| !sectors.is_wall(**n));
    let measured = inner.map(|&n| {
        let distance = length(minus(sectors.point(n), sectors.point(node)));
        let measure = Measure::new(sectors, n, node, beside);
        (measure.offset > OFFSET, distance, measure)
    });
    measured.min_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))).map(|(_, _, measure)| measure)
}

/// Returns the seeds and the gaps between them that close.
pub(super) fn front(sectors: &Sectors, seeds: &[bool]) -> Vec<bool> {
    let mut front = seeds.to_vec();
    let candidates: Vec<u32> =
        (0..sectors.len() as u32).filter(|&n| sectors.is_wall(n) && !seeds[n as usize]).collect();
    let mut height = vec![f64::NAN; sectors.len()];
    for node in (0..sectors.len() as u32).filter(|&n| sectors.is_wall(n)) {
        height[node as usize] = first(sectors, node).map_or(f64::NAN, |m| m.height);
    }
    let beside = |node: u32| sectors.wall[node as usize];
    let may_close = |node: u32| sectors.fluid[node as usize] >= CORNER;
    close(&mut front, &candidates, &height, 1.5, beside, may_close);
    front
}

/// Returns the nodes of whole walls of which at least a quarter of the nodes are seeds, and the [`front`] on other walls. A wall goes
/// from corner to corner. A corner belongs to the walls on both sides, so that a seed at a corner alone would make walls of
/// inlets; it does not count.
pub(super) fn walls(sectors: &Sectors, seeds: &[bool]) -> Vec<bool> {
    let is_corner = |node: u32| sectors.fluid[node as usize] < CORNER;
    let mut walls = front(sectors, seeds);
    let mut is_reached = vec![false; sectors.len()];
    for start in (0..sectors.len() as u32).filter(|&n| seeds[n as usize] && !is_corner(n)) {
        if std::mem::replace(&mut is_reached[start as usize], true) {
            continue;
        }
        let (mut wall, mut corners, mut at) = (vec![start], Vec::new(), 0);
        while let Some(&node) = wall.get(at) {
            at += 1;
            for other in sectors.wall[node as usize].into_iter().filter(|other| *other != NONE) {
                if is_corner(other) {
                    corners.push(other);
                } else if !std::mem::replace(&mut is_reached[other as usize], true) {
                    wall.push(other);
                }
            }
        }
        let count = wall.iter().filter(|node| seeds[**node as usize]).count();
        if 4 * count >= wall.len() {
            wall.into_iter().chain(corners).for_each(|node| walls[node as usize] = true);
        }
    }
    walls
}

/// Closes the gaps among `candidates` between marked nodes: gaps of at most two nodes, and gaps whose heights are within
/// `ratio` of those at their ends. `may_close` allows a node in a gap.
pub(super) fn close<B: AsRef<[u32]>>(
    marked: &mut [bool],
    candidates: &[u32],
    height: &[f64],
    ratio: f64,
    beside: impl Fn(u32) -> B,
    may_close: impl Fn(u32) -> bool,
) {
    let mut is_open = vec![false; marked.len()];
    candidates.iter().for_each(|&n| is_open[n as usize] = true);
    for &start in candidates {
        if !is_open[start as usize] {
            continue;
        }
        is_open[start as usize] = false;
        let (mut gap, mut ends, mut at) = (vec![start], Vec::new(), 0);
        while let Some(&node) = gap.get(at) {
            at += 1;
            for &other in beside(node).as_ref().iter().filter(|n| **n != NONE) {
                if marked[other as usize] {
                    ends.push(other);
                } else if std::mem::take(&mut is_open[other as usize]) {
                    gap.push(other);
                }
            }
        }
        let of_ends = || ends.iter().map(|&n| height[n as usize]);
        let least = of_ends().fold(f64::INFINITY, f64::min) / ratio;
        let largest = of_ends().fold(0.0, f64::max) * ratio;
        let is_alike = || gap.iter().all(|&n| (least..=largest).contains(&height[n as usize]));
        if ends.len() >= 2 && (gap.len() <= GAP || is_alike()) && gap.iter().all(|&n| may_close(n))
        {
            gap.iter().for_each(|&n| marked[n as usize] = true);
        }
    }
}
