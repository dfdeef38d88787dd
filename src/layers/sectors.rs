//! The elements of a mesh around its vertices, split at walls.

use crate::layers::elements::Elements;
use crate::layers::vector::angle;
use crate::parallel::counting_sort::Groups;

/// No node, or no half-edge.
pub(super) const NONE: u32 = u32::MAX;

/// The edges of elements between nodes. A node is a vertex, seen from the elements on one side of the walls through the
/// vertex: a vertex of a crack has two nodes, a vertex inside the mesh has one. Elements are triangles and larger
/// faces, counter-clockwise. An element's corner `h` stands for the half-edge from this corner to the next.
///
/// The elements are all of a mesh, or those near walls alone.
pub(super) struct Sectors {
    /// Position of each node.
    pub(super) at: Vec<[f64; 2]>,
    /// Vertex of each node.
    pub(super) vertex: Vec<u32>,
    /// Node of each corner of each element.
    pub(super) corners: Vec<u32>,
    /// Next corner of the element.
    pub(super) next: Vec<u32>,
    /// The corner at the other end of a half-edge, in the element across; [`NONE`] at walls.
    pub(super) twin: Vec<u32>,
    /// Nodes before and after each node along the wall, with the fluid on the left; [`NONE`] for nodes inside.
    pub(super) wall: Vec<[u32; 2]>,
    /// Angle of the fluid at each node of a wall, in degrees; 360 at nodes inside.
    pub(super) fluid: Vec<f64>,
    starts: Vec<u32>,
    neighbors: Vec<u32>,
}

impl Sectors {
    /// Splits the vertices of a mesh at its boundary and along `lines`.
    pub(super) fn new(elements: &Elements<'_>, lines: &[[u32; 2]]) -> Self {
        Self::of(elements, lines, |_| true, |_| true)
    }

    /// Splits the vertices at the boundary and along the lines of the elements. Elements count if a vertex is at most `edges` edges
    /// away from these walls. A node within this distance has all its elements. Nodes are in the order of [`new`](Self::new).
    pub(super) fn near_walls(elements: &Elements<'_>, edges: usize) -> Self {
        let topology = elements.topology;
        let mut may_be_on_wall: Vec<bool> =
            topology.free().iter().map(|&is_free| !is_free).collect();
        let of_faces = elements.faces.iter().flatten();
        for &vertex in of_faces.chain(elements.lines.as_flattened()) {
            may_be_on_wall[vertex as usize] = true;
        }
        let mut is_near = may_be_on_wall.clone();
        let vertices = 0..is_near.len() as u32;
        let mut last: Vec<u32> = vertices.filter(|&vertex| is_near[vertex as usize]).collect();
        for _ in 0..edges {
            let mut reached = Vec::new();
            for corner in last.iter().flat_map(|&vertex| topology.corners_with(vertex)) {
                for vertex in topology.corners()[corner as usize] {
                    if !std::mem::replace(&mut is_near[vertex as usize], true) {
                        reached.push(vertex);
                    }
                }
            }
            last = reached;
        }
        let may_be_on_wall = |vertex: u32| may_be_on_wall[vertex as usize];
        Self::of(elements, elements.lines, |vertex| is_near[vertex as usize], may_be_on_wall)
    }

    /// Splits the vertices of the elements that have a vertex for which `is_near` is true. Edges between two vertices are inside the
    /// mesh unless `may_be_on_wall` is true for both.
    fn of(
        elements: &Elements<'_>,
        lines: &[[u32; 2]],
        is_near: impl Fn(u32) -> bool,
        may_be_on_wall: impl Fn(u32) -> bool,
    ) -> Self {
        let points = elements.points;
        let is_listed = |corners: &[u32]| corners.iter().any(|&vertex| is_near(vertex));
        let (origin, next) = corners(elements, is_listed);
        let twin = twins(points.len(), &origin, &next, lines);
        let mut previous = vec![0; next.len()];
        (0..).zip(&next).for_each(|(h, &n)| previous[n as usize] = h);
        let mut sectors = Self {
            at: Vec::with_capacity(points.len()),
            vertex: Vec::with_capacity(points.len()),
            corners: vec![NONE; origin.len()],
            next,
            twin,
            wall: Vec::new(),
            fluid: Vec::new(),
            starts: Vec::new(),
            neighbors: Vec::new(),
        };
        for h in 0..origin.len() as u32 {
            if sectors.corners[h as usize] == NONE {
                sectors.add_node(points, &origin, &previous, h, &may_be_on_wall);
            }
        }
        for link in sectors.wall.iter_mut().flatten().filter(|link| **link != NONE) {
            *link = sectors.corners[*link as usize];
        }
        sectors.connect();
        sectors
    }

