//! Chains of boundary and line edges from corner to corner, through which curves pass.

use std::collections::BTreeSet;

use glam::DVec2;

use crate::slide::options::Slide;
use crate::slide::partners::{Partner, Partners};
use crate::topology::Topology;

/// Angle in radians above which a curve turns at a vertex. The possible effect of rounded coordinates is added.
const STRAIGHT: f64 = 1e-6;

/// The vertices of a curve, in order along the curve.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Chain {
    /// Vertices as indices in the mesh. The two ends of an open curve are corners and stay fixed.
    pub(crate) vertices: Vec<u32>,
    /// True for a chain without corners, whose last vertex is joined to the first by an edge.
    pub(crate) is_closed: bool,
    /// For each edge, true if the edge belongs to a straight run of two or more edges.
    pub(crate) straight: Vec<bool>,
    /// Partners of the vertices, in the order of `vertices`. `None` if the vertices have no partners on another curve.
    pub(crate) image: Option<Vec<u32>>,
}

/// Returns the chains with at least one sliding vertex, ordered by vertex indices. Of two chains whose vertices form
/// pairs, only one is returned. The second result counts the pairs that stay because the common motion does not fit
/// them.
pub(crate) fn chains(
    points: &[[f64; 2]],
    topology: &Topology<'_>,
    slide: &Slide,
) -> (Vec<Chain>, usize) {
    let edges = Edges::of(topology, slide);
    let at = |v: u32| DVec2::from(points[v as usize]);
    let shortest = |v: u32| {
        let lengths = edges.at(v).iter().map(|&(_, other)| at(v).distance(at(other)));
        lengths.reduce(f64::min).unwrap_or(0.0)
    };
    let partners = Partners::new(&slide.periodic, points, shortest);
    let mut held = slide.held.clone();
    // A fixed vertex slides along given lines only.
    let is_on_lines = |&v: &u32| edges.at(v).iter().all(|edge| edges.is_of_lines(edge));
    held.extend(topology.fixed_on_boundary().iter().copied().filter(|v| !is_on_lines(v)));
    held.sort_unstable();
    // The turn of the curve at a vertex. `None` unless exactly one curve passes through the vertex.
    let turn = |v: u32| match edges.at(v) {
        &[(_, a), (_, b)] => Some(turn_between(at(a), at(v), at(b))),
        _ => None,
    };
    // Partners must agree about corners, even if rounding makes their curves differ.
    let with_partner = |v: u32| std::iter::once(v).chain(partners.of(v).map(|to| to.vertex));
    let is_flat = |v: u32| with_partner(v).all(|v| turn(v).is_some_and(|turn| turn.is_flat()));
    let is_straight = |a: u32, b: u32| is_flat(a) || is_flat(b);
    let is_corner_itself = |v: u32| match turn(v) {
        None => true,
        Some(turn) => {
            let bends = || edges.at(v).iter().all(|&(_, other)| is_straight(v, other));
            held.binary_search(&v).is_ok()
                || turn.angle.to_degrees() > slide.corner_angle
                || !is_flat(v) && bends()
        }
    };
    let must_stay = |v: u32| partners.stays(v) || with_partner(v).any(is_corner_itself);
    // Whether the curve at the partner continues to both sides like the curve at the vertex, with partners as
    // neighbors.
    let is_matched = |v: u32, Partner { vertex: partner, motion }: Partner| {
        let goes_on = |from: u32, to: u32| {
            let pair = [at(from), at(to)];
            Partners::agree(motion, pair, shortest(v).min(shortest(partner)))
                && (partners.are_pair(from, to) || must_stay(from) && must_stay(to))
        };
        let has_both = |&t: &u32| topology.triangles()[t as usize].contains(&partner);
        match (edges.at(v), edges.at(partner)) {
            (&[(_, a), (_, b)], &[(_, c), (_, d)]) => {
                (goes_on(a, c) && goes_on(b, d) || goes_on(a, d) && goes_on(b, c))
                    && !topology.star(v).iter().any(has_both)
            }
            _ => false,
        }
    };
    let is_corner =
        |v: u32| must_stay(v) || partners.of(v).is_some_and(|partner| !is_matched(v, partner));
    let mut chains = Vec::new();
    let mut walked = vec![false; points.len()];
    let mut add = |start: u32, next: u32, walked: &mut Vec<bool>| {
        let (mut vertices, mut last, mut v) = (vec![start], start, next);
        while v != start && !is_corner(v) {
            walked[v as usize] = true;
            vertices.push(v);
            let other = edges.at(v).iter().map(|&(_, other)| other).find(|&other| other != last);
            // Two vertices share at most one edge, so the vertex has another neighbor.
            let Some(next) = other else { break };
            (last, v) = (v, next);
        }
        let is_closed = v == start && !is_corner(start);
        if !is_closed {
            vertices.push(v);
        }
        if vertices.len() > 2 {
            let ends = vertices.iter().skip(1).chain(is_closed.then_some(&vertices[0]));
            let straight = vertices.iter().zip(ends).map(|(&a, &b)| is_straight(a, b)).collect();
            chains.push(Chain { vertices, is_closed, straight, image: None });
        }
    };
    for &(v, next) in edges.all.iter().filter(|&&(v, _)| is_corner(v)) {
        if !is_corner(next) && !walked[next as usize] {
            add(v, next, &mut walked);
        }
    }
    for &(v, next) in &edges.all {
        if !is_corner(v) && !walked[v as usize] {
            walked[v as usize] = true;
            add(v, next, &mut walked);
        }
    }
    let image = |chain: &Chain| {
        let inner = usize::from(!chain.is_closed);
        let of = |&v: &u32| partners.of(v).map(|partner| partner.vertex);
        let mut image: Option<Vec<u32>> =
            chain.vertices[inner..chain.vertices.len() - inner].iter().map(of).collect();
        if let (Some(image), false) = (&mut image, chain.is_closed) {
            // Ends of the other chain: the neighbor nearest to the image of this chain's end under the motion.
            let end = |end: u32, last: u32| {
                let Partner { vertex, motion } = partners.of(last)?;
                let there = |v: &u32| at(*v).distance(motion.at(at(end)));
                let neighbors = edges.at(vertex).iter().map(|&(_, other)| other);
                neighbors.min_by(|a, b| there(a).total_cmp(&there(b)))
            };
            let all = &chain.vertices;
            let count = all.len();
            image.insert(0, end(all[0], all[1])?);
            image.push(end(all[count - 1], all[count - 2])?);
        }
        image
    };
    (joined(chains, image), partners.unlike)
}

