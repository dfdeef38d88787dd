//! The edges of curves: those of the boundary and of lines.

use crate::slide::options::Slide;
use crate::topology::Topology;

/// Edges of curves as (start, end), in both directions, in ascending order.
pub(crate) struct Edges {
    pub(crate) all: Vec<(u32, u32)>,
    /// Edges of the given lines, boundary edges included.
    of_lines: Vec<(u32, u32)>,
}

impl Edges {
    pub(crate) fn of(topology: &Topology<'_>, slide: &Slide) -> Self {
        let is_edge = |&[a, b]: &[u32; 2]| {
            let has_both = |&t: &u32| topology.corners()[t as usize].contains(&b);
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

    pub(crate) fn is_of_lines(&self, edge: &(u32, u32)) -> bool {
        self.of_lines.binary_search(edge).is_ok()
    }

    /// Returns the edges that start at a vertex.
    pub(crate) fn at(&self, v: u32) -> &[(u32, u32)] {
        let start = self.all.partition_point(|&(from, _)| from < v);
        let count = self.all[start..].iter().take_while(|&&(from, _)| from == v).count();
        &self.all[start..start + count]
    }
}
