//! Search for the triangle of a mesh that contains a point, starting from a nearby triangle.

use std::cmp::Ordering;
use std::collections::{BinaryHeap, HashSet};

use crate::topology::Topology;
use crate::topology::predicates::orientation;

/// Largest number of steps of a straight walk; after more steps, the search spreads in all directions. Vertices move by
/// a few triangles.
const STEPS: usize = 200;
/// Largest number of triangles that a spreading search visits before it settles for the nearest.
const SPREAD: usize = 20_000;

/// A mesh in which points are located. No triangle may be inverted or flat.
pub(super) struct Locator<'a> {
    pub(super) topology: &'a Topology<'a>,
    pub(super) points: &'a [[f64; 2]],
}

/// A located point, in a triangle with corners a, b, c: a + (b - a) `weights[0]` + (c - a) `weights[1]`.
#[derive(Clone, Copy, Debug)]
pub(super) struct LocatedPoint {
    pub(super) corners: [u32; 3],
    pub(super) weights: [f64; 2],
}

impl Locator<'_> {
    /// Locates a point. The search starts from the triangles of `vertex` and crosses shared edges. For a point outside
    /// of the mesh, returns the nearest point of the visited triangles. `None` if the vertex has no triangle.
    pub(super) fn find(&self, vertex: u32, place: [f64; 2]) -> Option<LocatedPoint> {
        let star = self.topology.star(vertex);
        let first = *star.first()?;
        Some(match self.walk(first, place) {
            Some(triangle) => self.within(triangle, place),
            None => self.spread(star, place),
        })
    }

    /// Walks toward a point across edges that separate the triangle from the point. Returns the triangle that contains
    /// the point, `None` if the boundary blocks the walk or the walk exceeds [`STEPS`].
    pub(super) fn walk(&self, first: u32, place: [f64; 2]) -> Option<u32> {
        let mut triangle = first;
        for step in 0..STEPS {
            let corners = self.corners(triangle);
            let mut beyond = false;
            let mut next = None;
            for k in 0..3 {
                // Each step starts with a different edge, as otherwise the walk could go in circles.
                let edge = edge_of(corners, (k + step) % 3);
                if self.is_beyond(edge, place) {
                    beyond = true;
                    next = self.across(triangle, edge);
                    if next.is_some() {
                        break;
                    }
                }
            }
            if !beyond {
                return Some(triangle);
            }
            triangle = next?;
        }
        None
    }

    /// Searches from the triangles of `star` in all directions, triangles near the point first.
    fn spread(&self, star: &[u32], place: [f64; 2]) -> LocatedPoint {
        let candidate = |&triangle: &u32| {
            let (distance, nearest) = self.nearest(triangle, place);
            Candidate { distance, triangle, nearest }
        };
        let mut seen: HashSet<u32> = star.iter().copied().collect();
        let mut open: BinaryHeap<Candidate> = star.iter().map(candidate).collect();
        let mut best: Option<Candidate> = None;
        for _ in 0..SPREAD {
            let Some(met) = open.pop() else { break };
            let corners = self.corners(met.triangle);
            let edges = [0, 1, 2].map(|k| edge_of(corners, k));
            if !edges.iter().any(|&edge| self.is_beyond(edge, place)) {
                return self.within(met.triangle, place);
            }
            for edge in edges {
                if let Some(next) = self.across(met.triangle, edge).filter(|&t| seen.insert(t)) {
                    open.push(candidate(&next));
                }
            }
            if best.as_ref().is_none_or(|best| met.distance < best.distance) {
                best = Some(met);
            }
        }
        match best {
            Some(best) => self.within(best.triangle, best.nearest),
            None => self.within(star[0], place),
        }
    }

    /// Returns the weights of a point in a triangle. If rounding has put the point outside, it is moved to the edge.
    pub(super) fn within(&self, triangle: u32, place: [f64; 2]) -> LocatedPoint {
        let corners = self.corners(triangle);
        let [a, b, c] = corners.map(|vertex| self.points[vertex as usize]);
        let area = |corners: [[f64; 2]; 3]| orientation(&corners, &[0, 1, 2]);
        let share = |part: f64| (part / area([a, b, c])).clamp(0.0, 1.0);
        let mut weights = [share(area([a, place, c])), share(area([a, b, place]))];
        let sum = weights[0] + weights[1];
        if sum > 1.0 {
            weights = weights.map(|weight| weight / sum);
        }
        LocatedPoint { corners, weights }
    }

    fn corners(&self, triangle: u32) -> [u32; 3] {
        self.topology.triangles()[triangle as usize]
    }

    /// Returns whether a point is on the right of an edge, whose triangle is on the left, by exact predicates.
    fn is_beyond(&self, edge: [u32; 2], place: [f64; 2]) -> bool {
        let [from, to] = edge.map(|vertex| self.points[vertex as usize]);
        orientation(&[from, to, place], &[0, 1, 2]) < 0.0
    }

    /// Returns the triangle on the other side of an edge of `triangle`, `None` on the boundary.
    fn across(&self, triangle: u32, [from, to]: [u32; 2]) -> Option<u32> {
        let [a, b] = [from, to].map(|vertex| self.topology.star(vertex));
        let (star, end) = if a.len() <= b.len() { (a, to) } else { (b, from) };
        star.iter().copied().find(|&t| t != triangle && self.corners(t).contains(&end))
    }

    /// Returns the point of a triangle nearest to `place`, preceded by the squared distance between the two points.
    pub(super) fn nearest(&self, triangle: u32, place: [f64; 2]) -> (f64, [f64; 2]) {
        let corners = self.corners(triangle);
        let edges = [0, 1, 2].map(|k| edge_of(corners, k));
        if !edges.iter().any(|&edge| self.is_beyond(edge, place)) {
            return (0.0, place);
        }
        let on_edge = |edge: [u32; 2]| {
            let [[ax, ay], [bx, by]] = edge.map(|vertex| self.points[vertex as usize]);
            let [dx, dy] = [bx - ax, by - ay];
            let along = ((place[0] - ax) * dx + (place[1] - ay) * dy) / (dx * dx + dy * dy);
            // `along` is NaN if the edge is so short that its square vanishes.
            let along = if along.is_nan() { 0.0 } else { along.clamp(0.0, 1.0) };
            let nearest = [ax + along * dx, ay + along * dy];
            let distance = (nearest[0] - place[0]).powi(2) + (nearest[1] - place[1]).powi(2);
            (distance, nearest)
        };
        let [a, b, c] = edges.map(on_edge);
        [b, c].into_iter().fold(a, |best, other| if other.0 < best.0 { other } else { best })
    }
}

/// Returns the edge from corner `k` to the next corner, cyclically.
fn edge_of(corners: [u32; 3], k: usize) -> [u32; 2] {
    [corners[k], corners[(k + 1) % 3]]
}

/// A triangle to be searched. Candidates compare in reverse: the nearest is the greatest, and at equal distances the
/// lowest index, as a binary heap pops its greatest element.
struct Candidate {
    distance: f64,
    triangle: u32,
    nearest: [f64; 2],
}

impl Ord for Candidate {
    fn cmp(&self, other: &Self) -> Ordering {
        let by_distance = other.distance.total_cmp(&self.distance);
        by_distance.then(other.triangle.cmp(&self.triangle))
    }
}

impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Candidate {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Candidate {}
