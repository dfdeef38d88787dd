//! The coarser levels of a mesh: aggregates, and graph Laplacians on them.

use crate::layout::Problem;
use crate::parallel::collect;
use crate::run::multilevel::aggregate::{Aggregates, NONE};
use crate::run::multilevel::dense;
use crate::run::multilevel::sparse::Sparse;

/// The most unknowns of a level that is solved directly.
const DIRECT: usize = 96;

/// Damping factor of the Jacobi step that smooths the prolongation.
pub(crate) const SMOOTHING: f32 = 0.9;

/// Coefficients of two steps of the Chebyshev iteration for D⁻¹A over [0.45, 1.8], the upper three quarters of its
/// spectrum, which is assumed to end at 1.8. In order: the factor of D⁻¹r in the first step d, then the factors of d
/// and of D⁻¹r in the second step.
pub(crate) const CHEBYSHEV: [f32; 3] = {
    let (center, radius) = (0.625 * 1.8, 0.375 * 1.8);
    let (first, second) = (radius / center, 1.0 / (2.0 * center / radius - radius / center));
    [1.0 / center, first * second, 2.0 * second / radius]
};

/// Two unknowns of a coarse level count as neighbors if the matrix entry between them is at least this share of the
/// geometric mean of their diagonal entries.
const STRONG: f32 = 0.1;

/// A hierarchy of graph Laplacians that approximate the Hessian of the objective. The unknowns of level 0 are the free
/// vertices. Only its aggregates and weights are stored, as its matrix follows from the one-rings.
pub(crate) struct Hierarchy {
    aggregates: Aggregates,
    member_start: Vec<u32>,
    member: Vec<u32>,
    root: Vec<f32>,
    /// The roots that the levels were built from and then fitted to, in this order, before `root`.
    earlier: Vec<Vec<f32>>,
    inverse_diagonal: Vec<f32>,
    levels: Vec<Level>,
}

/// A level coarser than the free vertices.
pub(crate) struct Level {
    pub(crate) operator: Sparse,
    /// The reciprocals of the diagonal entries of the operator.
    pub(crate) inverse_diagonal: Vec<f32>,
    pub(crate) coarser: Coarser,
}

/// The next coarser level, or how this one is solved.
pub(crate) enum Coarser {
    /// A level with fewer unknowns, and the transfer to it.
    Level { prolongation: Sparse, restriction: Sparse },
    /// No further level: this one is solved by the inverse of its operator, in row-major order.
    Direct(Vec<f32>),
    /// No further level: no two unknowns are neighbors, so smoothing is enough.
    Nothing,
}

impl Hierarchy {
    /// Builds the levels. `roots` has the square root of the objective's stiffness at each free vertex. The weight of
    /// an edge is the product of the roots at its ends.
    pub(crate) fn new(problem: &Problem, roots: Vec<f32>) -> Self {
        Self::with_roots(problem, |_| true, || usable(roots))
    }

    /// Builds the levels for untangling. The weights are the reciprocals of the areas that elements should have at each
    /// vertex. Free vertices that are `held` are not moved by corrections.
    pub(crate) fn of_sizes(problem: &Problem, areas: &[f64], held: &[bool]) -> Self {
        let root = |area: &f64| (0.5 / area).sqrt() as f32;
        let roots = || areas[..problem.free_count()].iter().map(root).collect();
        Self::with_roots(problem, |v| !held[v], roots)
    }

    /// Builds the levels from the square roots of stiffness that `roots` computes for the free vertices, of which only those
    /// that `moves` names are unknowns.
    fn with_roots(
        problem: &Problem,
        moves: impl Fn(usize) -> bool + Sync,
        roots: impl FnOnce() -> Vec<f32> + Send,
    ) -> Self {
        // Aggregation is serial, so the weights are computed at the same time.
        let (aggregates, root) = rayon::join(|| aggregates(problem, &moves), roots);
        let (member_start, member) = aggregates.members();
        let mut hierarchy = Self {
            aggregates,
            member_start,
            member,
            root,
            earlier: Vec::new(),
            inverse_diagonal: Vec::new(),
            levels: Vec::new(),
        };
        hierarchy.inverse_diagonal = hierarchy.diagonal_inverted(problem);
        hierarchy.levels = levels(hierarchy.first_coarse_operator(problem, &moves));
        hierarchy
    }

    /// Fits the levels to new `roots`. Aggregates stay the same, and couplings between them are scaled by the average
    /// change of their members. Roots change by nearly the same factors in neighboring aggregates, so this is close to
    /// the Galerkin operator at a small part of the work.
    pub(crate) fn fitted_to(mut self, problem: &Problem, roots: Vec<f32>) -> Self {
        let root = usable(roots);
        let mean = |members: &[u32]| {
            let factor = |&v: &u32| root[v as usize] / self.root[v as usize];
            members.iter().map(factor).sum::<f32>() / members.len() as f32
        };
        let start = &self.member_start;
        let mut factors = collect(start.len() - 1, |aggregate| {
            mean(&self.member[start[aggregate] as usize..start[aggregate + 1] as usize])
        });
        let before = std::mem::replace(&mut self.root, root);
        self.earlier.push(before);
        self.inverse_diagonal = self.diagonal_inverted(problem);
        for Level { operator, inverse_diagonal, coarser } in &mut self.levels {
            operator.scale_couplings(&factors);
            *inverse_diagonal = operator.diagonal_inverted();
            match coarser {
                Coarser::Level { restriction, .. } => factors = restriction.means(&factors),
                Coarser::Direct(inverse) => *inverse = dense::inverse(operator),
                Coarser::Nothing => {}
            }
        }
        self
    }