/// Assigns partners to each chain. Leaves out chains of partners of an earlier chain, and chains whose partners are on
/// the chain itself.
fn joined(chains: Vec<Chain>, image: impl Fn(&Chain) -> Option<Vec<u32>>) -> Vec<Chain> {
    let inner = |vertices: &[u32], is_closed: bool| match is_closed {
        true => vertices.to_vec(),
        false => vertices[1..vertices.len() - 1].to_vec(),
    };
    let mut taken = BTreeSet::new();
    let mut kept = Vec::new();
    for mut chain in chains {
        chain.image = image(&chain);
        if let Some(image) = &chain.image {
            let own = inner(&chain.vertices, chain.is_closed);
            let other = inner(image, chain.is_closed);
            if own.iter().chain(&other).any(|v| taken.contains(v)) {
                continue;
            }
            taken.extend(own.iter().copied());
            if other.iter().any(|v| taken.contains(v)) {
                continue;
            }
            taken.extend(other);
        }
        kept.push(chain);
    }
    kept
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

/// Edges of curves as (start, end), in both directions, in ascending order.
struct Edges {
    all: Vec<(u32, u32)>,
    /// Edges of the given lines, boundary edges included.
    of_lines: Vec<(u32, u32)>,
}

impl Edges {
    fn of(topology: &Topology<'_>, slide: &Slide) -> Self {
        let is_edge = |&[a, b]: &[u32; 2]| {
            let has_both = |&t: &u32| topology.triangles()[t as usize].contains(&b);
            a != b && topology.star(a).iter().any(has_both)
        };
        let is_held = |v: u32| !topology.free()[v as usize];
        let stays = |&[a, b]: &[u32; 2]| is_held(a) && is_held(b);
        let lines = slide.lines.iter().copied().filter(|line| stays(line) && is_edge(line));
        let both = |edges: &mut dyn Iterator<Item = [u32; 2]>| {
            let mut edges: Vec<_> = edges.flat_map(|[a, b]| [(a, b), (b, a)]).collect();
            edges.sort_unstable();
            edges.dedup();
            edges
        };
        let of_lines = both(&mut lines.into_iter());
        let all = topology.boundary_edges().into_iter();
        Self { all: both(&mut all.chain(of_lines.iter().map(|&(a, b)| [a, b]))), of_lines }
    }

    fn is_of_lines(&self, edge: &(u32, u32)) -> bool {
        self.of_lines.binary_search(edge).is_ok()
    }

    /// Returns the edges that start at a vertex.
    fn at(&self, v: u32) -> &[(u32, u32)] {
        let start = self.all.partition_point(|&(from, _)| from < v);
        let count = self.all[start..].iter().take_while(|&&(from, _)| from == v).count();
        &self.all[start..start + count]
    }
}
