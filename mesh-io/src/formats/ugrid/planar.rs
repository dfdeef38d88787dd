//! Finds the cells of a plane net of edges, as MeshKernel and Delft3D FM do.
//!
//! The rules are those of `Mesh2D::FindFaces` of MeshKernel 8 (Deltares). At each node, edges are sorted counterclockwise
//! from the first edge in the file. A walk turns into the next edge clockwise at each node, so it keeps a cell on its
//! left side. Walks of three edges start first, from every node in order, then those of four to six edges.

use std::f64::consts::{PI, TAU};

/// Largest number of edges of a cell.
const MAX_EDGES: usize = 6;
/// Largest number of searches for cells. Nets have few edges inside of cells, and two searches find all cells.
const MAX_PASSES: usize = 16;
/// Distance along an axis below which MeshKernel takes two nodes for one, whose edge has no angle.
const MIN_DISTANCE: f64 = 1e-14;
/// Marks the absence of a cell or of a following half-edge.
const NONE: u32 = u32::MAX;

/// A net of edges in the plane.
pub(super) struct Net<'n> {
    /// x and y of each node.
    pub(super) points: &'n [[f64; 2]],
    /// The indices of the two nodes of each edge. There are fewer than 2^31 edges.
    pub(super) edges: &'n [[u32; 2]],
    /// Whether coordinates are longitudes and latitudes, whose edges may cross the date line.
    pub(super) is_in_degrees: bool,
}

/// The cells of a net.
#[derive(Default)]
pub(super) struct NetCells {
    /// The indices of the nodes of all cells, cell by cell, counterclockwise.
    pub(super) nodes: Vec<u32>,
    /// Exclusive end of each cell's nodes in `nodes`. Triangles come first, then cells of four to six edges.
    pub(super) ends: Vec<usize>,
    /// The indices of edges at no cell, ascending. Repeated edges, and edges from a node to itself, are left out.
    pub(super) lines: Vec<u32>,
    /// The first cell and the second cell at each edge; [`NONE`] without one.
    of_edges: Vec<[u32; 2]>,
}

impl NetCells {
    /// Returns the number of cells of four to six edges with a triangle at each edge. Each may be an island.
    pub(super) fn cells_among_triangles(&self) -> usize {
        let corners =
            |cell: usize| self.ends[cell] - if cell == 0 { 0 } else { self.ends[cell - 1] };
        let is_triangle = |cell: u32| cell != NONE && corners(cell as usize) == 3;
        let mut triangles = vec![0; self.ends.len()];
        for &[one, two] in &self.of_edges {
            for (own, other) in [(one, two), (two, one)] {
                if own != NONE && is_triangle(other) {
                    triangles[own as usize] += 1;
                }
            }
        }
        let is_among = |&(cell, &count): &(usize, &usize)| count > 3 && count == corners(cell);
        triangles.iter().enumerate().filter(is_among).count()
    }
}

