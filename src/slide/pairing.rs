//! Finds periodic pairs of vertices from positions on the boundary.

use std::collections::BTreeMap;

use glam::DVec2;

use crate::periodic::{Motion, Periodic};
use crate::slide::options::Slide;
use crate::slide::partners::Partners;
use crate::slide::rigid::Rigid;
use crate::topology::Topology;

/// Direction along which the search sorts vertices, with a length of at most 1. The direction is oblique to the axes
/// and to other usual directions of sides.
const ACROSS: DVec2 = DVec2::new(0.796, 0.605);

impl Slide {
    /// Adds the pairs of boundary vertices of which `motion` maps the first to the position of the second. `points` are
    /// the positions of all vertices. Returns the number of pairs found: 0 if the motion is neither a translation nor a
    /// rotation, or moves no vertex.
    pub fn pair_by(
        &mut self,
        topology: &Topology<'_>,
        points: &[[f64; 2]],
        motion: Motion,
    ) -> usize {
        let Some(boundary) = Boundary::of(topology, points) else { return 0 };
        let Some(rigid) = Rigid::of(motion) else { return 0 };
        let all: Vec<u32> = boundary.next.keys().copied().collect();
        let mut pairs = boundary.pairs(rigid, &all, &all);
        pairs.retain(|[a, b]| a != b);
        let found = pairs.len();
        if found > 0 {
            self.periodic.push(Periodic { pairs, motion: Some(motion) });
        }
        found
    }

    /// Adds the pairs of vertices on two sides of the boundary, by a motion found from the sides. A translation or
    /// rotation must map all vertices of the first side to vertices of the second side. Triangles at the first side
    /// must then lie outside the second side. `points` are the positions of all vertices. Each side may list its
    /// vertices in any order. Vertices inside the mesh are ignored. Returns the number of pairs found, 0 if no such
    /// motion exists, or if `points` does not have one entry per vertex.
    pub fn pair_sides(
        &mut self,
        topology: &Topology<'_>,
        points: &[[f64; 2]],
        sides: [&[u32]; 2],
    ) -> usize {
        let Some(boundary) = Boundary::of(topology, points) else { return 0 };
        let [from, to] = sides.map(|side| boundary.listed(side));
        let [mut ahead, mut back] = [boundary.runs(&from), boundary.runs(&to)];
        if from.len() != to.len() || ahead.is_empty() {
            return 0;
        }
        // Along the other side, the boundary runs in the opposite direction.
        back.iter_mut().for_each(|run| run.reverse());
        let run = ahead.swap_remove(0);
        let matching = back.iter().filter(|other| other.len() == run.len());
        for other in matching {
            let pairs: Vec<[u32; 2]> = run.iter().zip(other).map(|(&a, &b)| [a, b]).collect();
            let placed = |&[a, b]: &[u32; 2]| {
                let edge = boundary.edge(a).min(boundary.edge(b));
                ([boundary.at(a), boundary.at(b)], Partners::AGREE * edge)
            };
            let places: Vec<_> = pairs.iter().map(placed).collect();
            let Some(rigid) = Rigid::of_pairs(None, &places) else { continue };
            let pairs = boundary.pairs(rigid, &from, &to);
            if pairs.len() == from.len() {
                let found = pairs.len();
                self.periodic.push(Periodic { pairs, motion: None });
                return found;
            }
        }
        0
    }
}

/// Positions and order of the boundary vertices of a mesh.
pub(super) struct Boundary<'p> {
    points: &'p [[f64; 2]],
    /// For each vertex, the next vertex along the boundary, with the mesh on the left, and the length of the shorter
    /// edge at the vertex. Where several boundaries meet, the next vertex is on any of them.
    next: BTreeMap<u32, (u32, f64)>,
}

impl<'p> Boundary<'p> {
    /// Returns the boundary of a mesh with these points; `None` unless there is a point for each vertex.
    pub(super) fn of(topology: &Topology<'_>, points: &'p [[f64; 2]]) -> Option<Self> {
        topology.check_count(points).ok()?;
        let mut boundary = Self { points, next: BTreeMap::new() };
        let mut edges = topology.boundary_edges();
        edges.sort_unstable();
        for &[from, to] in &edges {
            let length = boundary.at(from).distance(boundary.at(to));
            boundary.next.insert(from, (to, length));
        }
        for [from, to] in edges {
            let length = boundary.at(from).distance(boundary.at(to));
            if let Some((_, edge)) = boundary.next.get_mut(&to) {
                *edge = edge.min(length);
            }
        }
        Some(boundary)
    }

    pub(super) fn at(&self, vertex: u32) -> DVec2 {
        self.points[vertex as usize].into()
    }

    /// Returns the length of the shorter boundary edge at a vertex, 0 for vertices inside.
    pub(super) fn edge(&self, vertex: u32) -> f64 {
        self.next.get(&vertex).map_or(0.0, |&(_, edge)| edge)
    }

    /// Returns the given vertices that are on the boundary, in ascending order and without repeats.
    fn listed(&self, vertices: &[u32]) -> Vec<u32> {
        let mut listed: Vec<u32> =
            vertices.iter().copied().filter(|v| self.next.contains_key(v)).collect();
        listed.sort_unstable();
        listed.dedup();
        listed
    }

    /// Returns the open runs of consecutive boundary vertices among the given ones, each from end to end. `listed` must
    /// be ascending. Closed runs are left out.
    fn runs(&self, listed: &[u32]) -> Vec<Vec<u32>> {
        let after = |v: u32| {
            let &(next, _) = self.next.get(&v)?;
            listed.binary_search(&next).is_ok().then_some(next)
        };
        let mut has_before: Vec<u32> = listed.iter().filter_map(|&v| after(v)).collect();
        has_before.sort_unstable();
        let starts = listed.iter().filter(|v| has_before.binary_search(v).is_err());
        let run = |&start: &u32| {
            let run = std::iter::successors(Some(start), |&v| after(v));
            run.take(listed.len()).collect()
        };
        starts.map(run).collect()
    }

    /// Returns pairs of a vertex of `from` and the vertex of `to` nearest to its image under the motion, within the
    /// tolerance.
    fn pairs(&self, motion: Rigid, from: &[u32], to: &[u32]) -> Vec<[u32; 2]> {
        let along = |point: DVec2| point.dot(ACROSS);
        let mut sorted: Vec<(f64, u32)> = to.iter().map(|&v| (along(self.at(v)), v)).collect();
        sorted.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let of = |&v: &u32| {
            let there = motion.at(self.at(v));
            let far = Partners::AGREE * self.edge(v);
            let (low, high) = (along(there) - far, along(there) + far);
            let start = sorted.partition_point(|&(way, _)| way < low);
            let near = sorted[start..].iter().take_while(|&&(way, _)| way <= high);
            let distance = |u: &u32| self.at(*u).distance(there);
            let nearest = near.map(|&(_, u)| u).min_by(|a, b| distance(a).total_cmp(&distance(b)));
            nearest.filter(|u| distance(u) <= far).map(|u| [v, u])
        };
        from.iter().filter_map(of).collect()
    }
}
