//! What the user can take hold of, and how far it may move in one frame.

use gpu_smooth::{Corner, Metric, Topology};

use super::smoothing::rounded;

/// A triangle that the user touches may get this bad (inverse mean ratio), or stay as bad as it is.
const WORST: f64 = 8.0;
/// A frame moves by at most this part of the edges around, so that the sweeps keep up.
const REACH: f64 = 0.3;
/// A move that is refused is tried at half its length, and so on.
const ATTEMPTS: u32 = 6;

/// The holes of a mesh.
pub(crate) struct Holes {
    loops: Vec<Vec<u32>>,
    /// For each vertex whether it is on the boundary, and if so the hole it belongs to, if to any.
    of: Vec<Option<Option<usize>>>,
}

impl Holes {
    pub(crate) fn new(topology: &Topology, points: &[[f64; 2]]) -> Self {
        // Each boundary edge runs with the mesh on its left: an outer boundary counter-clockwise, that of
        // a hole clockwise.
        let mut next = vec![Vec::new(); points.len()];
        for &[a, b, c] in topology.triangles() {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                let both = |&&t: &&u32| topology.triangles()[t as usize].contains(&to);
                if topology.star(from).iter().filter(both).count() == 1 {
                    next[from as usize].push(to);
                }
            }
        }
        let mut of: Vec<_> = next.iter().map(|to| (!to.is_empty()).then_some(None)).collect();
        let (mut loops, mut seen) = (Vec::new(), vec![false; points.len()]);
        for start in 0..points.len() as u32 {
            let (mut part, mut open, mut doubled_area) = (Vec::new(), vec![start], 0.0);
            while let Some(v) = open.pop() {
                if std::mem::replace(&mut seen[v as usize], true) || next[v as usize].is_empty() {
                    continue;
                }
                part.push(v);
                for &w in &next[v as usize] {
                    let ([px, py], [qx, qy]) = (points[v as usize], points[w as usize]);
                    doubled_area += px * qy - py * qx;
                    open.push(w);
                }
            }
            if doubled_area < 0.0 {
                part.iter().for_each(|&v| of[v as usize] = Some(Some(loops.len())));
                loops.push(part);
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
        topology: &Topology,
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
    pub(crate) fn step(&self, topology: &Topology, points: &[[f64; 2]]) -> Option<Vec<[f64; 2]>> {
        let from = points[self.grip as usize];
        let way = distance(from, self.goal);
        let mut share = (REACH * self.edge_length(topology, points) / way).min(1.0);
        let mut moved = points.to_vec();
        for _ in 0..ATTEMPTS {
            let delta = [0, 1].map(|i| share * (self.goal[i] - from[i]));
            for &v in &self.vertices {
                let [x, y] = points[v as usize];
                moved[v as usize] = rounded([x + delta[0], y + delta[1]]);
            }
            let fits = |&t: &u32| {
                let corners = &topology.triangles()[t as usize];
                let worst = imr(points, corners).max(WORST);
                imr(&moved, corners) <= worst
            };
            if self.triangles.iter().all(fits) {
                return (moved[self.grip as usize] != from).then_some(moved);
            }
            share /= 2.0;
        }
        None
    }

    /// The mean length of the edges around what is held.
    fn edge_length(&self, topology: &Topology, points: &[[f64; 2]]) -> f64 {
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

fn imr(points: &[[f64; 2]], corners: &[u32; 3]) -> f64 {
    let [p, q, r] = corners.map(|v| points[v as usize]);
    let edge = |to: [f64; 2]| [to[0] - p[0], to[1] - p[1]];
    // The mean area makes no difference to this metric.
    Metric::Imr.quality(&Corner { a: edge(q), b: edge(r), mean_area: 1.0 })
}
