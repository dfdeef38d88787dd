//! The positions of a mesh during untangling, with the sweeps, corrections and cuts that move the vertices.

use glam::{DVec2, Vec2};

use crate::cpu::correction;
use crate::layout::Problem;
use crate::parallel::pace::now;
use crate::parallel::{collect, for_each_chunk, map_parts, map_ranges};
use crate::patch::{VertexBatch, batches};
use crate::run::multilevel::{Hierarchy, Search};
use crate::untangle::cuts::{Short, cut};
use crate::untangle::energy::Corner;
use crate::untangle::patches::Tangle;

/// Number of vertices or triangles in one parallel task.
pub(super) const CHUNK: usize = 1 << 12;

/// The positions of a mesh that is untangled, with its target areas.
pub(crate) struct State<'p> {
    pub(super) problem: &'p Problem,
    pub(crate) positions: Vec<DVec2>,
    /// Target area at each vertex, in normalized units.
    targets: Vec<f64>,
    /// Length of the last global step, as a multiple of the correction.
    length: f64,
}

/// A summary of the signed areas of the triangles in a region.
#[derive(Clone, Copy)]
pub(crate) struct Assessment {
    /// Smallest signed area relative to the target area, negative if a triangle is inverted.
    pub(crate) least: f64,
    /// Number of triangles whose area, computed in double precision, is not positive.
    pub(crate) bad: usize,
}

impl Assessment {
    const EMPTY: Self = Self { least: f64::INFINITY, bad: 0 };

    /// Returns the depth of the most inverted triangle, in target areas, times the number of bad triangles; 0 if no area is
    /// negative.
    pub(crate) fn inverted_area(&self) -> f64 {
        -self.least.min(0.0) * self.bad as f64
    }

    fn and(self, other: Self) -> Self {
        Self { least: self.least.min(other.least), bad: self.bad + other.bad }
    }
}

/// The vertices of a sweep, and all corners whose shape the sweep changes.
pub(crate) struct Region {
    /// Batches of vertices, by color.
    vertices: Vec<Vec<VertexBatch>>,
    /// Indices of the corners in the problem.
    corners: Vec<u32>,
}

impl Region {
    /// Returns the region of the free vertices within `rings` edges of the bad triangles. Paths of edges stop at fixed
    /// vertices.
    pub(crate) fn around(problem: &Problem, bad: &[u32], rings: u32) -> Region {
        let free = problem.free_count();
        let mut inside = vec![false; problem.positions().len()];
        let mut front = Vec::new();
        let triangles = problem.corners().all();
        for v in bad.iter().flat_map(|&t| triangles[t as usize]) {
            if !std::mem::replace(&mut inside[v as usize], true) {
                front.push(v);
            }
        }
        for _ in 0..rings {
            let mut next = Vec::new();
            for &v in front.iter().filter(|&&v| (v as usize) < free) {
                for k in problem.companions(v) {
                    if !std::mem::replace(&mut inside[k as usize], true) {
                        next.push(k);
                    }
                }
            }
            front = next;
        }
        let moves = |v: u32| (v as usize) < free && inside[v as usize];
        Region {
            vertices: problem
                .colors()
                .iter()
                .map(|color| batches(problem, color.clone().filter(|&v| moves(v))))
                .collect(),
            corners: (0..triangles.len() as u32)
                .filter(|&t| triangles[t as usize].iter().any(|&v| moves(v)))
                .collect(),
        }
    }

    /// Returns the region of all free vertices and all triangles of the problem.
    pub(crate) fn whole(problem: &Problem) -> Region {
        Region {
            vertices: problem.colors().iter().map(|c| batches(problem, c.clone())).collect(),
            corners: (0..problem.corners().all().len() as u32).collect(),
        }
    }
}

impl<'p> State<'p> {
    pub(crate) fn new(problem: &'p Problem, targets: Vec<f64>) -> Self {
        Self { problem, positions: problem.positions().to_vec(), targets, length: 0.1 }
    }

    fn tangle<'a>(&'a self, positions: &'a [DVec2]) -> Tangle<'a> {
        Tangle { problem: self.problem, positions, targets: &self.targets }
    }

    /// Returns the smallest area and the number of bad triangles of a region at the present positions.
    pub(crate) fn assess(&self, region: &Region) -> Assessment {
        let tangle = self.tangle(&self.positions);
        let corners = self.problem.corners();
        let area =
            |&c: &u32| tangle.corner(!corners.is_triangle(c), &corners.all()[c as usize]).area();
        let parts = map_parts(region.corners.chunks(CHUNK), |_, part| {
            part.iter().map(area).fold(Assessment::EMPTY, |all, area| {
                all.and(Assessment { least: area, bad: usize::from(area.is_nan() || area <= 0.0) })
            })
        });
        parts.into_iter().fold(Assessment::EMPTY, Assessment::and)
    }

