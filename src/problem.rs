//! What both engines are given: normalized positions and one-rings, numbered color by color.

use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering};

use glam::DVec2;
use rayon::prelude::*;

use crate::coloring::{Coloring, UNCOLORED};
use crate::mesh::Mesh;
use crate::topology::Topology;

/// A mesh laid out for sweeping. Vertices are numbered anew: free ones first, color by color, in
/// blocks along a space-filling curve within a color and by the number of their neighbors within a
/// block, then those fixed ones that some triangle uses.
///
/// Positions are centered and scaled by a power of two (which rounds nothing) such that the mean
/// triangle has an area in [0.5, 2): then single precision serves meshes of any size at any place,
/// and areas of triangles far smaller or larger than the mean neither vanish nor overflow.
#[derive(Clone, Debug)]
pub struct Problem {
    positions: Vec<DVec2>,
    colors: Vec<Range<u32>>,
    ring_start: Vec<u32>,
    ring: Vec<u32>,
    triangles: Vec<[u32; 3]>,
    mean_area: f64,
    vertices: Vec<u32>,
    center: DVec2,
    scale: f64,
}

impl Problem {
    /// Vertices of a color that are sorted by the number of their neighbors, so that those visited at
    /// once have equally many: enough for few exceptions, and few enough to stay close together.
    pub(crate) const BLOCK: usize = 512;

    /// Lays out a mesh with its topology and coloring.
    pub fn new(mesh: &Mesh, topology: &Topology, coloring: &Coloring) -> Self {
        let (center, scale) = normalization(mesh, topology);
        let normalized = |v: u32| (DVec2::from(mesh.points[v as usize]) - center) * scale;

        let vertices = order(mesh, topology, coloring);
        let mut number = vec![u32::MAX; mesh.points.len()];
        for (new, &v) in vertices.iter().enumerate() {
            number[v as usize] = new as u32;
        }
        let mut colors = vec![0..0; coloring.count() as usize];
        for (new, &v) in vertices.iter().enumerate() {
            let color = coloring.colors()[v as usize];
            if color != UNCOLORED {
                let range = &mut colors[color as usize];
                if range.start == range.end {
                    range.start = new as u32;
                }
                range.end = new as u32 + 1;
            }
        }

        let free = colors.last().map_or(0, |range| range.end) as usize;
        let (ring_start, ring) = rings(topology, &vertices[..free], &number);
        let triangles = triangles(topology, vertices.len(), &number);

        let positions: Vec<DVec2> = vertices.par_iter().map(|&v| normalized(v)).collect();
        let area = |t: &[u32; 3]| {
            let [p, q, r] = t.map(|v| positions[v as usize]);
            0.5 * (q - p).perp_dot(r - p)
        };
        let mean_area = sum(&triangles, area) / triangles.len() as f64;
        Self { positions, colors, ring_start, ring, triangles, mean_area, vertices, center, scale }
    }

    /// Normalized position of each vertex.
    pub fn positions(&self) -> &[DVec2] {
        &self.positions
    }

    /// The free vertices of each color.
    pub fn colors(&self) -> &[Range<u32>] {
        &self.colors
    }

    /// Number of free vertices; they come first.
    pub fn free_count(&self) -> usize {
        self.ring_start.len() - 1
    }

    /// Where each free vertex's neighbors start in [`Self::ring`], and one past the last.
    pub fn ring_start(&self) -> &[u32] {
        &self.ring_start
    }

    /// The neighbors of the free vertices, counter-clockwise, vertex by vertex.
    pub fn ring(&self) -> &[u32] {
        &self.ring
    }

    /// The neighbors of one free vertex.
    #[inline]
    pub(crate) fn ring_of(&self, vertex: u32) -> &[u32] {
        let vertex = vertex as usize;
        &self.ring[self.ring_start[vertex] as usize..self.ring_start[vertex + 1] as usize]
    }

    /// All triangles, counter-clockwise.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Mean area of all triangles, in normalized units.
    pub fn mean_area(&self) -> f64 {
        self.mean_area
    }

    /// The mesh's number of each vertex.
    pub fn vertices(&self) -> &[u32] {
        &self.vertices
    }

    /// The center that positions are relative to, and the scale: normalized is (x - center) · scale.
    pub fn normalization(&self) -> (DVec2, f64) {
        (self.center, self.scale)
    }

    /// Brings the normalized positions of all vertices, fixed ones too, back into the mesh's units, each with the
    /// mesh's number of the vertex.
    pub fn denormalized(&self, positions: &[DVec2]) -> impl Iterator<Item = (u32, [f64; 2])> {
        let point = |&now: &DVec2| (self.center + now / self.scale).to_array();
        self.vertices.iter().copied().zip(positions.iter().map(point))
    }

    /// Puts normalized positions back in the mesh's order and units. A vertex that is fixed or did
    /// not move keeps its bits.
    pub fn denormalize(&self, mesh: &Mesh, positions: &[DVec2]) -> Vec<[f64; 2]> {
        let mut points = mesh.points.clone();
        let free = self.vertices[..self.free_count()].iter();
        for ((&v, &now), &was) in free.zip(positions).zip(&self.positions) {
            if now != was {
                points[v as usize] = (self.center + now / self.scale).to_array();
            }
        }
        points
    }
}

/// Center of the bounding box, and the power of two that brings the mean area into [0.5, 2).
fn normalization(mesh: &Mesh, topology: &Topology) -> (DVec2, f64) {
    let (low, high) = bounds(mesh, topology);
    // Halved before they are added: the sum of two large coordinates may overflow.
    let center = low * 0.5 + high * 0.5;
    // Areas are taken in units of the bounding box, where their squares cannot overflow or vanish.
    let extent = (high * 0.5 - low * 0.5).max_element();
    let relative = |t: &[u32; 3]| {
        let [p, q, r] = t.map(|v| (DVec2::from(mesh.points[v as usize]) - center) / extent);
        0.5 * (q - p).perp_dot(r - p)
    };
    let length =
        (sum(topology.triangles(), relative) / topology.triangles().len() as f64).sqrt() * extent;
    (center, (-length.log2().round()).exp2())
}

