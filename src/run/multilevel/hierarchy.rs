//! The coarser levels of a mesh: aggregates of vertices, with graph Laplacians on the aggregates.

use crate::layout::Problem;
use crate::parallel::pace::now;
use crate::parallel::{collect, paced};
use crate::run::multilevel::aggregate::{Aggregates, NONE};
use crate::run::multilevel::dense;
use crate::run::multilevel::sparse::Sparse;

/// Largest number of unknowns of a level that is solved directly.
const DIRECT: usize = 96;

/// Damping factor of the Jacobi step that smooths the prolongation.
pub(crate) const SMOOTHING: f32 = 0.9;

/// [`SMOOTHING`] for the vertices of a mesh with quadrilaterals: (4/3)/2, as D⁻¹A of a lattice of squares has eigenvalues up to
/// 2, and that of a lattice of triangles up to 1.5.
pub(crate) const OF_QUADRILATERALS: f32 = 0.667;

/// Coefficients of two steps of the Chebyshev iteration for D⁻¹A over [0.45, 1.8], the upper three quarters of the
/// spectrum, whose end is assumed at 1.8. The first coefficient is the factor on D⁻¹r in the first step d. The other
/// two are the factors on d and on D⁻¹r in the second step.
pub(crate) const CHEBYSHEV: [f32; 3] = {
    let (center, radius) = (0.625 * 1.8, 0.375 * 1.8);
    let (first, second) = (radius / center, 1.0 / (2.0 * center / radius - radius / center));
    [1.0 / center, first * second, 2.0 * second / radius]
};

/// Smallest ratio of a matrix entry to the geometric mean of the diagonal entries, at which two unknowns of a coarse
/// level count as neighbors.
const STRONG: f32 = 0.1;

/// A hierarchy of graph Laplacians that approximate the Hessian of the objective. The unknowns of level 0 are the free
/// vertices. Level 0 stores only aggregates and weights, as its matrix follows from the one-rings.
pub(crate) struct Hierarchy {
    aggregates: Aggregates,
    member_start: Vec<u32>,
    member: Vec<u32>,
    root: Vec<f32>,
    /// Roots of the build and of each fit before `root`, in order.
    earlier: Vec<Vec<f32>>,
    inverse_diagonal: Vec<f32>,
    levels: Vec<Level>,
}

/// A level of aggregates, coarser than the free vertices.
pub(crate) struct Level {
    pub(crate) operator: Sparse,
    /// Reciprocals of the diagonal entries of the operator.
    pub(crate) inverse_diagonal: Vec<f32>,
    pub(crate) coarser: Coarser,
}

/// The next coarser level, or the solution on a level without a coarser one.
pub(crate) enum Coarser {
    /// Transfers between this level and a level with fewer unknowns.
    Level { prolongation: Sparse, restriction: Sparse },
    /// Inverse of the operator in row-major order, which solves the coarsest level.
    Direct(Vec<f32>),
    /// No coarser level: no two unknowns are neighbors, so smoothing is enough.
    Nothing,
}

impl Hierarchy {
    /// Builds the levels. `roots` has the square root of the objective's stiffness at each free vertex. The weight of
    /// an edge is the product of the roots at its two ends.
    pub(crate) async fn new(problem: &Problem, roots: Vec<f32>) -> Self {
        Self::with_roots(problem, |_| true, usable(roots)).await
    }

    /// Builds the levels for untangling, with the reciprocals of the target areas at the vertices as weights.
    /// Corrections move no free vertex that is `held`.
    pub(crate) fn of_sizes(problem: &Problem, areas: &[f64], held: &[bool]) -> Self {
        let root = |area: &f64| (0.5 / area).sqrt() as f32;
        let roots = collect(problem.free_count(), |v| root(&areas[v]));
        now(Self::with_roots(problem, |v| !held[v], roots))
    }

