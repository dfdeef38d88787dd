//! Search for the element of a mesh that contains a point, starting from a nearby element.

use std::cmp::Ordering;
use std::collections::{BinaryHeap, HashSet};

use super::element::{Cell, LocatedPoint};
use crate::topology::Topology;
use crate::topology::predicates::orientation;

/// Largest number of steps of a straight walk; after more steps, the search spreads in all directions. Vertices move by
/// a few elements.
const STEPS: usize = 200;
/// Number of elements without a nearer one after which a spreading search ends.
const IN_VAIN: usize = 2_000;
/// Largest number of elements that a spreading search visits before it settles for the nearest.
const SPREAD: usize = 20_000;

/// A mesh in which points are located. No triangle may be inverted or flat, and no quadrilateral concave. The functions take an
/// element by any of its corners, and return it by its first corner.
pub(super) struct Locator<'a> {
    pub(super) topology: &'a Topology<'a>,
    pub(super) points: &'a [[f64; 2]],
}

impl Locator<'_> {
    /// Locates a point. The search starts from the elements of `vertex` and crosses shared edges. For a point outside
    /// of the mesh, returns the nearest point of the visited elements. `None` if the vertex has no element.
    pub(super) fn find(&self, vertex: u32, place: [f64; 2]) -> Option<LocatedPoint> {
        let star = self.topology.star(vertex);
        let first = *star.first()?;
        Some(match self.walk(first, place, STEPS) {
            Some(element) => self.within(element, place),
            None => self.spread(star, place),
        })
    }

    /// Walks toward a point across edges that separate the element from the point. Returns the element that contains
    /// the point, `None` if the boundary blocks the walk or the walk takes more than `most` steps.
    pub(super) fn walk(&self, first: u32, place: [f64; 2], most: usize) -> Option<u32> {
        let mut element = self.topology.corner_list().first(first);
        for step in 0..most {
            let cell = self.cell(element);
            let mut beyond = false;
            let mut next = None;
            for k in 0..cell.vertices().len() {
                // Each step starts with a different edge, as otherwise the walk could go in circles.
                let edge = cell.side(k + step);
                if self.is_beyond(edge, place) {
                    beyond = true;
                    next = self.across(element, edge);
                    if next.is_some() {
                        break;
                    }
                }
            }
            if !beyond {
                return Some(element);
            }
            element = next?;
        }
        None
    }

    /// Searches from the elements of `star` in all directions, elements near the point first.
    fn spread(&self, star: &[u32], place: [f64; 2]) -> LocatedPoint {
        let candidate = |&element: &u32| {
            let (distance, nearest) = self.nearest(element, place);
            Candidate { distance, element, nearest }
        };
        let corners = self.topology.corner_list();
        let mut seen: HashSet<u32> = star.iter().map(|&corner| corners.first(corner)).collect();
        let mut open: BinaryHeap<Candidate> = seen.iter().map(candidate).collect();
        let mut best: Option<Candidate> = None;
        let mut in_vain = 0;
        for _ in 0..SPREAD {
            let Some(met) = open.pop().filter(|_| in_vain < IN_VAIN) else { break };
            in_vain += 1;
            let cell = self.cell(met.element);
            if !cell.sides().any(|edge| self.is_beyond(edge, place)) {
                return self.within(met.element, place);
            }
            for edge in cell.sides() {
                if let Some(next) = self.across(met.element, edge).filter(|&t| seen.insert(t)) {
                    open.push(candidate(&next));
                }
            }
            if best.as_ref().is_none_or(|best| met.distance < best.distance) {
                best = Some(met);
                in_vain = 0;
            }
        }
        match best {
            Some(best) => self.within(best.element, best.nearest),
            None => self.within(star[0], place),
        }
    }

    /// Returns a point as the location in an element.
    pub(super) fn within(&self, element: u32, place: [f64; 2]) -> LocatedPoint {
        self.cell(element).located(self.points, place)
    }

    fn cell(&self, element: u32) -> Cell {
        Cell::of(self.topology, element)
    }

    /// Returns whether a point is on the right of an edge, whose element is on the left, by exact predicates.
    fn is_beyond(&self, edge: [u32; 2], place: [f64; 2]) -> bool {
        let [from, to] = edge.map(|vertex| self.points[vertex as usize]);
        orientation(&[from, to, place], &[0, 1, 2]) < 0.0
    }

    /// Returns the element on the other side of an edge of `element`, `None` on the boundary.
    fn across(&self, element: u32, [from, to]: [u32; 2]) -> Option<u32> {
        let corners = self.topology.corner_list();
        let [a, b] = [from, to].map(|vertex| self.topology.star(vertex));
        let (star, end) = if a.len() <= b.len() { (a, to) } else { (b, from) };
        let mut elements = star.iter().map(|&corner| corners.first(corner));
        elements.find(|&other| other != element && self.cell(other).vertices().contains(&end))
    }

    /// Returns the point of an element nearest to `place`, preceded by the squared distance between the two points.
    pub(super) fn nearest(&self, element: u32, place: [f64; 2]) -> (f64, [f64; 2]) {
        let cell = self.cell(element);
        if !cell.sides().any(|edge| self.is_beyond(edge, place)) {
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
        let first = on_edge(cell.side(0));
        let others = cell.sides().skip(1).map(on_edge);
        others.fold(first, |best, other| if other.0 < best.0 { other } else { best })
    }
}

/// An element to be searched. Candidates compare in reverse: the nearest is the greatest, and at equal distances the
/// lowest index, as a binary heap pops its greatest element.
struct Candidate {
    distance: f64,
    element: u32,
    nearest: [f64; 2],
}

impl Ord for Candidate {
    fn cmp(&self, other: &Self) -> Ordering {
        let by_distance = other.distance.total_cmp(&self.distance);
        by_distance.then(other.element.cmp(&self.element))
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