impl Net<'_> {
    /// Returns the cells of three to six edges. `is_side` tells whether an edge may bound a cell.
    pub(super) fn cells(&self, is_side: impl Fn(usize) -> bool) -> NetCells {
        let edges = self.distinct_edges(&is_side);
        let mut sides = edges.clone();
        sides.retain(|&edge| is_side(edge as usize));
        // Edges at no cell may end inside a cell, which walks then do not find. MeshKernel removes such edges and searches
        // again.
        let mut found = self.cells_between(&sides);
        for _ in 1..MAX_PASSES {
            let before = sides.len();
            sides.retain(|&edge| found.of_edges[edge as usize][0] != NONE);
            if sides.len() == before {
                break;
            }
            found = self.cells_between(&sides);
        }
        let is_line = |edge: &u32| found.of_edges[*edge as usize][0] == NONE;
        let lines = edges.into_iter().filter(is_line).collect();
        NetCells { lines, ..found }
    }

    /// Returns the cells that walks along some edges find.
    fn cells_between(&self, sides: &[u32]) -> NetCells {
        let stars = self.stars(sides);
        let next = self.next_half_edges(&stars);
        let of_edges = vec![[NONE; 2]; self.edges.len()];
        let found = NetCells { of_edges, ..NetCells::default() };
        let mut walk = Walk { net: self, next: &next, found };
        for count in 3..=MAX_EDGES {
            for star in stars.iter() {
                star.iter().for_each(|&half_edge| walk.from(half_edge, count));
            }
        }
        walk.found
    }

    /// Returns the indices of the edges, ascending, without repeated edges and edges from a node to itself.
    fn distinct_edges(&self, is_side: impl Fn(usize) -> bool) -> Vec<u32> {
        let mut edges: Vec<u32> = (0..self.edges.len() as u32).collect();
        let ends = |edge: u32| {
            let [a, b] = self.edges[edge as usize];
            [a.min(b), a.max(b)]
        };
        edges.sort_by_key(|&edge| (ends(edge), !is_side(edge as usize)));
        edges.dedup_by_key(|edge| ends(*edge));
        edges.retain(|&edge| ends(edge)[0] != ends(edge)[1]);
        edges.sort_unstable();
        edges
    }

    /// Returns the half-edges of some edges that leave each node, counterclockwise from the one of the first edge.
    /// Half-edge `2 e + d` leads from node `edges[e][d]` to the other node of edge `e`.
    fn stars(&self, sides: &[u32]) -> Stars {
        let mut ends = vec![0_usize; self.points.len() + 1];
        for &edge in sides {
            self.edges[edge as usize].iter().for_each(|&node| ends[node as usize + 1] += 1);
        }
        for node in 0..self.points.len() {
            ends[node + 1] += ends[node];
        }
        let mut at = ends.clone();
        let mut half_edges = vec![0; 2 * sides.len()];
        for &edge in sides {
            for (direction, &node) in (0..).zip(&self.edges[edge as usize]) {
                half_edges[at[node as usize]] = 2 * edge + direction;
                at[node as usize] += 1;
            }
        }
        for pair in ends.windows(2) {
            let star = &mut half_edges[pair[0]..pair[1]];
            let Some(&first) = star.first() else { continue };
            let start = self.angle(first);
            star.sort_by_cached_key(|&half_edge| {
                let angle = self.angle(half_edge) - start;
                Angle(if angle < 0.0 { angle + TAU } else { angle })
            });
        }
        Stars { half_edges, ends }
    }

    /// Returns the half-edge that follows each half-edge in a walk.
    fn next_half_edges(&self, stars: &Stars) -> Vec<u32> {
        let mut next = vec![NONE; 2 * self.edges.len()];
        for star in stars.iter() {
            for (place, &leaving) in star.iter().enumerate() {
                // The same edge in the other direction arrives at the node.
                next[(leaving ^ 1) as usize] = star[(place + star.len() - 1) % star.len()];
            }
        }
        next
    }

    fn origin(&self, half_edge: u32) -> u32 {
        self.edges[(half_edge / 2) as usize][(half_edge % 2) as usize]
    }

    /// Returns the difference from one node to another, the shorter way around the globe for longitudes.
    fn difference(&self, from: u32, to: u32) -> [f64; 2] {
        let [a, b] = [from, to].map(|node| self.points[node as usize]);
        let [x, y] = [b[0] - a[0], b[1] - a[1]];
        match self.is_in_degrees {
            true => [x - 360.0 * (x / 360.0).round(), y],
            false => [x, y],
        }
    }

    fn angle(&self, half_edge: u32) -> f64 {
        let [x, y] = self.difference(self.origin(half_edge), self.origin(half_edge ^ 1));
        match x.abs() < MIN_DISTANCE && y.abs() < MIN_DISTANCE {
            true => PI / if y < 0.0 { -2.0 } else { 2.0 },
            false => y.atan2(x),
        }
    }

    /// Returns whether nodes wind counterclockwise around a positive area.
    fn is_counterclockwise(&self, nodes: &[u32]) -> bool {
        let corners = nodes[1..].windows(2).map(|pair| {
            let [[a, b], [c, d]] = [0, 1].map(|k| self.difference(nodes[0], pair[k]));
            a * d - b * c
        });
        corners.sum::<f64>() > 0.0
    }
}

/// Half-edges around each node.
struct Stars {
    half_edges: Vec<u32>,
    /// Start of each node's half-edges, and the end of the last one's.
    ends: Vec<usize>,
}

impl Stars {
    fn iter(&self) -> impl Iterator<Item = &[u32]> {
        self.ends.windows(2).map(|pair| &self.half_edges[pair[0]..pair[1]])
    }
}

/// An angle that sorts by its value.
#[derive(PartialEq)]
struct Angle(f64);

impl Eq for Angle {}

impl Ord for Angle {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0)
    }
}

impl PartialOrd for Angle {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

/// Walks along edges, and the cells found so far.
struct Walk<'w> {
    net: &'w Net<'w>,
    /// The half-edge that follows each half-edge.
    next: &'w [u32],
    found: NetCells,
}

