//! The positions of a mesh while it is untangled, and what moves them.

use glam::{DVec2, Vec2};

use crate::cpu::correction;
use crate::layout::Problem;
use crate::parallel::{collect, map_parts, map_ranges};
use crate::run::multilevel::{Hierarchy, Search};
use crate::untangle::cuts::{Short, cut};
use crate::untangle::energy::{Corner, Expansion};

/// The most lengths that are tried along a Newton step.
const TRIALS: u32 = 10;
/// Share of the predicted decrease that a trial must reach (Armijo).
const SUFFICIENT_DECREASE: f64 = 1e-4;
/// Number of triangles of one task.
const CHUNK: usize = 1 << 12;

/// Positions and what they are judged by.
pub(crate) struct State<'p> {
    problem: &'p Problem,
    pub(crate) positions: Vec<DVec2>,
    /// The target area at each vertex.
    targets: Vec<f64>,
    /// The length of the last global step.
    length: f64,
}

/// The areas of the triangles in a region.
#[derive(Clone, Copy)]
pub(crate) struct Assessment {
    /// The least area, in units of its target.
    pub(crate) least: f64,
    /// Number of triangles whose rounded area is not positive.
    pub(crate) bad: usize,
}

impl Assessment {
    const EMPTY: Self = Self { least: f64::INFINITY, bad: 0 };

    fn and(self, other: Self) -> Self {
        Self { least: self.least.min(other.least), bad: self.bad + other.bad }
    }
}

/// The vertices that move, and the triangles that they change.
pub(crate) struct Region {
    /// By color.
    vertices: Vec<Vec<u32>>,
    /// By number in the problem.
    triangles: Vec<u32>,
}

