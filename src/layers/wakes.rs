//! Wakes: lines of stretched elements that continue a wall behind a sharp edge, as in C-grids.

use crate::layers::march::Rows;
use crate::layers::sectors::{NONE, Sectors};
use crate::layers::vector::{cross, dot, length, minus};
use crate::parallel::counting_sort::Groups;

/// Angle of the fluid at an edge of the wall behind which a wake may begin, in degrees.
const SHARP: f64 = 240.0;

/// Largest turn of a wake against the wall, and from edge to edge, in degrees.
const FIRST_TURN: f64 = 60.0;
const TURN: f64 = 30.0;

/// Least length of the first edge in heights of the first row, least stretching of elements, and number of edges.
const LENGTH: f64 = 2.0;
const STRETCHING: f64 = 2.0;
const EDGES: usize = 5;

/// Returns the edges of wakes, as pairs of vertices.
pub(super) fn wakes(sectors: &Sectors, rows: &Rows, kept: &[bool]) -> Vec<[u32; 2]> {
    let mut edges = Vec::new();
    let mut stretched = vec![NONE; sectors.len()];
    let starts =
        rows.lists[0].iter().filter(|n| sectors.fluid[**n as usize] >= SHARP && kept[**n as usize]);
    let mut wakes: Vec<Vec<u32>> = Vec::new();
    let mut elements = None;
    for &start in starts {
        let elements = elements.get_or_insert_with(|| Edges::new(sectors));
        let height =
            rows.lists.get(1).into_iter().flatten().filter(|n| rows.parent[**n as usize] == start);
        let height = height.map(|&n| rows.height[n as usize]).fold(f64::INFINITY, f64::min);
        let from =
            sectors.wall[start as usize].map(|n| minus(sectors.point(start), sectors.point(n)));
        let first = from
            .into_iter()
            .filter_map(|along| elements.next(start, along, FIRST_TURN))
            .filter(|n| length(minus(sectors.point(*n), sectors.point(start))) >= LENGTH * height)
            .min();
        let Some(mut to) = first else { continue };
        let mut wake = vec![start, to];
        stretched[start as usize] = start;
        while !sectors.is_wall(to) && stretched[to as usize] != start {
            stretched[to as usize] = start;
            let along = minus(sectors.point(to), sectors.point(wake[wake.len() - 2]));
            let Some(next) = elements.next(to, along, TURN) else { break };
            wake.push(next);
            to = next;
        }
        if wake.len() > EDGES {
            wakes.push(wake);
        }
    }
    for wake in wakes {
        edges.extend(
            wake.windows(2).map(|w| [sectors.vertex[w[0] as usize], sectors.vertex[w[1] as usize]]),
        );
    }
    edges
}

/// The elements of a mesh at the edges of wakes.
struct Edges<'s> {
    sectors: &'s Sectors,
    /// The half-edges that begin at each node.
    leaving: Groups,
}

impl<'s> Edges<'s> {
    fn new(sectors: &'s Sectors) -> Self {
        let nodes = &sectors.corners;
        Self { sectors, leaving: Groups::new(nodes.len(), sectors.len(), |h| [nodes[h]]) }
    }

    /// Returns the neighbor of a node in the direction that is the nearest to `along`, at a turn of at most `turn` degrees,
    /// with stretched elements on both sides of the edge.
    fn next(&self, node: u32, along: [f64; 2], turn: f64) -> Option<u32> {
        let sectors = self.sectors;
        let edge = |n: u32| minus(sectors.point(n), sectors.point(node));
        let cosine = |n: u32| dot(edge(n), along) / (length(edge(n)) * length(along));
        let fits = |n: &u32| {
            !sectors.wall[node as usize].contains(n) && cosine(*n) > turn.to_radians().cos()
        };
        let inner = sectors.neighbors(node).iter().copied().filter(fits);
        let best = inner.max_by(|a, b| cosine(*a).total_cmp(&cosine(*b)))?;
        (self.is_stretched(node, best) && self.is_stretched(best, node)).then_some(best)
    }

    /// Returns whether the element on the left of an edge from a node to another is stretched along the edge.
    fn is_stretched(&self, node: u32, other: u32) -> bool {
        let Sectors { corners, next, .. } = self.sectors;
        let edge = minus(self.sectors.point(other), self.sectors.point(node));
        let size = length(edge);
        let following = |h: &u32| Some(next[*h as usize]);
        let leads = |h: &&u32| corners[next[**h as usize] as usize] == other;
        self.leaving.of(node as usize).iter().find(leads).is_some_and(|&h| {
            // The corners of the element that are not on the edge.
            let beyond = std::iter::successors(Some(h), following).skip(2);
            let heights = beyond.take_while(|&corner| corner != h).map(|corner| {
                let from = self.sectors.point(node);
                cross(edge, minus(self.sectors.point(corners[corner as usize]), from)) / size
            });
            STRETCHING * heights.fold(f64::INFINITY, f64::min) <= size
        })
    }
}
