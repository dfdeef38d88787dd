//! Graph coloring: free vertices that may move at the same time.

use crate::topology::Topology;

/// Independent sets of free vertices: no two of one color share a triangle, so a color can be
/// swept in parallel with the result of any serial order.
#[derive(Clone, Debug)]
pub struct Coloring {
    colors: Vec<u32>,
    count: u32,
}

/// The color of a vertex that is not free.
pub const UNCOLORED: u32 = u32::MAX;

impl Coloring {
    /// Colors the free vertices greedily in smallest-last order (Matula & Beck, J. ACM 30, 1983):
    /// a planar graph then takes 6 colors at most.
    pub fn new(topology: &Topology) -> Self {
        let free = topology.free();
        let graph = Graph::of_free_vertices(topology);
        let mut colors = vec![UNCOLORED; free.len()];
        let mut count = 0;
        for &v in graph.smallest_last_order(free).iter().rev() {
            let taken = graph
                .row(v)
                .iter()
                .map(|&u| colors[u as usize])
                .filter(|&c| c < 64)
                .fold(0u64, |set, c| set | 1 << c);
            // Smallest-last needs at most 6 on a planar graph; a mesh that overlaps itself may need
            // more, but 64 would take a vertex of degree 64 in a core of such vertices.
            let mut color = (!taken).trailing_zeros();
            while graph.row(v).iter().any(|&u| colors[u as usize] == color) {
                color += 1;
            }
            colors[v as usize] = color;
            count = count.max(color + 1);
        }
        Self { colors, count }
    }

    /// Number of colors.
    pub fn count(&self) -> u32 {
        self.count
    }

    /// Color of each vertex, [`UNCOLORED`] if it is not free.
    pub fn colors(&self) -> &[u32] {
        &self.colors
    }

    /// Whether every free vertex, and no other, has a color unlike those of its neighbors.
    pub fn is_proper(&self, topology: &Topology) -> bool {
        let differs = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| self.colors[v as usize]);
            let same = |p: u32, q: u32| p == q && p != UNCOLORED;
            !same(a, b) && !same(b, c) && !same(c, a)
        };
        let complete = self.colors.iter().zip(topology.free());
        complete.into_iter().all(|(&c, &free)| free == (c < self.count))
            && topology.triangles().iter().all(differs)
    }
}

/// Free vertices joined by edges, as compressed rows.
struct Graph {
    start: Vec<u32>,
    neighbors: Vec<u32>,
}

impl Graph {
    fn of_free_vertices(topology: &Topology) -> Self {
        let free = topology.free();
        let mut start = Vec::with_capacity(free.len() + 1);
        let mut neighbors = Vec::with_capacity(free.len() * 6);
        start.push(0);
        for v in 0..free.len() as u32 {
            if free[v as usize] {
                // Around an interior vertex each neighbor follows it in exactly one triangle.
                for &t in topology.star(v) {
                    let corners = topology.triangles()[t as usize];
                    let i = corners.iter().position(|&u| u == v).unwrap_or(0);
                    let next = corners[(i + 1) % 3];
                    if free[next as usize] {
                        neighbors.push(next);
                    }
                }
            }
            start.push(neighbors.len() as u32);
        }
        Self { start, neighbors }
    }

    fn row(&self, v: u32) -> &[u32] {
        &self.neighbors[self.start[v as usize] as usize..self.start[v as usize + 1] as usize]
    }

    /// Removes a vertex of least remaining degree again and again; the order of removal.
    fn smallest_last_order(&self, free: &[bool]) -> Vec<u32> {
        let mut degree: Vec<u32> =
            (0..free.len() as u32).map(|v| self.row(v).len() as u32).collect();
        let most = degree.iter().copied().max().unwrap_or(0) as usize;
        let mut buckets = vec![Vec::new(); most + 1];
        for v in (0..free.len()).rev().filter(|&v| free[v]) {
            buckets[degree[v] as usize].push(v as u32);
        }
        let mut order = Vec::new();
        let mut removed = vec![false; free.len()];
        let mut least = 0;
        while least <= most {
            let Some(v) = buckets[least].pop() else {
                least += 1;
                continue;
            };
            // A vertex stands in one bucket per degree it has had; only the last entry counts.
            if removed[v as usize] || degree[v as usize] as usize != least {
                continue;
            }
            removed[v as usize] = true;
            order.push(v);
            for &u in self.row(v) {
                if !removed[u as usize] {
                    degree[u as usize] -= 1;
                    buckets[degree[u as usize] as usize].push(u);
                }
            }
            least = least.saturating_sub(1);
        }
        order
    }
}