    /// Visits every vertex of the region once, color by color, with a Newton step each.
    pub(crate) fn sweep(&mut self, region: &Region, epsilon: f64) {
        for batches in &region.vertices {
            let moved = self.tangle(&self.positions).steps(batches, epsilon);
            for (batch, to) in batches.iter().zip(moved) {
                for (&v, to) in batch.iter().zip(to) {
                    self.positions[v as usize] = to;
                }
            }
        }
    }

    /// Cuts the mesh and moves vertices onto the cuts. Returns true for vertices on cuts and for fixed vertices.
    pub(crate) fn cut(&mut self, short: Short) -> Vec<bool> {
        let cuts = cut(self.problem, &self.targets, &self.positions, short);
        self.positions = cuts.positions;
        cuts.held
    }

    /// Builds the coarser levels for [`global_step`](Self::global_step) and [`make_harmonic`](Self::make_harmonic).
    /// Corrections from the levels move no `held` vertex.
    pub(crate) fn hierarchy(&self, held: &[bool]) -> Hierarchy {
        Hierarchy::of_sizes(self.problem, &self.targets, held)
    }

    /// Moves all free vertices along a correction from the coarser levels, to a length at which the energy is lower.
    /// `region` must be the whole mesh.
    pub(crate) fn global_step(&mut self, region: &Region, hierarchy: &Hierarchy, epsilon: f64) {
        let gradient = self.gradient(region, epsilon);
        // The levels compute in single precision, whose range a gradient near flat triangles may exceed.
        let most = largest(&gradient);
        let unit = if most > 0.0 && most.is_finite() { 1.0 / most } else { return };
        let scaled: Vec<Vec2> = collect(gradient.len(), |v| (gradient[v] * unit).as_vec2());
        let direction = now(correction(hierarchy, self.problem, &scaled));
        let along = |v: usize| direction.get(v).map_or(DVec2::ZERO, |d| d.as_dvec2() * most);
        let slopes = map_ranges(gradient.len(), CHUNK, |range| {
            range.map(|v| gradient[v].dot(along(v))).sum::<f64>()
        });
        let slope: f64 = slopes.into_iter().sum();
        if !(slope < 0.0 && slope.is_finite()) {
            return;
        }
        let energy = |length: f64| {
            let there: Vec<DVec2> =
                collect(self.positions.len(), |v| self.positions[v] + along(v) * length);
            self.tangle(&there).energy(epsilon)
        };
        let mut search = Search::new(energy(0.0), slope);
        let mut next = Some((2.0 * self.length).clamp(1e-6, 1e3));
        while let Some(length) = next {
            next = search.tried(length, Some(energy(length)));
        }
        if let Some((length, _)) = search.best() {
            let free = self.problem.free_count();
            update(&mut self.positions[..free], |v, at| *at += along(v) * length);
            self.length = length;
        }
    }

    /// Replaces all target areas by their mean, and returns the former target areas.
    pub(super) fn equalize_targets(&mut self) -> Vec<f64> {
        let mean = self.targets.iter().sum::<f64>() / self.targets.len() as f64;
        let equal = vec![mean; self.targets.len()];
        std::mem::replace(&mut self.targets, equal)
    }

    /// Sets the target areas of all vertices.
    pub(super) fn set_targets(&mut self, targets: Vec<f64>) {
        self.targets = targets;
    }

    /// Returns a corner, seen from its first vertex: a triangle, or the sheared corner of a quadrilateral if it `is_right`.
    pub(super) fn corner(&self, is_right: bool, vertices: &[u32; 3]) -> Corner<f64> {
        self.tangle(&self.positions).corner(is_right, vertices)
    }

    /// Returns the energy of all triangles.
    pub(super) fn energy(&self, epsilon: f64) -> f64 {
        self.tangle(&self.positions).energy(epsilon)
    }

    /// Returns the gradient of the energy by the positions of the free vertices, zero outside the region.
    pub(super) fn gradient(&self, region: &Region, epsilon: f64) -> Vec<DVec2> {
        let mut gradient = vec![DVec2::ZERO; self.problem.free_count()];
        for batches in &region.vertices {
            let found = self.tangle(&self.positions).gradients(batches, epsilon);
            for (batch, found) in batches.iter().zip(found) {
                for (&v, found) in batch.iter().zip(found) {
                    gradient[v as usize] = found;
                }
            }
        }
        gradient
    }