/// The bounding box of the vertices in use.
fn bounds(mesh: &Mesh, topology: &Topology) -> (DVec2, DVec2) {
    let none = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    let of = |t: &[u32; 3]| {
        let [p, q, r] = t.map(|v| DVec2::from(mesh.points[v as usize]));
        (p.min(q).min(r), p.max(q).max(r))
    };
    let both = |a: (DVec2, DVec2), b: (DVec2, DVec2)| (a.0.min(b.0), a.1.max(b.1));
    topology.triangles().par_iter().map(of).reduce(|| none, both)
}

/// The sum of a number of each triangle, in an order that does not depend on the number of threads.
fn sum(triangles: &[[u32; 3]], of: impl Fn(&[u32; 3]) -> f64 + Sync) -> f64 {
    let parts = triangles.par_chunks(4096).map(|part| part.iter().map(&of).sum());
    parts.collect::<Vec<f64>>().iter().sum()
}

/// The rings of the free `vertices`, by new numbers: where each starts, and all of them.
fn rings(topology: &Topology, vertices: &[u32], number: &[u32]) -> (Vec<u32>, Vec<u32>) {
    let mut start = Vec::with_capacity(vertices.len() + 1);
    let mut end = 0;
    start.push(end);
    for &v in vertices {
        end += topology.star(v).len() as u32;
        start.push(end);
    }
    let ring: Vec<AtomicU32> = (0..end).into_par_iter().map(|_| AtomicU32::new(0)).collect();
    // In the mesh's own order, where the triangles around a vertex are mostly near those around the
    // vertex before it. Each writes its own row; they are atomic only because rows lie anywhere.
    (0..number.len() as u32).into_par_iter().with_min_len(1 << 12).for_each_init(
        Vec::new,
        |edges, v| {
            if topology.free()[v as usize] {
                topology.ring_edges(v, edges);
                let row = &ring[start[number[v as usize] as usize] as usize..][..edges.len()];
                for (&(from, _), to) in edges.iter().zip(row) {
                    to.store(number[from as usize], Ordering::Relaxed);
                }
            }
        },
    );
    (start, ring.into_iter().map(AtomicU32::into_inner).collect())
}

/// All triangles by new numbers, of `vertices` vertices. Their order decides how well the objective's reads
/// are cached: by the least corner it follows the vertices' curve, and is the same whatever the input's order.
fn triangles(topology: &Topology, vertices: usize, number: &[u32]) -> Vec<[u32; 3]> {
    let renumbered = |t: &[u32; 3]| t.map(|v| number[v as usize]);
    let least = |t: &[u32; 3]| t[0].min(t[1]).min(t[2]);
    let mut end = vec![0u32; vertices];
    for t in topology.triangles() {
        end[least(&renumbered(t)) as usize] += 1;
    }
    let mut sum = 0;
    for end in &mut end {
        sum += *end;
        *end = sum;
    }
    let mut all = vec![[0; 3]; sum as usize];
    for t in topology.triangles().iter().rev() {
        let t = renumbered(t);
        let end = &mut end[least(&t) as usize];
        *end -= 1;
        all[*end as usize] = t;
    }
    all.par_chunk_by_mut(|a, b| least(a) == least(b)).for_each(<[_]>::sort_unstable);
    all
}

/// The vertices in use, in the order [`Problem`] promises.
fn order(mesh: &Mesh, topology: &Topology, coloring: &Coloring) -> Vec<u32> {
    let (low, high) = bounds(mesh, topology);
    let cells = f64::from(u32::MAX) / (high - low).max_element();
    let mut keyed: Vec<(u32, u64, u32)> = (0..mesh.points.len() as u32)
        .into_par_iter()
        .filter(|&v| !topology.star(v).is_empty())
        .map(|v| {
            let cell = (DVec2::from(mesh.points[v as usize]) - low) * cells;
            (coloring.colors()[v as usize], z_order(cell.x as u32, cell.y as u32), v)
        })
        .collect();
    // UNCOLORED is the largest color, so fixed vertices come last.
    keyed.par_sort_unstable();
    let color_of = |&(color, ..): &(u32, u64, u32)| color;
    for color in keyed.chunk_by_mut(|a, b| color_of(a) == color_of(b)) {
        color
            .par_chunks_mut(Problem::BLOCK)
            .for_each(|block| block.sort_by_key(|&(.., v)| topology.star(v).len()));
    }
    keyed.into_iter().map(|(_, _, v)| v).collect()
}

/// Position along the Z-order curve: the bits of x and y interleaved.
fn z_order(x: u32, y: u32) -> u64 {
    let spread = |bits: u32| {
        let mut b = u64::from(bits);
        b = (b | b << 16) & 0x0000_ffff_0000_ffff;
        b = (b | b << 8) & 0x00ff_00ff_00ff_00ff;
        b = (b | b << 4) & 0x0f0f_0f0f_0f0f_0f0f;
        b = (b | b << 2) & 0x3333_3333_3333_3333;
        (b | b << 1) & 0x5555_5555_5555_5555
    };
    spread(x) | spread(y) << 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn z_order_interleaves() {
        assert_eq!(z_order(0b11, 0b00), 0b0101);
        assert_eq!(z_order(0b01, 0b10), 0b1001);
        assert_eq!(z_order(u32::MAX, u32::MAX), u64::MAX);
    }
}