    /// Returns the data from which the same levels can be made again: the roots that they were built from, and then
    /// those that they were fitted to, in order.
    pub(crate) fn recipe(&self) -> Vec<Vec<f32>> {
        self.earlier.iter().chain([&self.root]).cloned().collect()
    }

    /// Makes the levels of a [`recipe`](Self::recipe). `None` if it is empty or from another mesh.
    pub(crate) fn of_recipe(problem: &Problem, recipe: &[Vec<f32>]) -> Option<Self> {
        let (built_from, fitted_to) = recipe.split_first()?;
        if recipe.iter().any(|roots| roots.len() != problem.free_count()) {
            return None;
        }
        let built = Self::new(problem, built_from.clone());
        Some(fitted_to.iter().fold(built, |levels, roots| levels.fitted_to(problem, roots.clone())))
    }

    /// Returns the reciprocal of each free vertex's diagonal entry, which follows from the weights.
    fn diagonal_inverted(&self, problem: &Problem) -> Vec<f32> {
        let diagonal =
            |v: usize| neighbors(problem, v).map(|k| self.weight(v, k as usize)).sum::<f32>();
        collect(problem.free_count(), |v| 1.0 / diagonal(v))
    }

    /// Returns the Galerkin operator on the aggregates. The prolongation to the vertices is not stored, as it follows
    /// from the aggregates and the one-rings.
    fn first_coarse_operator(
        &self,
        problem: &Problem,
        moves: &(impl Fn(usize) -> bool + Sync),
    ) -> Sparse {
        let free = problem.free_count();
        let of = &self.aggregates.of;
        let free_neighbors = |v: usize| {
            let neighbors = neighbors(problem, v).map(|k| k as usize);
            neighbors.filter(move |&k| k < free && moves(k))
        };
        // The weight of an edge is the product of two roots, so A = R (E - N) R, with R the diagonal matrix of the
        // roots, E diagonal, and N the adjacency matrix. Therefore `prolongation` is R P here, and the matrix in the
        // product is E - N, with entries -1 off the diagonal.
        let (root, inverse) = (&self.root, &self.inverse_diagonal);
        let inverse_e = |v: usize| inverse[v] * root[v] * root[v];
        let prolongation = Sparse::from_rows(free, |v, sum| {
            if !moves(v) {
                return;
            }
            if of[v] != NONE {
                sum.add(of[v], (1.0 - SMOOTHING) * root[v]);
            }
            let share = SMOOTHING * inverse_e(v);
            for k in free_neighbors(v).filter(|&k| of[k] != NONE) {
                sum.add(of[k], share * root[k]);
            }
        });
        let restriction = prolongation.transposed(self.aggregates.count);
        Sparse::galerkin(&prolongation, &restriction, |v, factor, sum| {
            sum.add(v as u32, factor / inverse_e(v));
            for k in free_neighbors(v) {
                sum.add(k as u32, -factor);
            }
        })
    }

    /// Returns the weight of the edge from a free vertex `v` to its neighbor `k`.
    #[inline]
    pub(crate) fn weight(&self, v: usize, k: usize) -> f32 {
        let near = self.root[v];
        // Fixed vertices have no root, so the free vertex's root is used twice.
        near * self.root.get(k).copied().unwrap_or(near)
    }

    /// The square root of the stiffness at each free vertex. The weight of an edge is the product of the roots at its
    /// ends.
    pub(crate) fn roots(&self) -> &[f32] {
        &self.root
    }

    /// The aggregate of each free vertex, [`NONE`] if the vertex has no free neighbor.
    pub(crate) fn aggregate_of(&self) -> &[u32] {
        &self.aggregates.of
    }

    /// Where the members of each aggregate start in [`Self::members`], and one past the last.
    pub(crate) fn member_starts(&self) -> &[u32] {
        &self.member_start
    }

    /// The members of all aggregates, aggregate by aggregate.
    pub(crate) fn members(&self) -> &[u32] {
        &self.member
    }

    /// The reciprocal of each free vertex's diagonal entry.
    pub(crate) fn inverse_diagonal(&self) -> &[f32] {
        &self.inverse_diagonal
    }

    /// The coarse levels, finest first.
    pub(crate) fn levels(&self) -> &[Level] {
        &self.levels
    }
}