    /// Moves every vertex that is not held to the weighted mean of its neighbors, by conjugate gradients preconditioned
    /// by the levels. If held vertices form a convex boundary, no triangle inside is inverted (Tutte 1963). Elsewhere,
    /// the means are only a start.
    pub(crate) fn make_harmonic(&mut self, hierarchy: &Hierarchy, held: &[bool]) {
        const ITERATIONS: usize = 200;
        let free = self.problem.free_count();
        let problem = self.problem;
        // The weighted sum of the differences to the neighbors, zero for held vertices.
        let differences = |v: usize, at: &(dyn Fn(usize) -> DVec2 + Sync)| -> DVec2 {
            if held[v] {
                return DVec2::ZERO;
            }
            let here = at(v);
            let ring = problem.neighbors(v as u32).map(|k| k as usize);
            ring.map(|k| (here - at(k)) * f64::from(hierarchy.weight(v, k))).sum()
        };
        let of_free = |residual: &[DVec2]| -> Vec<DVec2> {
            let mut found = preconditioned(hierarchy, problem, residual);
            update(&mut found, |v, found| {
                if held[v] {
                    *found = DVec2::ZERO;
                }
            });
            found
        };
        // Both coordinates are solved for at once, with separate step lengths.
        let dot = |a: &[DVec2], b: &[DVec2]| -> DVec2 {
            let parts = map_ranges(free, CHUNK, |range| {
                a[range.clone()].iter().zip(&b[range]).map(|(a, b)| a * b).sum::<DVec2>()
            });
            parts.into_iter().sum()
        };
        let ratio = |a: DVec2, b: DVec2| {
            DVec2::new(
                if b.x == 0.0 { 0.0 } else { a.x / b.x },
                if b.y == 0.0 { 0.0 } else { a.y / b.y },
            )
        };
        let mut residual: Vec<DVec2> = collect(free, |v| -differences(v, &|k| self.positions[k]));
        let mut z = of_free(&residual);
        let mut direction = z.clone();
        let mut norm = dot(&residual, &z);
        let enough = norm * 1e-16;
        for _ in 0..ITERATIONS {
            if norm.x <= enough.x && norm.y <= enough.y {
                break;
            }
            let of = |k: usize| direction.get(k).copied().unwrap_or(DVec2::ZERO);
            let applied: Vec<DVec2> = collect(free, |v| differences(v, &of));
            let length = ratio(norm, dot(&direction, &applied));
            update(&mut self.positions[..free], |v, at| *at += length * direction[v]);
            update(&mut residual, |v, residual| *residual -= length * applied[v]);
            z = of_free(&residual);
            let next = dot(&residual, &z);
            let share = ratio(next, norm);
            norm = next;
            update(&mut direction, |v, direction| *direction = z[v] + share * *direction);
        }
    }
}

/// Returns a gradient multiplied by the inverse Hessian that the levels approximate; a zero gradient for a gradient that
/// is zero.
fn preconditioned(hierarchy: &Hierarchy, problem: &Problem, gradient: &[DVec2]) -> Vec<DVec2> {
    // The levels compute in single precision, whose range a gradient near flat triangles may exceed.
    let most = largest(gradient);
    if most == 0.0 {
        return vec![DVec2::ZERO; gradient.len()];
    }
    let scaled: Vec<Vec2> = collect(gradient.len(), |v| (gradient[v] / most).as_vec2());
    let coarse = now(correction(hierarchy, problem, &scaled));
    let diagonal = hierarchy.inverse_diagonal();
    collect(gradient.len(), |v| gradient[v] * f64::from(diagonal[v]) - coarse[v].as_dvec2() * most)
}

/// Returns the largest absolute coordinate of the vectors, 0 if there are none.
fn largest(vectors: &[DVec2]) -> f64 {
    let parts = map_parts(vectors.chunks(CHUNK), |_, part| {
        part.iter().fold(0.0, |most: f64, v| most.max(v.abs().max_element()))
    });
    parts.into_iter().fold(0.0, f64::max)
}

/// Applies `change` to each vector and its index, on all threads.
pub(super) fn update(vectors: &mut [DVec2], change: impl Fn(usize, &mut DVec2) + Sync) {
    for_each_chunk(vectors, CHUNK, |first, vectors| {
        vectors.iter_mut().enumerate().for_each(|(i, vector)| change(first + i, vector));
    });
}
