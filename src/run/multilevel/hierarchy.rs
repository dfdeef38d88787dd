//! The levels of a mesh: aggregates, and the graph Laplacians on them.

use glam::DVec2;

use crate::layout::Problem;
use crate::metric::Stiffness;
use crate::parallel::collect;
use crate::run::multilevel::aggregate::{Aggregates, NONE};
use crate::run::multilevel::dense;
use crate::run::multilevel::sparse::Sparse;

/// Unknowns up to which a level is solved directly.
const DIRECT: usize = 96;

/// Share of a Jacobi step that smooths the prolongation.
pub(crate) const SMOOTHING: f32 = 0.9;

/// Two steps of Chebyshev's iteration for D⁻¹A over the upper three quarters of its spectrum, which is
/// taken to end at 1.8: the factor of D⁻¹r in the first step d, then of d and of D⁻¹r in the second.
pub(crate) const CHEBYSHEV: [f32; 3] = {
    let (center, radius) = (0.625 * 1.8, 0.375 * 1.8);
    let (first, second) = (radius / center, 1.0 / (2.0 * center / radius - radius / center));
    [1.0 / center, first * second, 2.0 * second / radius]
};

/// Two unknowns of a coarse level are taken for neighbors if the entry between them is at least this share of the
/// geometric mean of their diagonals.
const STRONG: f32 = 0.1;

/// A hierarchy of graph Laplacians that stand in for the Hessian of the objective. Level 0 are the free vertices; of
/// it only the aggregates and weights are kept, as its matrix follows from the one-rings.
pub(crate) struct Hierarchy {
    aggregates: Aggregates,
    member_start: Vec<u32>,
    member: Vec<u32>,
    root: Vec<f32>,
    inverse_diagonal: Vec<f32>,
    levels: Vec<Level>,
}

/// A level below the free vertices.
pub(crate) struct Level {
    pub(crate) operator: Sparse,
    /// The reciprocals of the operator's diagonal.
    pub(crate) inverse_diagonal: Vec<f32>,
    pub(crate) coarser: Coarser,
}

/// How a level goes on below.
pub(crate) enum Coarser {
    /// To a level of fewer unknowns.
    Level { prolongation: Sparse, restriction: Sparse },
    /// The inverse of the operator, row by row.
    Direct(Vec<f32>),
    /// There is nothing left to do.
    Nothing,
}

impl Hierarchy {
    /// Builds the levels for elements of the sizes they have at `positions`.
    pub(crate) fn new(problem: &Problem, positions: &[DVec2], stiffness: Stiffness) -> Self {
        let free = problem.free_count();
        let free_neighbors = |v| neighbors(problem, v).filter(move |&k| (k as usize) < free);
        // The former goes vertex by vertex.
        let (aggregates, root) = rayon::join(
            || Aggregates::new(free, free_neighbors),
            || roots(problem, positions, stiffness),
        );
        let (member_start, member) = aggregates.members();
        let mut hierarchy = Self {
            aggregates,
            member_start,
            member,
            root,
            inverse_diagonal: Vec::new(),
            levels: Vec::new(),
        };
        hierarchy.inverse_diagonal = hierarchy.diagonal_inverted(problem);
        hierarchy.levels = levels(hierarchy.first_coarse_operator(problem));
        hierarchy
    }

