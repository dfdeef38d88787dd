//! Local coordinates of the vertices of a strongly stretched mesh.
//!
//! A Newton step replaces negative eigenvalues of a Hessian by their absolute values and raises small ones to a floor.
//! Both need coordinates in which the triangles around the vertex are nearly equilateral: where triangles are stretched
//! a thousand times, the smaller eigenvalue lies below the floor. The coarser levels need such coordinates too, as their
//! operators are equal in all directions.

use glam::DVec2;

use crate::layout::{OPPOSITE, Problem};
use crate::metric::of_right_angle;
use crate::parallel::paced;
use crate::targets::{Tensor, shape_logarithm_of};

/// Ratio of lengths along and across the triangles of a vertex from which the vertex counts as strongly stretched. On
/// lattices stretched 10, 30 and 50-fold, runs in local coordinates took 25, 29 and 30 sweeps instead of 26, 41 and 98. A
/// sweep in local coordinates takes about twice the time.
const STRETCHED: f64 = 50.0;
/// Share of strongly stretched vertices from which a mesh is smoothed in local coordinates.
const SHARE: f64 = 0.05;
/// Number of triangles around a vertex from which a mesh is smoothed in local coordinates, whatever its other vertices.
/// Runs around vertices of 3,000 ended at three times the promised distance from the limit of f. Around vertices of 200
/// and 1,000, local coordinates took more sweeps.
const HUB: u32 = 1000;
/// Largest number of vertices at which the stretching is measured.
const SAMPLES: usize = 1024;
/// Largest ratio of the eigenvalues of a local map. Maps are in single precision, whose rounding would make tensors with
/// larger ratios indefinite.
const MAX_RATIO: f64 = 1e6;

impl Problem {
    /// Returns whether a run needs local coordinates: the triangles at one free vertex in twenty are strongly stretched,
    /// after their target maps are applied if the mesh has targets. Without targets, a free vertex with more than a
    /// thousand triangles suffices.
    pub(crate) fn is_strongly_stretched(&self, positions: &[DVec2]) -> bool {
        let degrees = self.ring_start().windows(2).map(|ends| ends[1] - ends[0]);
        (self.targets().is_none() && degrees.max() > Some(HUB))
            || self.share_stretched(positions, STRETCHED) > SHARE
    }

    /// Returns the share of the free vertices whose triangles are longer than wide by more than a ratio, after their target maps
    /// are applied if the mesh has targets.
    pub(crate) fn share_stretched(&self, positions: &[DVec2], ratio: f64) -> f64 {
        let step = self.free_count().div_ceil(SAMPLES).max(1);
        let samples = (0..self.free_count()).step_by(step);
        let count = samples.len();
        let transformed = |t: &[u32; 3]| {
            let corner = self.corner(t, |k| positions[k as usize]);
            [corner.a, corner.b]
        };
        let is_stretched = |&v: &usize| {
            let [low, high] = shape_at(self, v, transformed).eigenvalues();
            high / low > ratio
        };
        samples.filter(is_stretched).count() as f64 / count.max(1) as f64
    }

    /// Sets the local maps of the free vertices, for vertices at `positions`. A local map transforms the triangles
    /// around its vertex so that their mean shape is equilateral, and keeps areas. Targets do not matter.
    pub(crate) async fn set_local_maps_at(&mut self, positions: &[DVec2]) {
        let free = self.free_count();
        let edge =
            |from: u32, to: u32| (positions[to as usize] - positions[from as usize]).to_array();
        let edges = |&[v, p, q]: &[u32; 3]| [edge(v, p), edge(v, q)];
        let map = |v: usize| match v < free {
            true => shape_at(self, v, edges).0.map(|x| x as f32),
            false => [1.0, 0.0, 1.0],
        };
        let maps = paced::collect(positions.len(), map).await;
        self.set_local_maps(maps);
    }
}

/// Returns the map, of determinant 1, under which the mean shape of the elements around a free vertex is ideal.
/// `edges` returns the two edges of a corner that start at its first vertex, the free vertex.
fn shape_at(problem: &Problem, v: usize, edges: impl Fn(&[u32; 3]) -> [[f64; 2]; 2]) -> Tensor {
    let (mut sum, mut count) = (Tensor::default(), 0);
    let ring = problem.ring_of(v as u32);
    for (i, &next) in ring.iter().enumerate().filter(|(_, k)| *k & OPPOSITE == 0) {
        let last = ring[(i + 1) % ring.len()];
        let (last, is_right) = match last & OPPOSITE {
            0 => (last, false),
            _ => (ring[(i + 2) % ring.len()], true),
        };
        let mut edges = edges(&[v as u32, next, last]);
        if is_right {
            edges = of_right_angle(edges);
        }
        sum = sum.plus(shape_logarithm_of(edges));
        count += 1;
    }
    let Tensor([xx, xy, yy]) = sum.times(1.0 / f64::from(count));
    // Without the trace, the determinant of the exponential is 1.
    let half = 0.5 * (xx - yy);
    let most = 0.5 * MAX_RATIO.ln();
    let limit = (most / half.hypot(xy)).min(1.0);
    let map = Tensor([half, xy, -half]).times(limit).exp();
    // Squared lengths of edges overflow next to a vertex that is extremely far away.
    if map.is_positive() { map } else { Tensor::isotropic(1.0) }
}
