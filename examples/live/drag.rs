//! Vertices and holes that the user drags.

use gpu_smooth::{Topology, topology::signed_area};

/// Largest move of a held vertex in a frame, in units of the surrounding edge length. The limit lets sweeps keep up.
const REACH: f64 = 0.3;

/// The holes of a mesh.
pub(crate) struct Holes {
    loops: Vec<Vec<u32>>,
    /// For each vertex: `None` if interior, `Some(None)` on the outer boundary, otherwise the index of its hole.
    of: Vec<Option<Option<usize>>>,
}

impl Holes {
    pub(crate) fn new(topology: &Topology<'_>, points: &[[f64; 2]]) -> Self {
        let mut of = vec![None; points.len()];
        let mut loops = Vec::new();
        for vertices in topology.boundary_loops() {
            // The outer boundary is a counterclockwise loop, each hole a clockwise one.
            let hole = (signed_area(points, &vertices) < 0.0).then_some(loops.len());
            vertices.iter().for_each(|&v| of[v as usize] = Some(hole));
            if hole.is_some() {
                loops.push(vertices);
            }
        }
        Self { loops, of }
    }
}

/// The vertices held by the pointer: one interior vertex, or all vertices of a hole's boundary.
pub(crate) struct Drag {
    vertices: Vec<u32>,
    /// Positions of the vertices at the start of the drag.
    start: Vec<[f64; 2]>,
    /// The vertex under the pointer. `from` is the position of this vertex at the start of the drag; `goal` is the
    /// pointer's position.
    grip: u32,
    from: [f64; 2],
    goal: [f64; 2],
    /// Mean edge length around the vertices.
    edge: f64,
}

impl Drag {
    /// Grabs the nearest vertex within `radius`, or the whole hole if that vertex is on a hole. `None` if nothing can
    /// be grabbed.
    pub(crate) fn grab(
        topology: &Topology<'_>,
        holes: &Holes,
        points: &[[f64; 2]],
        at: [f64; 2],
        radius: f64,
    ) -> Option<Self> {
        let used = (0..points.len() as u32).filter(|&v| !topology.star(v).is_empty());
        let grip = used.min_by(|&v, &w| {
            distance(points[v as usize], at).total_cmp(&distance(points[w as usize], at))
        })?;
        if distance(points[grip as usize], at) > radius {
            return None;
        }
        let vertices = match holes.of[grip as usize] {
            None => vec![grip],
            Some(Some(hole)) => holes.loops[hole].clone(),
            // The outer boundary is fixed.
            Some(None) => return None,
        };
        let start = vertices.iter().map(|&v| points[v as usize]).collect();
        let edge = edge_length(topology, points, &vertices);
        let from = points[grip as usize];
        Some(Self { vertices, start, grip, from, goal: from, edge })
    }

    pub(crate) fn vertices(&self) -> &[u32] {
        &self.vertices
    }

    pub(crate) fn aim(&mut self, at: [f64; 2]) {
        self.goal = at;
    }

    /// Returns the positions of the vertices for the next frame. With `at_once`, vertices move all the way to the goal,
    /// otherwise at most [`REACH`] edge lengths.
    pub(crate) fn goals(&self, points: &[[f64; 2]], at_once: bool) -> Vec<[f64; 2]> {
        let now = points[self.grip as usize];
        let way = distance(now, self.goal);
        let part = if at_once || way == 0.0 { 1.0 } else { (REACH * self.edge / way).min(1.0) };
        // All vertices move by the vector of the vertex under the pointer, which preserves the shape of a hole.
        let delta = [0, 1].map(|i| now[i] + part * (self.goal[i] - now[i]) - self.from[i]);
        self.start.iter().map(|p| [p[0] + delta[0], p[1] + delta[1]]).collect()
    }
}

/// Returns the mean edge length of the triangles around some vertices.
fn edge_length(topology: &Topology<'_>, points: &[[f64; 2]], vertices: &[u32]) -> f64 {
    let around = || vertices.iter().flat_map(|&v| topology.star(v));
    let perimeter = |&t: &u32| {
        let [p, q, r] = topology.triangles()[t as usize].map(|v| points[v as usize]);
        distance(p, q) + distance(q, r) + distance(r, p)
    };
    around().map(perimeter).sum::<f64>() / (3 * around().count()) as f64
}

pub(crate) fn distance(p: [f64; 2], q: [f64; 2]) -> f64 {
    (p[0] - q[0]).hypot(p[1] - q[1])
}
