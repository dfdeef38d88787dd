//! Graph coloring: free vertices of equal color can move at the same time.

use std::ops::Range;
use std::sync::atomic::Ordering::Relaxed;

use crate::layout::smallest_last::{Degrees, Graph, UNCOLORED};
use crate::parallel::counting_sort::{atomics, plain};
use crate::parallel::{collect, for_each_part, map_parts, map_ranges};
use crate::topology::Topology;

/// A coloring of the free vertices. No two vertices of equal color share an element, so all vertices of a color can be
/// visited in parallel, with the same result as in any serial order.
#[derive(Clone, Debug)]
pub struct Coloring {
    colors: Vec<u32>,
    count: u32,
}

/// Number of consecutive vertices along the curve that form a block. Indices within a block fit 16 bits.
const BLOCK: usize = 1 << 15;

/// Least ratio of all vertices to vertices with neighbors in several blocks. Below this ratio, vertices are colored
/// serially instead of in blocks.
const MOST_BETWEEN: usize = 4;

/// Largest number of colors that the smallest-last order needs on a planar graph.
const PLANAR: u32 = 6;
/// Largest number of colors that the order needs if vertices across a quadrilateral count as neighbors. Such a graph is
/// 1-planar and has a vertex of at most 7 neighbors (Pach & Tóth, Combinatorica 17, 1997).
const ONE_PLANAR: u32 = 8;

impl Coloring {
    /// Colors the free vertices greedily in smallest-last order (Matula & Beck, J. ACM 30, 1983), which takes at most 6
    /// colors on triangles, and 8 on meshes with quadrilaterals.
    ///
    /// Blocks of vertices with consecutive indices in the mesh are colored in parallel, after the vertices that have
    /// neighbors in several blocks.
    pub fn new(topology: &Topology<'_>) -> Self {
        let numbering: Vec<u32> = (0..topology.free().len() as u32).collect();
        Self::in_blocks(topology, &numbering, BLOCK)
    }

    /// Colors the free vertices as [`Self::new`] does, but in blocks along a curve that contains every free vertex.
    /// Faster than [`Self::new`] if most mesh neighbors are also close along the curve.
    pub(crate) fn along(topology: &Topology<'_>, curve: &[u32]) -> Self {
        match curve.len() {
            // A single block does not need the curve: [`Self::new`] colors the block by vertex indices alone.
            0..=BLOCK => Self::new(topology),
            _ => Self::in_blocks(topology, curve, BLOCK),
        }
    }

    /// Colors the free vertices along a curve, in blocks of `block` vertices.
    fn in_blocks(topology: &Topology<'_>, curve: &[u32], block: usize) -> Self {
        let places = Places::new(topology, curve);
        let (colors, count) = match curve.len() <= block {
            true => places.color_serially(),
            false => places.color(block),
        };
        let of = &places.of;
        let color = |v: usize| colors.get(of[v] as usize).copied().unwrap_or(UNCOLORED);
        Self { colors: collect(of.len(), color), count }
    }

    /// Returns the number of colors.
    pub fn count(&self) -> u32 {
        self.count
    }

    /// Returns the color of each vertex of the mesh, [`UNCOLORED`] if the vertex is not free.
    pub fn colors(&self) -> &[u32] {
        &self.colors
    }

    /// Returns whether every free vertex has a color that differs from its neighbors' colors, and no other vertex has a
    /// color.
    pub fn is_proper(&self, topology: &Topology<'_>) -> bool {
        let differs = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| self.colors[v as usize]);
            let same = |p: u32, q: u32| p == q && p != UNCOLORED;
            !same(a, b) && !same(b, c) && !same(c, a)
        };
        let differ_across = |[a, b, c, d]: [u32; 4]| {
            differs(&[a, b, c]) && differs(&[a, c, d]) && differs(&[a, b, d])
        };
        let is_complete = |(&color, &free): (&u32, &bool)| free == (color < self.count);
        // The coloring may be of another mesh, with another number of vertices.
        self.colors.len() == topology.free().len()
            && self.colors.iter().zip(topology.free()).all(is_complete)
            && topology.triangles().iter().all(differs)
            && topology.quadrilaterals().all(differ_across)
    }
}

/// Marker for vertices without a place: fixed and boundary vertices.
const NO_PLACE: u32 = u32::MAX;

/// Places of the free vertices on a curve. A place is a 0-based index in `curve`.
struct Places<'a> {
    topology: &'a Topology<'a>,
    curve: &'a [u32],
    /// Place of each free vertex on the curve, [`NO_PLACE`] for all other vertices of the mesh.
    of: Vec<u32>,
}