    /// The same levels for elements of the sizes they now have. Couplings of aggregates change as those of their
    /// members do on average, which is nearly Galerkin's operator again for a small part of the work: sizes
    /// change by factors that hardly differ from one aggregate to the next.
    pub(crate) fn resized(
        mut self,
        problem: &Problem,
        positions: &[DVec2],
        stiffness: Stiffness,
    ) -> Self {
        let root = roots(problem, positions, stiffness);
        let mean = |members: &[u32]| {
            let factor = |&v: &u32| root[v as usize] / self.root[v as usize];
            members.iter().map(factor).sum::<f32>() / members.len() as f32
        };
        let start = &self.member_start;
        let mut factors = collect(start.len() - 1, |aggregate| {
            mean(&self.member[start[aggregate] as usize..start[aggregate + 1] as usize])
        });
        self.root = root;
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

    fn diagonal_inverted(&self, problem: &Problem) -> Vec<f32> {
        let diagonal =
            |v: usize| neighbors(problem, v).map(|k| self.weight(v, k as usize)).sum::<f32>();
        collect(problem.free_count(), |v| 1.0 / diagonal(v))
    }

    /// Galerkin's operator on the aggregates. The prolongation to the vertices is not kept: it follows from
    /// the aggregates and the one-rings.
    fn first_coarse_operator(&self, problem: &Problem) -> Sparse {
        let free = problem.free_count();
        let of = &self.aggregates.of;
        let free_neighbors =
            |v: usize| neighbors(problem, v).map(|k| k as usize).filter(move |&k| k < free);
        // With the weights of edges taken apart, A = R (E - N) R: R are the roots, E is diagonal and N one for each
        // edge. So P goes with R, and around a vertex ones are summed.
        let (root, inverse) = (&self.root, &self.inverse_diagonal);
        let inverse_e = |v: usize| inverse[v] * root[v] * root[v];
        let prolongation = Sparse::from_rows(free, |v, sum| {
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

    /// Weight of the edge from a free vertex to a neighbor.
    #[inline]
    pub(crate) fn weight(&self, v: usize, k: usize) -> f32 {
        let near = self.root[v];
        // Of fixed vertices none is kept: they take that of whoever asks.
        near * self.root.get(k).copied().unwrap_or(near)
    }

    /// Of each free vertex the root of the stiffness over the size of its elements: the weight of an edge is the product
    /// of two of them.
    pub(crate) fn roots(&self) -> &[f32] {
        &self.root
    }

    /// The aggregate of each free vertex, [`NONE`] if it has no free neighbor.
    pub(crate) fn aggregate_of(&self) -> &[u32] {
        &self.aggregates.of
    }

    /// Where the members of each aggregate start in [`Self::members`], and one past the last.
    pub(crate) fn member_starts(&self) -> &[u32] {
        &self.member_start
    }

    /// The free vertices in aggregates, aggregate by aggregate.
    pub(crate) fn members(&self) -> &[u32] {
        &self.member
    }

    /// The reciprocal of each free vertex's diagonal entry.
    pub(crate) fn inverse_diagonal(&self) -> &[f32] {
        &self.inverse_diagonal
    }

    /// The levels below the free vertices, finest first.
    pub(crate) fn levels(&self) -> &[Level] {
        &self.levels
    }
}

/// The levels from an operator down.
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

/// All neighbors of a free vertex.
fn neighbors(problem: &Problem, v: usize) -> impl Iterator<Item = u32> + '_ {
    let start = problem.ring_start();
    problem.ring()[start[v] as usize..start[v + 1] as usize].iter().copied()
}

/// Of each free vertex the root of the stiffness over the size of its elements.
fn roots(problem: &Problem, positions: &[DVec2], stiffness: Stiffness) -> Vec<f32> {
    match stiffness {
        Stiffness::BySize(factor) => {
            let sizes = element_sizes(problem, positions);
            sizes.into_iter().map(|size| (factor as f32 / size).sqrt()).collect()
        }
        Stiffness::Uniform(factor) => {
            let root = (factor / (2.0 * problem.mean_area())).sqrt();
            vec![root as f32; problem.free_count()]
        }
    }
}

/// The mean doubled area of the triangles at each free vertex, averaged once with its neighbors.
fn element_sizes(problem: &Problem, positions: &[DVec2]) -> Vec<f32> {
    let free = problem.free_count();
    let own: Vec<f32> = collect(free, |v| {
        let start = problem.ring_start();
        let ring = &problem.ring()[start[v] as usize..start[v + 1] as usize];
        let edge = |k: u32| positions[k as usize] - positions[v];
        let next = ring.iter().skip(1).chain(ring.first());
        let doubled: f64 =
            ring.iter().zip(next).map(|(&a, &b)| edge(a).perp_dot(edge(b)).abs()).sum();
        (doubled / ring.len() as f64) as f32
    });
    collect(free, |v| {
        let (mut sum, mut count) = (own[v], 1.0);
        for size in neighbors(problem, v).filter_map(|k| own.get(k as usize)) {
            sum += size;
            count += 1.0;
        }
        sum / count
    })
}
