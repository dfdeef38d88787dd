//! The triangles around one vertex, for visits on the host.

use glam::DVec2;

use crate::layout::Problem;
use crate::measure::altitude;
use crate::metric::{Corner, Dual, TargetMap};
use crate::run::Step;
use crate::topology::Topology;
use crate::topology::predicates::is_positive;

/// The triangles at a vertex, each with the vertex itself as its first corner.
#[derive(Clone, Debug)]
pub(crate) struct Fan(Vec<[u32; 3]>);

impl Fan {
    pub(crate) fn new(topology: &Topology<'_>, vertex: u32) -> Self {
        let own_first = |&t: &u32| {
            let mut corners = topology.triangles()[t as usize];
            let own = corners.iter().position(|&v| v == vertex).unwrap_or(0);
            corners.rotate_left(own);
            corners
        };
        Self(topology.star(vertex).iter().map(own_first).collect())
    }

    /// Gives every vertex a new number.
    pub(crate) fn renumber(&mut self, number: &[u32]) {
        self.0.as_flattened_mut().iter_mut().for_each(|v| *v = number[*v as usize]);
    }

    /// Number of triangles.
    pub(crate) fn degree(&self) -> usize {
        self.0.len()
    }

    /// The vertex in the middle.
    pub(crate) fn own(&self) -> u32 {
        self.0.first().map_or(0, |corners| corners[0])
    }
}

/// The triangles around a vertex as metrics see them, for any position of the vertex.
pub(crate) struct Patch<'a> {
    pub(crate) problem: &'a Problem,
    pub(crate) positions: &'a [DVec2],
    pub(crate) fan: &'a Fan,
    pub(crate) step: &'a Step,
    /// The least altitude that a triangle may have, normalized; 0 for no bound.
    pub(crate) floor: f64,
}

impl Patch<'_> {
    fn corner(&self, corners: &[u32; 3], at: DVec2) -> Corner<f64> {
        let own = corners[0];
        self.problem.corner(corners, |v| if v == own { at } else { self.positions[v as usize] })
    }

    /// Returns the objective with its derivatives by the position of the vertex.
    pub(crate) fn derivatives(&self, at: DVec2) -> Dual {
        let Step { metric, sharpness, .. } = *self.step;
        self.fan.0.iter().fold(Dual::default(), |sum, corners| {
            let shown = metric.expansion(&self.corner(corners, at), sharpness);
            let pulled = match self.problem.targets() {
                None => shown,
                Some(maps) => {
                    let maps = corners.map(|v| maps[v as usize].map(f64::from));
                    TargetMap::mean(maps).pull_back(shown)
                }
            };
            sum + pulled
        })
    }

    /// Returns the objective. `None` if a triangle is inverted or flat, or has an inverse mean ratio above the limit or
    /// an altitude below the floor.
    pub(crate) fn objective(&self, at: DVec2, limit: f64) -> Option<f64> {
        let Step { metric, sharpness, .. } = *self.step;
        let mut sum = 0.0;
        for corners in &self.fan.0 {
            let points = corners.map(|v| self.positions[v as usize].to_array());
            let is_sound = is_positive(&[at.to_array(), points[1], points[2]], &[0, 1, 2]);
            if self.floor > 0.0 && altitude([at, points[1].into(), points[2].into()]) < self.floor {
                return None;
            }
            let corner = self.corner(corners, at);
            if !is_sound || corner.doubled_area() <= 0.0 || corner.inverse_mean_ratio() > limit {
                return None;
            }
            sum += metric.model(&corner, sharpness);
        }
        Some(sum)
    }

    /// Returns the largest inverse mean ratio.
    pub(crate) fn worst_shape(&self, at: DVec2) -> f64 {
        let ratio = |corners| self.corner(corners, at).inverse_mean_ratio();
        self.fan.0.iter().map(ratio).fold(0.0, f64::max)
    }
}