impl<'a> Places<'a> {
    fn new(topology: &'a Topology<'a>, curve: &'a [u32]) -> Self {
        let free = topology.free();
        let of = atomics(free.len(), NO_PLACE);
        const CHUNK: usize = 1 << 12;
        for_each_part(curve.chunks(CHUNK), |chunk, vertices| {
            for (&v, place) in vertices.iter().zip(chunk * CHUNK..) {
                if free[v as usize] {
                    of[v as usize].store(place as u32, Relaxed);
                }
            }
        });
        Self { topology, curve, of: plain(of) }
    }

    fn is_free(&self, place: u32) -> bool {
        self.topology.free()[self.curve[place as usize] as usize]
    }

    /// Returns the places of the free vertices that share an element with the free vertex at `place`: those along edges
    /// first, counter-clockwise.
    fn neighbors(&self, place: u32) -> impl Iterator<Item = u32> + '_ {
        let vertex = self.curve[place as usize];
        let corners = self.topology.corner_list();
        let star = match corners.quadrilateral_count() {
            0 => &[],
            _ => self.topology.star(vertex),
        };
        let opposite = star.iter().filter_map(|&corner| corners.opposite(corner));
        let all = self.topology.ring_of(vertex).chain(opposite);
        all.map(|v| self.of[v as usize]).filter(|&place| place != NO_PLACE)
    }

    /// Returns the places of the free vertices that share an element with the vertex, in ascending order of the elements.
    fn sorted_neighbors(&self, place: u32) -> impl Iterator<Item = u32> + '_ {
        let vertex = self.curve[place as usize];
        let star = self.topology.star(vertex).iter();
        let mut ring: Vec<(u32, u32)> = star.copied().zip(self.topology.ring_of(vertex)).collect();
        ring.sort_unstable();
        let corners = self.topology.corner_list();
        let around = ring.into_iter().flat_map(|(c, v)| [v].into_iter().chain(corners.opposite(c)));
        around.map(|v| self.of[v as usize]).filter(|&place| place != NO_PLACE)
    }

    /// Returns the largest number of colors that the smallest-last order needs on the mesh.
    fn most_colors(&self) -> u32 {
        match self.topology.corner_list().quadrilateral_count() {
            0 => PLANAR,
            _ => ONE_PLANAR,
        }
    }

    /// Colors the vertices between blocks, then the inner vertices of each block in parallel. Returns the colors,
    /// indexed by place, and the color count.
    fn color(&self, block: usize) -> (Vec<u32>, u32) {
        let blocks = map_ranges(self.curve.len(), block, |places| {
            Block::new(self, places, &mut Degrees::default())
        });
        let first = (0..).step_by(block);
        let between: Vec<u32> = first
            .zip(&blocks)
            .flat_map(|(first, block)| block.border.iter().map(move |v| first + v))
            .collect();
        if between.len() > self.curve.len() / MOST_BETWEEN {
            return self.color_serially();
        }
        let (mut colors, count) = self.color_alone(&between);
        let counts = map_parts(colors.chunks_mut(block).zip(&blocks), |_, (colors, block)| {
            let count = block.graph.color(&block.order, colors);
            block.graph.save_colors(&block.order, count, colors)
        });
        let count = count.max(counts.into_iter().max().unwrap_or(0));
        // Vertices between blocks are colored first, so a vertex of a block may have more colored neighbors than the order
        // provides for, and the coloring may take more colors.
        if count <= self.most_colors() {
            return (colors, count);
        }
        let (serial, serial_count) = self.color_serially();
        if serial_count < count { (serial, serial_count) } else { (colors, count) }
    }

    /// Colors all free vertices as one graph. Returns the colors, indexed by place, and the color count.
    fn color_serially(&self) -> (Vec<u32>, u32) {
        let all: Vec<u32> = (0..self.curve.len() as u32).filter(|&p| self.is_free(p)).collect();
        self.color_alone(&all)
    }

    /// Colors the vertices at the given places and ignores all edges to other vertices. Returns the colors, indexed by
    /// place ([`UNCOLORED`] where no vertex was given), and the color count.
    fn color_alone(&self, places: &[u32]) -> (Vec<u32>, u32) {
        let mut index = vec![0u32; self.curve.len()];
        for (i, &place) in (1u32..).zip(places) {
            index[place as usize] = i;
        }
        let mut graph = Graph::with_capacity(places.len());
        for &place in places {
            let index = self.sorted_neighbors(place).map(|p| index[p as usize]).filter(|&i| i > 0);
            graph.push(index.map(|i| i - 1));
        }
        let mut degrees = Degrees::default();
        (0..places.len() as u32).for_each(|v| degrees.put(Some(graph.row(v).len() as u32)));
        let order = graph.smallest_last_order(&mut degrees);
        let mut found = vec![UNCOLORED; places.len()];
        let count = graph.color(&order, &mut found);
        let mut colors = vec![UNCOLORED; self.curve.len()];
        for (&place, color) in places.iter().zip(found) {
            colors[place as usize] = color;
        }
        (colors, count)
    }
}

