//! The corners of curves, which stay: sharp turns, ends, held vertices, and partners whose curves differ.

use glam::DVec2;

use crate::slide::coincident::Coincident;
use crate::slide::edges::Edges;
use crate::slide::options::Slide;
use crate::slide::partners::{Partner, Partners};
use crate::topology::Topology;

/// Angle in radians above which a curve turns at a vertex. The possible effect of rounded coordinates is added.
const STRAIGHT: f64 = 1e-6;

/// The curves' edges with the facts that determine which vertices are corners.
pub(crate) struct Corners<'c> {
    points: &'c [[f64; 2]],
    topology: &'c Topology<'c>,
    corner_angle: f64,
    pub(crate) edges: Edges,
    pub(crate) partners: Partners,
    /// Number of curve vertices at the place of another vertex.
    pub(crate) coincident: usize,
    /// Vertices that do not slide, ascending.
    held: Vec<u32>,
}

impl<'c> Corners<'c> {
    pub(crate) fn new(points: &'c [[f64; 2]], topology: &'c Topology<'c>, slide: &Slide) -> Self {
        let edges = Edges::of(topology, slide);
        let mut held = slide.held.clone();
        // A fixed vertex slides along given lines only.
        let is_on_lines = |&v: &u32| edges.at(v).iter().all(|edge| edges.is_of_lines(edge));
        held.extend(topology.fixed_on_boundary().iter().copied().filter(|v| !is_on_lines(v)));
        held.sort_unstable();
        let on_curves: Vec<u32> = edges.all.iter().map(|&(v, _)| v).collect();
        let coincident = Coincident::of(points, &on_curves, &held);
        let shortest = |v: u32| shortest(points, &edges, v);
        let partners = Partners::new(&slide.periodic, &coincident, points, shortest);
        let (corner_angle, coincident) = (slide.corner_angle, coincident.count());
        Self { points, topology, corner_angle, edges, partners, coincident, held }
    }

    /// Returns the position of a vertex.
    pub(crate) fn at(&self, v: u32) -> DVec2 {
        self.points[v as usize].into()
    }

    /// Returns the two neighbors of a vertex on its curve. `None` unless exactly one curve passes through the vertex.
    fn neighbors(&self, v: u32) -> Option<[u32; 2]> {
        match self.edges.at(v) {
            &[(_, a), (_, b)] => Some([a, b]),
            _ => None,
        }
    }

    /// Returns the turn of the curve at a vertex. `None` unless exactly one curve passes through the vertex.
    fn turn(&self, v: u32) -> Option<Turn> {
        self.neighbors(v).map(|[a, b]| turn_between(self.at(a), self.at(v), self.at(b)))
    }

    /// Returns a vertex and its partner, which must agree about corners, even if rounding makes their curves differ.
    fn with_partner(&self, v: u32) -> impl Iterator<Item = u32> {
        std::iter::once(v).chain(self.partners.of(v).map(|to| to.vertex))
    }

    fn is_flat(&self, v: u32) -> bool {
        self.with_partner(v).all(|v| self.turn(v).is_some_and(|turn| turn.is_flat()))
    }

    /// Returns whether an edge belongs to a straight run of two or more edges.
    pub(crate) fn is_straight(&self, a: u32, b: u32) -> bool {
        self.is_flat(a) || self.is_flat(b)
    }

    /// Returns whether a vertex is a corner, whatever its partner.
    fn is_corner_itself(&self, v: u32) -> bool {
        let Some((turn, [a, b])) = self.turn(v).zip(self.neighbors(v)) else { return true };
        self.held.binary_search(&v).is_ok()
            || turn.angle.to_degrees() > self.corner_angle
            // The tip of a crack.
            || self.at(a) == self.at(b)
            || !self.is_flat(v) && self.is_straight(v, a) && self.is_straight(v, b)
    }

    fn must_stay(&self, v: u32) -> bool {
        self.partners.stays(v) || self.with_partner(v).any(|v| self.is_corner_itself(v))
    }

    /// Returns whether the curve at the partner continues to both sides like the curve at the vertex, with partners as
    /// neighbors.
    fn is_matched(
        &self,
        v: u32,
        Partner { vertex: partner, motion, is_coincident }: Partner,
    ) -> bool {
        let edge = |v: u32| shortest(self.points, &self.edges, v);
        let goes_on = |from: u32, to: u32| {
            let pair @ [here, there] = [self.at(from), self.at(to)];
            let agrees = match is_coincident {
                true => here == there,
                false => Partners::agree(motion, pair, edge(v).min(edge(partner))),
            };
            agrees
                && (self.partners.are_pair(from, to) || self.must_stay(from) && self.must_stay(to))
        };
        let has_both = |&t: &u32| self.topology.corners()[t as usize].contains(&partner);
        match (self.neighbors(v), self.neighbors(partner)) {
            (Some([a, b]), Some([c, d])) => {
                (goes_on(a, c) && goes_on(b, d) || goes_on(a, d) && goes_on(b, c))
                    && !self.topology.star(v).iter().any(has_both)
            }
            _ => false,
        }
    }

    /// Returns whether a vertex of a curve stays, so that curves end at the vertex.
    pub(crate) fn is_corner(&self, v: u32) -> bool {
        self.must_stay(v) || self.partners.of(v).is_some_and(|partner| !self.is_matched(v, partner))
    }
}

/// Returns the length of the shortest curve edge at a vertex, 0 for a vertex on no curve.
fn shortest(points: &[[f64; 2]], edges: &Edges, v: u32) -> f64 {
    let at = |v: u32| DVec2::from(points[v as usize]);
    let lengths = edges.at(v).iter().map(|&(_, other)| at(v).distance(at(other)));
    lengths.reduce(f64::min).unwrap_or(0.0)
}

/// The turn of a curve at a vertex, unsigned.
struct Turn {
    /// Angle in radians, from 0 to π.
    angle: f64,
    /// Largest angle in radians that the rounding of coordinates alone may cause.
    rounding: f64,
}

impl Turn {
    fn is_flat(&self) -> bool {
        self.angle <= STRAIGHT + self.rounding
    }
}

fn turn_between(a: DVec2, v: DVec2, b: DVec2) -> Turn {
    let (before, after) = (v - a, b - v);
    let size = a.abs().max(v.abs()).max(b.abs()).max_element();
    let shorter = before.length().min(after.length());
    let rounding = 4.0 * f64::EPSILON * size / shorter;
    Turn { angle: before.perp_dot(after).atan2(before.dot(after)).abs(), rounding }
}