    /// Adds the node of the corner `h`: all corners around its vertex up to the walls. Walls of the node are corners
    /// until all nodes exist.
    fn add_node(
        &mut self,
        points: &[[f64; 2]],
        origin: &[u32],
        previous: &[u32],
        h: u32,
        may_be_on_wall: &impl Fn(u32) -> bool,
    ) {
        let node = self.at.len() as u32;
        let mut first = h;
        let is_closed = loop {
            let across = self.twin[first as usize];
            if across == NONE {
                break false;
            }
            first = self.next[across as usize];
            if first == h {
                break true;
            }
        };
        // Around a vertex inside the mesh, elements may be missing.
        let is_inside = is_closed || !may_be_on_wall(origin[h as usize]);
        let point = |h: u32| points[origin[h as usize] as usize];
        let (mut last, mut fluid) = (first, 0.0);
        loop {
            self.corners[last as usize] = node;
            let before = previous[last as usize];
            if !is_inside {
                fluid += angle(point(last), point(self.next[last as usize]), point(before));
            }
            let across = self.twin[before as usize];
            if across == NONE || across == first {
                break;
            }
            last = across;
        }
        self.at.push(point(h));
        self.vertex.push(origin[h as usize]);
        self.fluid.push(if is_inside { 360.0 } else { fluid });
        self.wall.push(match is_inside {
            true => [NONE; 2],
            false => [previous[last as usize], self.next[first as usize]],
        });
    }

    /// Lists the neighbors of each node along edges of elements.
    fn connect(&mut self) {
        let mut edges = Vec::with_capacity(self.corners.len());
        for (h, &from) in self.corners.iter().enumerate() {
            let to = self.corners[self.next[h] as usize];
            edges.push([from, to]);
            if self.twin[h] == NONE {
                edges.push([to, from]);
            }
        }
        let grouped = Groups::new(edges.len(), self.at.len(), |edge| [edges[edge][0]]);
        self.starts = grouped.starts().to_vec();
        self.neighbors = grouped.into_items().iter().map(|&edge| edges[edge as usize][1]).collect();
    }

    /// Returns the neighbors of a node along edges of elements, without diagonals of larger faces.
    pub(super) fn neighbors(&self, node: u32) -> &[u32] {
        let [start, end] = [0, 1].map(|i| self.starts[node as usize + i] as usize);
        &self.neighbors[start..end]
    }

    /// Returns the point of a node.
    pub(super) fn point(&self, node: u32) -> [f64; 2] {
        self.at[node as usize]
    }

    /// Returns the number of nodes.
    pub(super) fn len(&self) -> usize {
        self.at.len()
    }

    /// Returns whether a node is on a wall.
    pub(super) fn is_wall(&self, node: u32) -> bool {
        self.wall[node as usize][0] != NONE
    }
}

/// Returns the vertex of each corner of the elements for which `is_listed` is true, counter-clockwise, and the next corner of the
/// element.
fn corners(elements: &Elements<'_>, is_listed: impl Fn(&[u32]) -> bool) -> (Vec<u32>, Vec<u32>) {
    let (points, faces) = (elements.points, elements.all_faces());
    let triangles = elements.topology.triangles().iter();
    let mut origin: Vec<u32> =
        triangles.filter(|corners| is_listed(&corners[..])).flatten().copied().collect();
    let mut next: Vec<u32> = (0..origin.len() as u32).map(|h| h - h % 3 + (h + 1) % 3).collect();
    for face in faces.iter().filter(|face| face.len() >= 3 && is_listed(face)) {
        let start = origin.len() as u32;
        let twice_area: f64 = (0..face.len())
            .map(|i| {
                let [p, q] = [face[i], face[(i + 1) % face.len()]].map(|v| points[v as usize]);
                let o = points[face[0] as usize];
                (p[0] - o[0]) * (q[1] - o[1]) - (p[1] - o[1]) * (q[0] - o[0])
            })
            .sum();
        match twice_area >= 0.0 {
            true => origin.extend_from_slice(face),
            false => origin.extend(face.iter().rev()),
        }
        let count = face.len() as u32;
        next.extend((0..count).map(|i| start + (i + 1) % count));
    }
    (origin, next)
}

/// Returns for each half-edge the half-edge in the opposite direction; [`NONE`] on the boundary, along `lines`, and where
/// an edge has more than two elements.
fn twins(vertices: usize, origin: &[u32], next: &[u32], lines: &[[u32; 2]]) -> Vec<u32> {
    let ends = |h: usize| [origin[h], origin[next[h] as usize]];
    let sorted = |[a, b]: [u32; 2]| [a.min(b), a.max(b)];
    let mut walls: Vec<[u32; 2]> = lines.iter().copied().map(sorted).collect();
    walls.sort_unstable();
    let by_least = Groups::new(origin.len(), vertices, |h| [sorted(ends(h))[0]]);
    let mut twin = vec![NONE; origin.len()];
    let mut own: Vec<(u32, u32)> = Vec::new();
    for vertex in 0..vertices {
        own.clear();
        own.extend(by_least.of(vertex).iter().map(|&h| (sorted(ends(h as usize))[1], h)));
        own.sort_unstable();
        for edge in own.chunk_by(|(a, _), (b, _)| a == b) {
            if let &[(greater, first), (_, second)] = edge
                && origin[first as usize] != origin[second as usize]
                && walls.binary_search(&[vertex as u32, greater]).is_err()
            {
                (twin[first as usize], twin[second as usize]) = (second, first);
            }
        }
    }
    twin
}
