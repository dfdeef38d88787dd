//! Chains of boundary and line edges from corner to corner, through which curves pass.

use std::collections::BTreeSet;

use crate::slide::corners::Corners;
use crate::slide::options::Slide;
use crate::slide::partners::Partner;
use crate::topology::Topology;

/// The vertices of a curve, in order along the curve.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Chain {
    /// Vertices as indices in the mesh. The two ends of an open curve are corners and stay fixed.
    pub(crate) vertices: Vec<u32>,
    /// True for a chain without corners, whose last vertex is joined to the first by an edge.
    pub(crate) is_closed: bool,
    /// For each edge, true if the edge belongs to a straight run of two or more edges.
    pub(crate) straight: Vec<bool>,
    /// The partners of the vertices. `None` if the vertices have no partners on another curve.
    pub(crate) image: Option<Image>,
}

/// The partners of the vertices of a chain.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Image {
    /// Partners in the order of the chain's vertices.
    pub(crate) vertices: Vec<u32>,
    /// Whether partners have equal positions, as on the sides of a crack.
    pub(crate) is_coincident: bool,
}

/// The chains of a mesh, and facts about the partners of its vertices.
pub(crate) struct Chains {
    /// The chains with at least one sliding vertex, ordered by vertex indices. Of two chains whose vertices form pairs,
    /// only one is listed.
    pub(crate) all: Vec<Chain>,
    /// Number of periodic pairs that stay because the common motion does not fit them.
    pub(crate) unlike: usize,
    /// Number of vertices of curves that have the position of another vertex.
    pub(crate) coincident: usize,
}

impl Chains {
    /// Finds the chains of a mesh with its vertices at `points`.
    pub(crate) fn of(points: &[[f64; 2]], topology: &Topology<'_>, slide: &Slide) -> Self {
        let corners = Corners::new(points, topology, slide);
        let mut walk = Walk { corners: &corners, walked: vec![false; points.len()], found: vec![] };
        let edges = &corners.edges.all;
        for &(v, next) in edges.iter().filter(|&&(v, _)| corners.is_corner(v)) {
            if !corners.is_corner(next) && !walk.walked[next as usize] {
                walk.add(v, next);
            }
        }
        for &(v, next) in edges {
            if !corners.is_corner(v) && !walk.walked[v as usize] {
                walk.walked[v as usize] = true;
                walk.add(v, next);
            }
        }
        let all = joined(walk.found, |chain| image(&corners, chain));
        Self { all, unlike: corners.partners.unlike, coincident: corners.coincident }
    }
}

/// A walk along the curves.
struct Walk<'w> {
    corners: &'w Corners<'w>,
    /// Flags of the vertices of the mesh that are inside a chain, between its ends.
    walked: Vec<bool>,
    found: Vec<Chain>,
}

impl Walk<'_> {
    /// Adds the chain that begins with the edge from `start` to `next`, unless it has no vertex between its ends.
    fn add(&mut self, start: u32, next: u32) {
        let corners = self.corners;
        let (mut vertices, mut last, mut v) = (vec![start], start, next);
        while v != start && !corners.is_corner(v) {
            self.walked[v as usize] = true;
            vertices.push(v);
            let ends = corners.edges.at(v).iter().map(|&(_, other)| other);
            // Two vertices share at most one edge, so the vertex has another neighbor.
            let Some(next) = ends.into_iter().find(|&other| other != last) else { break };
            (last, v) = (v, next);
        }
        let is_closed = v == start && !corners.is_corner(start);
        if !is_closed {
            vertices.push(v);
        }
        if vertices.len() > 2 {
            let ends = vertices.iter().skip(1).chain(is_closed.then_some(&vertices[0]));
            let edges = vertices.iter().zip(ends);
            let straight = edges.map(|(&a, &b)| corners.is_straight(a, b)).collect();
            self.found.push(Chain { vertices, is_closed, straight, image: None });
        }
    }
}

/// Returns the partners of a chain's vertices, `None` if a vertex between the ends has none.
fn image(corners: &Corners<'_>, chain: &Chain) -> Option<Image> {
    let Chain { vertices: all, is_closed, .. } = chain;
    let (inner, count) = (usize::from(!is_closed), all.len());
    let of = |&v: &u32| corners.partners.of(v).map(|partner| partner.vertex);
    let mut vertices: Vec<u32> = all[inner..count - inner].iter().map(of).collect::<Option<_>>()?;
    let is_coincident = corners.partners.of(all[inner])?.is_coincident;
    if !is_closed {
        // Ends of the other chain: the neighbor nearest to the image of this chain's end under the motion.
        let end = |end: u32, last: u32| {
            let Partner { vertex, motion, .. } = corners.partners.of(last)?;
            let there = |v: &u32| corners.at(*v).distance(motion.at(corners.at(end)));
            let neighbors = corners.edges.at(vertex).iter().map(|&(_, other)| other);
            neighbors.min_by(|a, b| there(a).total_cmp(&there(b)))
        };
        vertices.insert(0, end(all[0], all[1])?);
        vertices.push(end(all[count - 1], all[count - 2])?);
    }
    Some(Image { vertices, is_coincident })
}

/// Assigns partners to each chain. Leaves out chains of partners of an earlier chain, and chains whose partners are on
/// the chain itself.
fn joined(chains: Vec<Chain>, image: impl Fn(&Chain) -> Option<Image>) -> Vec<Chain> {
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
            let other = inner(&image.vertices, chain.is_closed);
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