impl Walk<'_> {
    /// Adds the cell of `count` edges on the left side of a half-edge, if there is one and it was not found before.
    fn from(&mut self, start: u32, count: usize) {
        let (mut nodes, mut edges) = ([0; MAX_EDGES], [0; MAX_EDGES]);
        let mut half_edge = start;
        for place in 0..count {
            let edge = half_edge / 2;
            if self.found.of_edges[edge as usize][1] != NONE {
                return;
            }
            (nodes[place], edges[place]) = (self.net.origin(half_edge), edge);
            half_edge = self.next[half_edge as usize];
        }
        let (nodes, edges) = (&nodes[..count], &edges[..count]);
        if self.net.origin(half_edge) == nodes[0] {
            self.add(nodes, edges);
        }
    }

    /// Adds a cell unless it has a node twice, winds clockwise or was found before.
    fn add(&mut self, nodes: &[u32], edges: &[u32]) {
        let is_repeated = |list: &[u32]| (1..list.len()).any(|k| list[..k].contains(&list[k]));
        let mut first = [NONE; MAX_EDGES];
        for (first, &edge) in first.iter_mut().zip(edges) {
            *first = self.found.of_edges[edge as usize][0];
        }
        let first = &first[..edges.len()];
        // A cell that was found before is the first cell of several of its edges.
        let is_known = !first.contains(&NONE) && is_repeated(first);
        if is_known || is_repeated(nodes) || !self.net.is_counterclockwise(nodes) {
            return;
        }
        let cell = self.found.ends.len() as u32;
        for &edge in edges {
            let cells = &mut self.found.of_edges[edge as usize];
            cells[usize::from(cells[0] != NONE)] = cell;
        }
        self.found.nodes.extend_from_slice(nodes);
        self.found.ends.push(self.found.nodes.len());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cells(points: &[[f64; 2]], edges: &[[u32; 2]]) -> (Vec<Vec<u32>>, NetCells) {
        let found = Net { points, edges, is_in_degrees: false }.cells(|_| true);
        let starts = std::iter::once(&0).chain(&found.ends);
        let each = starts.zip(&found.ends).map(|(&start, &end)| found.nodes[start..end].to_vec());
        (each.collect(), found)
    }

    /// A square around a smaller square turned by 45 degrees, with a triangle at each edge of either.
    const RING: [[f64; 2]; 8] = [
        [0.0, 0.0],
        [4.0, 0.0],
        [4.0, 4.0],
        [0.0, 4.0],
        [2.0, 1.0],
        [3.0, 2.0],
        [2.0, 3.0],
        [1.0, 2.0],
    ];
    const RING_EDGES: [[u32; 2]; 16] = [
        [0, 1],
        [1, 2],
        [2, 3],
        [3, 0],
        [4, 5],
        [6, 5],
        [6, 7],
        [7, 4],
        [0, 4],
        [1, 4],
        [1, 5],
        [2, 5],
        [2, 6],
        [3, 6],
        [3, 7],
        [0, 7],
    ];

    #[test]
    fn a_ring_of_four_edges_among_triangles_is_a_cell() {
        let (cells, found) = cells(&RING, &RING_EDGES);
        assert_eq!(cells.len(), 9);
        assert!(cells[..8].iter().all(|cell| cell.len() == 3));
        assert_eq!((&cells[8][..], found.cells_among_triangles()), (&[4, 5, 6, 7][..], 1));
        assert_eq!(found.lines, [0; 0]);
    }

    #[test]
    fn repeated_and_loose_edges_bound_no_cell() {
        let extra = [[5, 4], [3, 3], [4, 6]];
        let points = [&RING[..], &[[9.0, 9.0]]].concat();
        let edges = [&RING_EDGES[..], &extra[..2], &[[2, 8]]].concat();
        let (all, found) = cells(&points, &edges);
        assert_eq!(all.len(), 9);
        assert_eq!(found.lines, [18]);
        // An edge across the inner square divides it.
        let (all, found) = cells(&RING, &[&RING_EDGES[..], &extra[2..]].concat());
        assert!(all.len() == 10 && all.iter().all(|cell| cell.len() == 3));
        assert_eq!(found.cells_among_triangles(), 0);
    }

    #[test]
    fn a_hole_of_seven_edges_is_no_cell() {
        let ring = |radius: f64| {
            (0..7).map(move |k| {
                let (sin, cos) = (TAU * f64::from(k) / 7.0).sin_cos();
                [radius * cos, radius * sin]
            })
        };
        let points: Vec<[f64; 2]> = ring(1.0).chain(ring(2.0)).collect();
        let around = (0..7).flat_map(|k| {
            let next = (k + 1) % 7;
            [[k, next], [k + 7, next + 7], [k, k + 7]]
        });
        let (cells, _) = cells(&points, &around.collect::<Vec<_>>());
        assert!(cells.len() == 7 && cells.iter().all(|cell| cell.len() == 4));
    }

    #[test]
    fn edges_across_the_date_line_bound_cells() {
        let points = [[179.5, 0.0], [-179.5, 0.0], [-179.5, 1.0], [179.5, 1.0]];
        let edges = [[0, 1], [1, 2], [2, 3], [3, 0], [0, 2]];
        let found = Net { points: &points, edges: &edges, is_in_degrees: true }.cells(|_| true);
        assert_eq!(found.nodes, [0, 1, 2, 0, 2, 3]);
    }
}