    /// Builds the levels from the square roots of stiffness at the free vertices. Unknowns are only the vertices for
    /// which `moves` returns true.
    async fn with_roots(
        problem: &Problem,
        moves: impl Fn(usize) -> bool + Sync + Send,
        root: Vec<f32>,
    ) -> Self {
        let aggregates = aggregates(problem, &moves).await;
        let (member_start, member) = aggregates.members().await;
        let mut hierarchy = Self {
            aggregates,
            member_start,
            member,
            root,
            earlier: Vec::new(),
            inverse_diagonal: Vec::new(),
            levels: Vec::new(),
        };
        hierarchy.inverse_diagonal = hierarchy.diagonal_inverted(problem).await;
        hierarchy.levels = levels(hierarchy.first_coarse_operator(problem, &moves).await).await;
        hierarchy
    }

    /// Fits the levels to new `roots`. Aggregates stay unchanged, and the couplings between aggregates are scaled by
    /// the average change of the roots of their members. Roots of neighboring aggregates change by nearly equal
    /// factors. Fitted levels are therefore close to Galerkin operators, for a small part of the work.
    pub(crate) async fn fitted_to(mut self, problem: &Problem, roots: Vec<f32>) -> Self {
        let root = usable(roots);
        let mean = |members: &[u32]| {
            let factor = |&v: &u32| root[v as usize] / self.root[v as usize];
            members.iter().map(factor).sum::<f32>() / members.len() as f32
        };
        let start = &self.member_start;
        let mut factors = paced::collect(start.len() - 1, |aggregate| {
            mean(&self.member[start[aggregate] as usize..start[aggregate + 1] as usize])
        })
        .await;
        let before = std::mem::replace(&mut self.root, root);
        self.earlier.push(before);
        self.inverse_diagonal = self.diagonal_inverted(problem).await;
        for Level { operator, inverse_diagonal, coarser } in &mut self.levels {
            operator.scale_couplings(&factors).await;
            *inverse_diagonal = operator.diagonal_inverted().await;
            match coarser {
                Coarser::Level { restriction, .. } => {
                    factors = restriction.means(&factors).await;
                }
                Coarser::Direct(inverse) => *inverse = dense::inverse(operator),
                Coarser::Nothing => {}
            }
        }
        self
    }

    /// Returns the data from which [`of_build_log`](Self::of_build_log) builds equal levels: the roots of the first
    /// build, followed by the roots of every fit.
    pub(crate) fn build_log(&self) -> Vec<Vec<f32>> {
        self.earlier.iter().chain([&self.root]).cloned().collect()
    }

    /// Builds the levels of a [`build_log`](Self::build_log). `None` if the log is empty or from another mesh.
    pub(crate) async fn of_build_log(problem: &Problem, build_log: &[Vec<f32>]) -> Option<Self> {
        let (built_from, fitted_to) = build_log.split_first()?;
        if build_log.iter().any(|roots| roots.len() != problem.free_count()) {
            return None;
        }
        let mut levels = Self::new(problem, built_from.clone()).await;
        for roots in fitted_to {
            levels = levels.fitted_to(problem, roots.clone()).await;
        }
        Some(levels)
    }

    /// Returns the damping factor of the Jacobi step that smooths the prolongation to the vertices.
    pub(crate) fn smoothing(problem: &Problem) -> f32 {
        match problem.has_quadrilaterals() {
            true => OF_QUADRILATERALS,
            false => SMOOTHING,
        }
    }

    /// Returns the reciprocal of the diagonal entry of each free vertex, the sum of the weights of its edges.
    async fn diagonal_inverted(&self, problem: &Problem) -> Vec<f32> {
        let diagonal =
            |v: usize| neighbors(problem, v).map(|k| self.weight(v, k as usize)).sum::<f32>();
        paced::collect(problem.free_count(), |v| 1.0 / diagonal(v)).await
    }