/// Consecutive vertices along a curve, indexed from 0 within the block.
struct Block {
    /// Neighbors of the inner vertices, whose neighbors are all in the block.
    graph: Graph<u16>,
    /// The inner vertices, in the order of removal; see [`Graph::smallest_last_order`].
    order: Vec<u32>,
    /// The other free vertices of the block, with a neighbor in another block.
    border: Vec<u32>,
}

impl Block {
    fn new(places: &Places<'_>, range: Range<usize>, degrees: &mut Degrees) -> Self {
        let (first, length) = (range.start as u32, range.len() as u32);
        let mut graph = Graph::with_capacity(range.len());
        let mut border = Vec::new();
        for v in 0..length {
            if !places.is_free(first + v) {
                graph.push([].into_iter());
                degrees.put(None);
                continue;
            }
            let mut is_inside = true;
            let neighbors = places.neighbors(first + v).map(|place| {
                let neighbor = place.wrapping_sub(first);
                is_inside &= neighbor < length;
                neighbor as u16
            });
            graph.push(neighbors);
            if is_inside {
                degrees.put(Some(graph.row(v).len() as u32));
            } else {
                graph.clear_last();
                degrees.put(None);
                border.push(v);
            }
        }
        let order = graph.smallest_last_order(degrees);
        Self { graph, order, border }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Mesh;

    /// Returns a grid of squares, each cut by a diagonal, so that vertices have 4 to 8 neighbors.
    fn squares(side: u32) -> Topology<'static> {
        let points = (0..(side + 1).pow(2)).map(|v| [v % (side + 1), v / (side + 1)]);
        let triangles = (0..side * side).flat_map(|square| {
            let a = square / side * (side + 1) + square % side;
            let [b, c, d] = [a + 1, a + side + 2, a + side + 1];
            match square.wrapping_mul(0x9e37_79b1) >> 30 {
                0 => [[a, b, d], [b, c, d]],
                _ => [[a, b, c], [a, c, d]],
            }
        });
        let points = points.map(|p| p.map(f64::from)).collect();
        let mesh = Mesh { points, triangles: triangles.collect(), ..Mesh::default() };
        Topology::new(&mesh).unwrap().into_owned()
    }

    /// Returns the vertices of [`squares`] tile by tile.
    fn tiles(side: u32, tile: u32) -> Vec<u32> {
        let mut curve: Vec<u32> = (0..(side + 1).pow(2)).collect();
        curve.sort_by_key(|&v| (v / (side + 1) / tile, v % (side + 1) / tile));
        curve
    }

    #[test]
    fn blocks_are_proper_take_one_more_color_at_most_and_do_not_depend_on_threads() {
        let topology = squares(100);
        for (curve, name) in [(tiles(100, 1000), "rows"), (tiles(100, 16), "tiles")] {
            let whole = Coloring::in_blocks(&topology, &curve, curve.len());
            for block in [1, 7, 256, 1000, 10_200] {
                let blocks = |threads: usize| {
                    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
                    pool.unwrap().install(|| Coloring::in_blocks(&topology, &curve, block))
                };
                let found = blocks(1);
                assert!(found.is_proper(&topology), "{name}, {block}");
                let (found_count, most) = (found.count(), PLANAR.min(whole.count() + 1));
                assert!(found_count <= most, "{name}, {block}: {found_count} for {most}");
                for threads in [2, 3] {
                    let again = blocks(threads);
                    assert_eq!((again.count, again.colors), (found.count, found.colors.clone()));
                }
            }
        }
    }

    #[test]
    fn no_color_stays_empty() {
        let topology = squares(60);
        let found = Coloring::in_blocks(&topology, &tiles(60, 8), 64);
        for color in 0..found.count() {
            assert!(found.colors().contains(&color), "color {color} of {}", found.count());
        }
    }

    #[test]
    fn a_mesh_that_is_not_planar_takes_more_than_six_colors() {
        // The torus with seven vertices, each of them a neighbor of all others.
        let around = (0..7).flat_map(|i| [[i, i + 1, i + 3], [i, i + 3, i + 2]]);
        let triangles = around.map(|t| t.map(|v| v % 7)).collect();
        let points = (0..7).map(|i| [f64::from(i), f64::from(i * i)]).collect();
        let mesh = Mesh { points, triangles, ..Mesh::default() };
        let topology = Topology::new(&mesh).unwrap();
        assert_eq!(topology.free_count(), 7);
        let curve: Vec<u32> = (0..7).collect();
        for block in [1, 2, 7] {
            let found = Coloring::in_blocks(&topology, &curve, block);
            assert!(found.is_proper(&topology));
            assert_eq!(found.count(), 7);
        }
    }
}