/// Makes the coarse levels, given the operator of the finest of them.
fn levels(mut operator: Sparse) -> Vec<Level> {
    let mut levels = Vec::new();
    loop {
        let n = operator.rows();
        let inverse_diagonal = operator.diagonal_inverted();
        if n <= DIRECT {
            let coarser = Coarser::Direct(dense::inverse(&operator));
            levels.push(Level { operator, inverse_diagonal, coarser });
            return levels;
        }
        let scale = &inverse_diagonal;
        let neighbors = |i: usize| {
            let strong = move |&(k, value): &(usize, f32)| {
                k != i && value * value * scale[i] * scale[k] >= STRONG * STRONG
            };
            operator.row(i).filter(strong).map(|(k, _)| k as u32)
        };
        let groups = Aggregates::new(n, neighbors);
        if groups.count == 0 {
            levels.push(Level { operator, inverse_diagonal, coarser: Coarser::Nothing });
            return levels;
        }
        let prolongation = Sparse::from_rows(n, |i, sum| {
            for (k, value) in operator.row(i).filter(|&(k, _)| groups.of[k] != NONE) {
                let own = if k == i { 1.0 } else { 0.0 };
                sum.add(groups.of[k], own - SMOOTHING * inverse_diagonal[i] * value);
            }
        });
        let restriction = prolongation.transposed(groups.count);
        let coarse = Sparse::galerkin(&prolongation, &restriction, |i, factor, sum| {
            operator.row(i).for_each(|(k, value)| sum.add(k as u32, factor * value));
        });
        levels.push(Level {
            operator,
            inverse_diagonal,
            coarser: Coarser::Level { prolongation, restriction },
        });
        operator = coarse;
    }
}

/// Makes the aggregates of the free vertices. With equal weights, the share that [`STRONG`] bounds is the inverse of
/// the geometric mean of the numbers of neighbors. So a vertex with fifty neighbors does not form one aggregate with
/// all of them: they would share one correction, and the prolongation to that vertex could not be smoothed.
fn aggregates(problem: &Problem, moves: &(impl Fn(usize) -> bool + Sync)) -> Aggregates {
    let free = problem.free_count();
    let degree = |v: u32| problem.ring_of(v).len() as f32;
    // A vertex that does not move has none, and so is in no aggregate.
    let free_neighbors = |v: usize| {
        let joins = move |&k: &u32| (k as usize) < free && moves(k as usize) && moves(v);
        neighbors(problem, v).filter(joins)
    };
    let strong_neighbors = |v: usize| {
        let most = 1.0 / (STRONG * STRONG * degree(v as u32));
        free_neighbors(v).filter(move |&k| degree(k) <= most)
    };
    Aggregates::new(free, strong_neighbors).with_the_rest(free_neighbors)
}

/// All neighbors of a free vertex.
fn neighbors(problem: &Problem, v: usize) -> impl Iterator<Item = u32> + '_ {
    let start = problem.ring_start();
    problem.ring()[start[v] as usize..start[v + 1] as usize].iter().copied()
}

/// Replaces roots that are not positive and finite by the least of the others, so that every weight is positive and
/// finite.
fn usable(mut roots: Vec<f32>) -> Vec<f32> {
    let is_usable = |root: &f32| *root > 0.0 && *root < f32::INFINITY;
    let least = roots.iter().copied().filter(is_usable).fold(f32::INFINITY, f32::min);
    let least = if least.is_finite() { least } else { 1.0 };
    for root in roots.iter_mut().filter(|root| !is_usable(root)) {
        *root = least;
    }
    roots
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout::prepare;
    use crate::mesh::Mesh;

    #[test]
    fn a_vertex_of_high_degree_shares_its_aggregate_with_a_few() {
        let (around, rings) = (30u32, 6u32);
        let mut mesh = Mesh::default();
        for ring in 0..rings {
            for i in 0..around {
                let turn = (f64::from(i) + 0.5 * f64::from(ring % 2)) / f64::from(around);
                let (y, x) = (std::f64::consts::TAU * turn).sin_cos();
                let radius = f64::from(rings - ring);
                mesh.points.push([radius * x, radius * y]);
            }
        }
        let at = |ring: u32, i: u32| ring * around + i % around;
        for ring in 0..rings - 1 {
            for i in 0..around {
                let (a, b) = (at(ring, i), at(ring, i + 1));
                let (c, d) = (at(ring + 1, i), at(ring + 1, i + 1));
                let even = [[a, b, c], [b, d, c]];
                let odd = [[a, b, d], [a, d, c]];
                mesh.triangles.extend(if ring % 2 == 0 { even } else { odd });
            }
        }
        let center = mesh.points.len() as u32;
        mesh.points.push([0.0, 0.0]);
        let last = rings - 1;
        mesh.triangles.extend((0..around).map(|i| [at(last, i), at(last, i + 1), center]));
        let problem = prepare(&mesh).unwrap().1;
        let hub = (0..problem.free_count())
            .find(|&v| problem.ring_of(v as u32).len() == around as usize)
            .unwrap();
        let groups = aggregates(&problem, &|_| true);
        assert!(groups.of.iter().all(|&group| group != NONE));
        let with_hub = groups.of.iter().filter(|&&group| group == groups.of[hub]).count();
        assert!(with_hub < around as usize / 2, "{with_hub} vertices");
    }
}