    /// Returns the Galerkin operator on the aggregates. The prolongation to the vertices is not stored, because
    /// aggregates and one-rings determine it.
    async fn first_coarse_operator(
        &self,
        problem: &Problem,
        moves: &(impl Fn(usize) -> bool + Sync + Send),
    ) -> Sparse {
        let free = problem.free_count();
        let of = &self.aggregates.of;
        let free_neighbors = |v: usize| {
            let neighbors = neighbors(problem, v).map(|k| k as usize);
            neighbors.filter(move |&k| k < free && moves(k))
        };
        // The weight of an edge is the product of two roots, so A = R (E - N) R, with R the diagonal matrix of the
        // roots, E diagonal, and N the adjacency matrix. Therefore `prolongation` is R P here, and the matrix in the
        // product is E - N, whose entries off the diagonal are -1.
        let (root, inverse) = (&self.root, &self.inverse_diagonal);
        let smoothing = Self::smoothing(problem);
        let inverse_e = |v: usize| inverse[v] * root[v] * root[v];
        let prolongation = Sparse::from_rows(free, |v, sum| {
            if !moves(v) {
                return;
            }
            if of[v] != NONE {
                sum.add(of[v], (1.0 - smoothing) * root[v]);
            }
            let share = smoothing * inverse_e(v);
            for k in free_neighbors(v).filter(|&k| of[k] != NONE) {
                sum.add(of[k], share * root[k]);
            }
        })
        .await;
        let restriction = prolongation.transposed(self.aggregates.count).await;
        Sparse::galerkin(&prolongation, &restriction, |v, factor, sum| {
            sum.add(v as u32, factor / inverse_e(v));
            for k in free_neighbors(v) {
                sum.add(k as u32, -factor);
            }
        })
        .await
    }

    /// Returns the weight of the edge from a free vertex `v` to its neighbor `k`.
    #[inline]
    pub(crate) fn weight(&self, v: usize, k: usize) -> f32 {
        let near = self.root[v];
        // Fixed vertices have no root, so the root of the free vertex counts twice.
        near * self.root.get(k).copied().unwrap_or(near)
    }

    /// Returns the square root of the stiffness at each free vertex. The weight of an edge is the product of the roots
    /// at its two ends.
    pub(crate) fn roots(&self) -> &[f32] {
        &self.root
    }

    /// Returns the aggregate of each free vertex, [`NONE`] for a vertex without free neighbors.
    pub(crate) fn aggregate_of(&self) -> &[u32] {
        &self.aggregates.of
    }

    /// Returns the offset of each aggregate in [`Self::members`], with the end of the last aggregate as a further
    /// entry.
    pub(crate) fn member_starts(&self) -> &[u32] {
        &self.member_start
    }

    /// Returns the members of all aggregates, aggregate by aggregate.
    pub(crate) fn members(&self) -> &[u32] {
        &self.member
    }

    /// Returns the reciprocal of the diagonal entry of each free vertex.
    pub(crate) fn inverse_diagonal(&self) -> &[f32] {
        &self.inverse_diagonal
    }

    /// Returns the coarse levels, finest first.
    pub(crate) fn levels(&self) -> &[Level] {
        &self.levels
    }
}

/// Builds the coarse levels, given the operator of the finest coarse level.
async fn levels(mut operator: Sparse) -> Vec<Level> {
    let mut levels = Vec::new();
    loop {
        let n = operator.rows();
        let inverse_diagonal = operator.diagonal_inverted().await;
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
        let groups = Aggregates::new(n, neighbors).await;
        if groups.count == 0 {
            levels.push(Level { operator, inverse_diagonal, coarser: Coarser::Nothing });
            return levels;
        }
        let prolongation = Sparse::from_rows(n, |i, sum| {
            for (k, value) in operator.row(i).filter(|&(k, _)| groups.of[k] != NONE) {
                let own = if k == i { 1.0 } else { 0.0 };
                sum.add(groups.of[k], own - SMOOTHING * inverse_diagonal[i] * value);
            }
        })
        .await;
        let restriction = prolongation.transposed(groups.count).await;
        let coarse = Sparse::galerkin(&prolongation, &restriction, |i, factor, sum| {
            operator.row(i).for_each(|(k, value)| sum.add(k as u32, factor * value));
        })
        .await;
        levels.push(Level {
            operator,
            inverse_diagonal,
            coarser: Coarser::Level { prolongation, restriction },
        });
        operator = coarse;
    }
}