impl Region {
    /// The free vertices of some triangles, and those within `rings` edges of them.
    pub(crate) fn around(problem: &Problem, bad: &[u32], rings: u32) -> Region {
        let free = problem.free_count();
        let mut inside = vec![false; problem.positions().len()];
        let mut front = Vec::new();
        let triangles = problem.triangles();
        for v in bad.iter().flat_map(|&t| triangles[t as usize]) {
            if !std::mem::replace(&mut inside[v as usize], true) {
                front.push(v);
            }
        }
        for _ in 0..rings {
            let mut next = Vec::new();
            for &v in front.iter().filter(|&&v| (v as usize) < free) {
                for &k in problem.ring_of(v) {
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
                .map(|c| c.clone().filter(|&v| moves(v)).collect())
                .collect(),
            triangles: (0..triangles.len() as u32)
                .filter(|&t| triangles[t as usize].iter().any(|&v| moves(v)))
                .collect(),
        }
    }

    /// All free vertices.
    pub(crate) fn whole(problem: &Problem) -> Region {
        Region {
            vertices: problem.colors().iter().map(|color| color.clone().collect()).collect(),
            triangles: (0..problem.triangles().len() as u32).collect(),
        }
    }
}

impl<'p> State<'p> {
    pub(crate) fn new(problem: &'p Problem, targets: Vec<f64>) -> Self {
        Self { problem, positions: problem.positions().to_vec(), targets, length: 0.1 }
    }

    /// The triangle of a vertex at `at` and two others.
    #[inline]
    fn corner(&self, v: u32, [k, l]: [u32; 2], at: DVec2) -> Corner {
        let target = |v: u32| self.targets[v as usize];
        Corner {
            edges: [k, l].map(|v| self.positions[v as usize] - at),
            target: (target(v) + target(k) + target(l)) / 3.0,
        }
    }

    /// The triangle of this number in the problem, at some positions.
    #[inline]
    fn triangle(&self, t: u32, at: impl Fn(u32) -> DVec2) -> Corner {
        let corners = self.problem.triangles()[t as usize];
        let [p, q, r] = corners.map(at);
        let target = corners.map(|v| self.targets[v as usize]).iter().sum::<f64>() / 3.0;
        Corner { edges: [q - p, r - p], target }
    }

    /// The triangles around a free vertex, with the vertex at `at`.
    #[inline]
    fn patch(&self, v: u32, at: DVec2) -> impl Iterator<Item = Corner> + '_ {
        let ring = self.problem.ring_of(v);
        let next = ring.iter().skip(1).chain(ring.first());
        ring.iter().zip(next).map(move |(&k, &l)| self.corner(v, [k, l], at))
    }

    /// How far the region is from being untangled.
    pub(crate) fn assess(&self, region: &Region) -> Assessment {
        let area = |&t: &u32| self.triangle(t, |v| self.positions[v as usize]).area();
        let parts = map_parts(region.triangles.chunks(CHUNK), |_, part| {
            part.iter().map(area).fold(Assessment::EMPTY, |all, area| {
                all.and(Assessment { least: area, bad: usize::from(area.is_nan() || area <= 0.0) })
            })
        });
        parts.into_iter().fold(Assessment::EMPTY, Assessment::and)
    }

    /// Visits every vertex of the region once, color by color.
    pub(crate) fn sweep(&mut self, region: &Region, epsilon: f64) {
        for vertices in &region.vertices {
            let moved = collect(vertices.len(), |i| self.visited(vertices[i], epsilon));
            for (&v, to) in vertices.iter().zip(moved) {
                self.positions[v as usize] = to;
            }
        }
    }

    /// Where a Newton step with a line search takes a vertex.
    fn visited(&self, v: u32, epsilon: f64) -> DVec2 {
        let at = self.positions[v as usize];
        let mut here = Expansion::default();
        self.patch(v, at).for_each(|corner| here.add(&corner.expansion(epsilon)));
        let direction = here.descent();
        let slope = direction.dot(here.gradient);
        // Not so where the direction is not finite.
        if slope < 0.0 && slope.is_finite() {
            let mut length = 1.0;
            for _ in 0..TRIALS {
                let to = at + direction * length;
                let there: f64 = self.patch(v, to).map(|corner| corner.energy(epsilon)).sum();
                if there <= here.value + SUFFICIENT_DECREASE * length * slope {
                    return to;
                }
                length *= 0.5;
            }
        }
        at
    }

    /// Cuts the mesh and puts vertices on the cuts. Returns which vertices are to be held: those, and all that are not free.
    pub(crate) fn cut(&mut self, short: Short) -> Vec<bool> {
        let cuts = cut(self.problem, &self.targets, &self.positions, short);
        self.positions = cuts.positions;
        cuts.held
    }

    /// The coarser levels for [`global_step`](Self::global_step) and [`make_harmonic`](Self::make_harmonic).
    pub(crate) fn hierarchy(&self) -> Hierarchy {
        Hierarchy::of_sizes(self.problem, &self.targets)
    }

    /// Moves all free vertices along a correction from the coarser levels, as far as the energy falls.
    pub(crate) fn global_step(&mut self, hierarchy: &Hierarchy, epsilon: f64) {
        let gradient: Vec<DVec2> = collect(self.problem.free_count(), |v| {
            let corners = self.patch(v as u32, self.positions[v]);
            corners.map(|corner| corner.expansion(epsilon).gradient).sum()
        });
        // The levels compute in single precision, and near flat triangles the gradient may be beyond it.
        let most = gradient.iter().fold(0.0, |most: f64, g| most.max(g.abs().max_element()));
        let unit = if most > 0.0 && most.is_finite() { 1.0 / most } else { return };
        let scaled: Vec<Vec2> = gradient.iter().map(|g| (g * unit).as_vec2()).collect();
        let direction = correction(hierarchy, self.problem, &scaled);
        let along = |v: usize| direction.get(v).map_or(DVec2::ZERO, |d| d.as_dvec2() * most);
        let slope: f64 = gradient.iter().enumerate().map(|(v, g)| g.dot(along(v))).sum();
        if !(slope < 0.0 && slope.is_finite()) {
            return;
        }
        let energy = |length: f64| {
            let there: Vec<DVec2> =
                collect(self.positions.len(), |v| self.positions[v] + along(v) * length);
            let at = |v: u32| there[v as usize];
            let sums = map_ranges(self.problem.triangles().len(), CHUNK, |range| {
                range.map(|t| self.triangle(t as u32, at).energy(epsilon)).sum::<f64>()
            });
            sums.into_iter().sum::<f64>()
        };
        let mut search = Search::new(energy(0.0), slope);
        let mut next = Some((2.0 * self.length).clamp(1e-6, 1e3));
        while let Some(length) = next {
            next = search.tried(length, Some(energy(length)));
        }
        if let Some((length, _)) = search.best() {
            for v in 0..self.problem.free_count() {
                self.positions[v] += along(v) * length;
            }
            self.length = length;
        }
    }

    /// Puts every vertex that is not held at the weighted mean of its neighbors. Within convex boundaries of held vertices no
    /// triangle is then inverted (Tutte 1963); elsewhere it is a start. By conjugate gradients, preconditioned by the levels.
    pub(crate) fn make_harmonic(&mut self, hierarchy: &Hierarchy, held: &[bool]) {
        const ITERATIONS: usize = 200;
        let free = self.problem.free_count();
        let problem = self.problem;
        // The weighted sum of the differences to the neighbors; nothing where a vertex is held.
        let differences = |v: usize, at: &(dyn Fn(usize) -> DVec2 + Sync)| -> DVec2 {
            if held[v] {
                return DVec2::ZERO;
            }
            let here = at(v);
            let ring = problem.ring_of(v as u32).iter().map(|&k| k as usize);
            ring.map(|k| (here - at(k)) * f64::from(hierarchy.weight(v, k))).sum()
        };
        let preconditioned = |residual: &[DVec2]| -> Vec<DVec2> {
            let most = residual.iter().fold(0.0, |most: f64, r| most.max(r.abs().max_element()));
            if most == 0.0 {
                return vec![DVec2::ZERO; residual.len()];
            }
            let scaled: Vec<Vec2> = residual.iter().map(|r| (r / most).as_vec2()).collect();
            let coarse = correction(hierarchy, problem, &scaled);
            let diagonal = hierarchy.inverse_diagonal();
            collect(free, |v| match held[v] {
                true => DVec2::ZERO,
                false => residual[v] * f64::from(diagonal[v]) - coarse[v].as_dvec2() * most,
            })
        };
        // Both coordinates at once, each with step lengths of its own.
        let dot = |a: &[DVec2], b: &[DVec2]| -> DVec2 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
        let ratio = |a: DVec2, b: DVec2| {
            DVec2::new(
                if b.x == 0.0 { 0.0 } else { a.x / b.x },
                if b.y == 0.0 { 0.0 } else { a.y / b.y },
            )
        };
        let mut residual: Vec<DVec2> = collect(free, |v| -differences(v, &|k| self.positions[k]));
        let mut z = preconditioned(&residual);
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
            for v in 0..free {
                self.positions[v] += length * direction[v];
                residual[v] -= length * applied[v];
            }
            z = preconditioned(&residual);
            let next = dot(&residual, &z);
            let share = ratio(next, norm);
            norm = next;
            for (d, z) in direction.iter_mut().zip(&z) {
                *d = *z + share * *d;
            }
        }
    }
}
