//! What the user can take hold of, and how far it may move in one frame.

use gpu_smooth::{MeshError, Topology, signed_area};

use super::smoothing::rounded;

/// A triangle that the user touches may get this bad (inverse mean ratio), or stay as bad as it is.
const WORST: f64 = 8.0;
/// A frame moves by at most this part of the edges around, so that the sweeps keep up.
const REACH: f64 = 0.3;

/// The holes of a mesh.
pub(crate) struct Holes {
    loops: Vec<Vec<u32>>,
    /// For each vertex whether it is on the boundary, and if so the hole it belongs to, if to any.
    of: Vec<Option<Option<usize>>>,
}

impl Holes {
    pub(crate) fn new(topology: &Topology<'_>, points: &[[f64; 2]]) -> Self {
        let mut of = vec![None; points.len()];
        let mut loops = Vec::new();
        for vertices in topology.boundary_loops() {
            // The outside goes around counter-clockwise, a hole clockwise.
            let hole = (signed_area(points, &vertices) < 0.0).then_some(loops.len());
            vertices.iter().for_each(|&v| of[v as usize] = Some(hole));
            if hole.is_some() {
                loops.push(vertices);
            }
        }
        Self { loops, of }
    }
}

/// Something held by the pointer: an interior vertex, or all of a hole's boundary.
pub(crate) struct Drag {
    vertices: Vec<u32>,
    /// The triangles that move with them or change.
    triangles: Vec<u32>,
    /// The vertex under the pointer, and where it is to go.
    grip: u32,
    goal: [f64; 2],
}

impl Drag {
    /// Takes hold of the nearest vertex within `radius`, or of the hole that it bounds.
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
            // The outer boundary stays.
            Some(None) => return None,
        };
        let mut triangles: Vec<_> =
            vertices.iter().flat_map(|&v| topology.star(v)).copied().collect();
        triangles.sort_unstable();
        triangles.dedup();
        Some(Self { vertices, triangles, grip, goal: at })
    }

    pub(crate) fn vertices(&self) -> &[u32] {
        &self.vertices
    }

    pub(crate) fn aim(&mut self, at: [f64; 2]) {
        self.goal = at;
    }

    /// The points after one frame's move toward the goal, as far as the triangles allow; `None` if nothing
    /// moves.
    pub(crate) fn step(
        &self,
        topology: &Topology<'_>,
        points: &[[f64; 2]],
    ) -> Result<Option<Vec<[f64; 2]>>, MeshError> {
        let from = points[self.grip as usize];
        let way = distance(from, self.goal);
        let reach = (REACH * self.edge_length(topology, points) / way).min(1.0);
        let delta = [0, 1].map(|i| reach * (self.goal[i] - from[i]));
        let there = |&v: &u32| {
            let [x, y] = points[v as usize];
            (v, [x + delta[0], y + delta[1]])
        };
        let moves: Vec<_> = self.vertices.iter().map(there).collect();
        let mut moved = points.to_vec();
        topology.move_clamped(&mut moved, &moves, WORST)?;
        for &v in &self.vertices {
            moved[v as usize] = rounded(moved[v as usize]);
        }
        Ok((moved[self.grip as usize] != from).then_some(moved))
    }

    /// The mean length of the edges around what is held.
    fn edge_length(&self, topology: &Topology<'_>, points: &[[f64; 2]]) -> f64 {
        let perimeter = |&t: &u32| {
            let [p, q, r] = topology.triangles()[t as usize].map(|v| points[v as usize]);
            distance(p, q) + distance(q, r) + distance(r, p)
        };
        self.triangles.iter().map(perimeter).sum::<f64>() / (3 * self.triangles.len()) as f64
    }
}

pub(crate) fn distance(p: [f64; 2], q: [f64; 2]) -> f64 {
    (p[0] - q[0]).hypot(p[1] - q[1])
}