/// Forms the aggregates of the free vertices. With equal weights, the ratio that [`STRONG`] bounds is the reciprocal of
/// the geometric mean of the two degrees. A vertex with fifty neighbors therefore forms no aggregate with all
/// neighbors. In such an aggregate, all vertices would share one correction, and the prolongation to the central vertex
/// could not be smoothed.
async fn aggregates(
    problem: &Problem,
    moves: &(impl Fn(usize) -> bool + Sync + Send),
) -> Aggregates {
    let free = problem.free_count();
    let degree = |v: u32| problem.ring_of(v).len() as f32;
    // A vertex that does not move has no free neighbors, and so belongs to no aggregate.
    // The opposite vertices of quadrilaterals join too: on a lattice of squares, an aggregate then has nine members.
    let free_neighbors = |v: usize| {
        let joins = move |&k: &u32| (k as usize) < free && moves(k as usize) && moves(v);
        problem.companions(v as u32).filter(joins)
    };
    let strong_neighbors = |v: usize| {
        let most = 1.0 / (STRONG * STRONG * degree(v as u32));
        free_neighbors(v).filter(move |&k| degree(k) <= most)
    };
    Aggregates::new(free, strong_neighbors).await.with_the_rest(free_neighbors).await
}

/// Returns all neighbors along edges of a free vertex, in the order of the one-ring.
fn neighbors(problem: &Problem, v: usize) -> impl Iterator<Item = u32> + '_ {
    problem.neighbors(v as u32)
}

/// Replaces roots that are not positive and finite by the smallest usable root, so that every weight is positive and
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
    use std::time::Duration;

    use super::*;
    use crate::layout::prepare;
    use crate::mesh::Mesh;
    use crate::parallel::pace::polled;

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
        let groups = now(aggregates(&problem, &|_| true));
        assert!(groups.of.iter().all(|&group| group != NONE));
        let with_hub = groups.of.iter().filter(|&&group| group == groups.of[hub]).count();
        assert!(with_hub < around as usize / 2, "{with_hub} vertices");
    }

    /// Each loop over ten thousand vertices, on one thread, has a pause, whatever the number of threads.
    #[test]
    fn a_hierarchy_is_built_and_fitted_in_many_polls_to_the_same_bits() {
        let side = 101u32;
        let points = (0..side * side).map(|k| [f64::from(k % side), f64::from(k / side)]).collect();
        let cells = (0..side * (side - 1)).filter(|k| k % side + 1 < side);
        let triangles = cells.flat_map(|k| [[k, k + 1, k + side + 1], [k, k + side + 1, k + side]]);
        let mesh = Mesh { points, triangles: triangles.collect(), ..Mesh::default() };
        let problem = prepare(&mesh).unwrap().1;
        let roots =
            |scale: f32| (0..problem.free_count()).map(|v| 1.0 + scale * v as f32).collect();
        let built = || Hierarchy::new(&problem, roots(1e-4));
        let (paced, polls) = polled(Duration::ZERO, built());
        assert!(polls >= 10, "{polls} polls");
        let (fitted, polls) = polled(Duration::ZERO, paced.fitted_to(&problem, roots(2e-4)));
        assert!(polls >= 2, "{polls} polls");
        let at_once = now(async { built().await.fitted_to(&problem, roots(2e-4)).await });
        assert_eq!(fitted.aggregate_of(), at_once.aggregate_of());
        assert_eq!(fitted.members(), at_once.members());
        assert_eq!(fitted.inverse_diagonal(), at_once.inverse_diagonal());
        assert_eq!(fitted.levels().len(), at_once.levels().len());
        for (level, expected) in fitted.levels().iter().zip(at_once.levels()) {
            assert_eq!(level.operator.columns(), expected.operator.columns());
            assert_eq!(level.operator.values(), expected.operator.values());
        }
    }
}
