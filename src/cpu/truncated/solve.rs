//! Conjugate gradients for the Newton step of all vertices.

use glam::DVec2;

use super::blocks::Blocks;
use super::couplings::Couplings;
use super::derivatives::{Numbers, Source, extents, room};
use super::levels::Levels;
use super::matrix::Quad;
use super::product::{inner, multiply};
use super::scalar::Scalar;
use super::slides::Slides;
use crate::layout::Problem;
use crate::metric::Metric;
use crate::parallel::paced;
use crate::patch::instructions::with_instructions;
use crate::run::GoesOn;
use crate::run::truncated::aggregation::{STIFFNESS, UNKNOWNS};
use crate::run::truncated::{ErrorBound, StepRequest};
use crate::slide::{Movers, OnCurves, Tangents};

/// A mesh prepared for Newton steps of all vertices, with the vectors of the solution.
pub(crate) struct Solver<T> {
    blocks: Blocks,
    couplings: Couplings,
    levels: Levels<T>,
    numbers: Numbers<T>,
    slides: Slides<T>,
    /// The last solution. Empty while a step is linearized.
    solution: Vec<[T; 2]>,
    /// The direction p, and in turn the preconditioned residual and the product H p. Both are empty outside of a solution.
    direction: Vec<[T; 2]>,
    product: Vec<[T; 2]>,
}

/// The end of conjugate gradients. Gains are sums over triangles.
pub(super) struct Solved {
    pub(super) model_gain: f64,
    /// Negative derivative of the objective along the step.
    pub(super) descent: f64,
    pub(super) bound: f64,
    pub(super) least_ritz: f64,
    pub(super) is_curved_down: bool,
    pub(super) iterations: u32,
}

impl Solved {
    /// The state before the first iteration.
    const NONE: Self = Self {
        model_gain: 0.0,
        descent: 0.0,
        bound: f64::INFINITY,
        least_ritz: f64::INFINITY,
        is_curved_down: false,
        iterations: 0,
    };
}

impl<T: Scalar> Solver<T> {
    /// Prepares a mesh from its connectivity, with the vertices that slide.
    pub(super) async fn new(problem: &Problem, curves: Option<&OnCurves>) -> Self {
        let (blocks, pattern) = Blocks::new(problem, &Movers::new(problem, curves)).await;
        let couplings = Couplings::new(&blocks, &pattern).await;
        let sizes = blocks.group_start.windows(2);
        let levels = Levels::new(pattern, sizes.map(|ends| (ends[1] - ends[0]).into()).collect());
        let levels = levels.await;
        let zero = vec![[T::default(); 2]; blocks.order.len()];
        let (terms, maps) = room(&blocks.blocks, problem.targets().is_some());
        let numbers = Numbers {
            terms,
            maps,
            places: zero.clone(),
            inverses: vec![[T::default(); 3]; zero.len()],
            residual: zero,
        };
        Self {
            slides: Slides::new(blocks.slides_at.clone()),
            blocks,
            couplings,
            levels,
            numbers,
            solution: Vec::new(),
            direction: Vec::new(),
            product: Vec::new(),
        }
    }

    /// Computes gradient, Hessians and levels at the positions, for moves along `tangents` of the sliding vertices.
    pub(super) async fn linearize(
        &mut self,
        metric: Metric,
        problem: &Problem,
        positions: &[DVec2],
        tangents: &Tangents,
    ) {
        let Self { blocks, couplings, levels, numbers, slides, .. } = self;
        slides.set(tangents);
        let Some(first) = levels.lattices.first_mut() else { return };
        self.solution = Vec::new();
        extents(blocks, positions, &mut first.extents).await;
        let source = Source {
            problem,
            positions,
            blocks,
            couplings,
            pattern: &first.matrix.pattern,
            extents: &first.extents,
            lines: &slides.lines,
        };
        let upper = source.compute(metric, numbers).await;
        couplings.complete(&upper, &mut first.matrix).await;
        drop(upper);
        slides.project(&mut numbers.residual);
        for (at, line) in slides.each() {
            let group = blocks.group_start.partition_point(|&start| start as usize <= at) - 1;
            let ([x, y], [u, w]) = (line.along, numbers.places[at]);
            let row: [T; UNKNOWNS] = [x, y, u * x + w * y, u * y - w * x];
            let diagonal = first.matrix.pattern.diagonal[group] as usize;
            let columns = first.matrix.blocks[diagonal].as_chunks_mut::<UNKNOWNS>().0;
            for (down, &right) in columns.iter_mut().zip(&row) {
                for (entry, &left) in down.iter_mut().zip(&row) {
                    *entry += line.stiffness * left * right;
                }
            }
        }
        levels.update().await;
    }

    /// Computes the step. If `goes_on` returns false, the solver stops, and its solution has no gain. `least_gain` is the sum
    /// over triangles of the request's least gain.
    pub(super) async fn solve(
        &mut self,
        request: &StepRequest,
        least_gain: f64,
        goes_on: &mut GoesOn<'_>,
    ) -> Solved {
        let mut bound = ErrorBound::new(request.least_ritz);
        let mut rough = ErrorBound::new(StepRequest::ROUGH_RITZ);
        let mut solved = Solved::NONE;
        for vector in [&mut self.solution, &mut self.direction, &mut self.product] {
            *vector = vec![[T::default(); 2]; self.blocks.order.len()];
        }
        let (mut alpha, mut before) = (0.0, f64::INFINITY);
        while solved.iterations < StepRequest::MOST_ITERATIONS {
            if !goes_on() {
                solved = Solved { iterations: solved.iterations, ..Solved::NONE };
                break;
            }
            let rho = self.precondition(alpha).await;
            alpha = 0.0;
            if rho == 0.0 {
                solved.bound = 0.0;
                break;
            }
            let beta = if solved.iterations == 0 { 0.0 } else { rho / before };
            self.turn(beta).await;
            let Self { blocks, numbers, slides, direction, product, .. } = &mut *self;
            let curvature = multiply(blocks, numbers, direction, product).await
                + slides.bend(direction, product);
            // Comparisons with NaN are false.
            let is_positive = rho > 0.0 && curvature > 0.0 && (rho / curvature).is_finite();
            if !is_positive {
                solved.is_curved_down = true;
                if solved.iterations == 0 {
                    self.solution.copy_from_slice(&self.direction);
                    solved.descent = rho;
                }
                break;
            }
            alpha = rho / curvature;
            solved.iterations += 1;
            solved.model_gain += 0.5 * alpha * rho;
            solved.bound = bound.add(alpha, beta, rho);
            before = rho;
            let slides = !self.slides.lines.is_empty();
            let accuracy = request.accuracy(solved.model_gain, least_gain, slides);
            let rest = rough.add(alpha, beta, rho);
            let is_last = slides || accuracy <= least_gain;
            // Only a solution that may end the run needs a safe bound.
            if is_last && solved.bound <= accuracy.min(2.0 * least_gain) {
                solved.bound = bound.refined(rho);
            }
            if accuracy >= if is_last { solved.bound } else { rest } {
                break;
            }
        }
        self.advance(alpha).await;
        // The sums of the next linearization take the room of these.
        (self.direction, self.product) = (Vec::new(), Vec::new());
        if let Some(first) = self.levels.lattices.first_mut() {
            first.matrix.blocks = Vec::new();
        }
        if solved.model_gain > 0.0 {
            // The solution minimizes the model over the directions so far, so its gain is half of the descent.
            solved.descent = 2.0 * solved.model_gain;
            solved.least_ritz = bound.least_ritz();
        }
        solved
    }

    /// Adds `alpha` times the direction to the solution, and changes the residual. Computes the preconditioned residual,
    /// and returns its inner product with the residual.
    async fn precondition(&mut self, alpha: f64) -> f64 {
        self.advance(alpha).await;
        self.restrict().await;
        self.levels.solve().await;
        let Self { blocks, levels, numbers, product: preconditioned, .. } = self;
        let Numbers { inverses, places, residual, .. } = &*numbers;
        let Some(first) = levels.lattices.first() else { return 0.0 };
        let by = T::of(STIFFNESS);
        let parts: Vec<_> = blocks.split(preconditioned).collect();
        let sums = paced::map_parts(parts, |at, preconditioned| {
            let block = &blocks.blocks[at];
            with_instructions!(simd => {
                let _ = simd;
                let (mut group, mut v) = (block.groups.start, block.own.start);
                while group < block.groups.end {
                    let [a, b, p, q] = first.x[group];
                    let [a, b, p, q] = [by * a, by * b, by * p, by * q];
                    let end = blocks.group_start[group + 1] as usize;
                    while v < end {
                        let ([xx, xy, yy], [x, y], [u, w]) = (inverses[v], residual[v], places[v]);
                        preconditioned[v - block.own.start] = [
                            xx * x + xy * y + a + u * p - w * q,
                            xy * x + yy * y + b + u * q + w * p,
                        ];
                        v += 1;
                    }
                    group += 1;
                }
                inner(&residual[block.own.clone()], preconditioned)
            })
        });
        let inner = sums.await.into_iter().sum();
        // The residual is along the lines of the sliding vertices, so its inner product does not depend on the rest.
        self.slides.project(&mut self.product);
        inner
    }

    /// Adds `alpha` times the direction to the solution, and subtracts `alpha` times the product from the residual.
    async fn advance(&mut self, alpha: f64) {
        if alpha == 0.0 {
            return;
        }
        let Self { blocks, numbers, solution, direction, product, .. } = self;
        let alpha = T::of(alpha);
        let parts = blocks.split(solution).zip(blocks.split(&mut numbers.residual));
        let parts: Vec<_> = parts.collect();
        paced::for_each_part(parts, |at, (solution, residual)| {
            let own = blocks.blocks[at].own.clone();
            let (direction, product) = (&direction[own.clone()], &product[own]);
            let mut at = 0;
            while at < solution.len() {
                let ([x, y], [p, q]) = (solution[at], direction[at]);
                solution[at] = [x + alpha * p, y + alpha * q];
                let ([x, y], [p, q]) = (residual[at], product[at]);
                residual[at] = [x - alpha * p, y - alpha * q];
                at += 1;
            }
        })
        .await;
    }

    /// Sums the residual over the aggregates.
    async fn restrict(&mut self) {
        let Self { blocks, levels, numbers, .. } = self;
        let Numbers { places, residual, .. } = &*numbers;
        let Some(first) = levels.lattices.first_mut() else { return };
        let parts: Vec<_> = blocks.split_groups(&mut first.b).collect();
        paced::for_each_part(parts, |at, sums| {
            let groups = blocks.blocks[at].groups.clone();
            for (sum, group) in sums.iter_mut().zip(groups) {
                *sum = Quad::default();
                let ends = &blocks.group_start[group..group + 2];
                let (mut v, end) = (ends[0] as usize, ends[1] as usize);
                while v < end {
                    let ([x, y], [u, w]) = (residual[v], places[v]);
                    sum[0] += x;
                    sum[1] += y;
                    sum[2] += u * x + w * y;
                    sum[3] += u * y - w * x;
                    v += 1;
                }
            }
        })
        .await;
    }

    /// Sets the direction to the preconditioned residual plus `beta` times the direction.
    async fn turn(&mut self, beta: f64) {
        let Self { blocks, direction, product: preconditioned, .. } = self;
        let by = T::of(beta);
        let parts: Vec<_> = blocks.split(direction).collect();
        paced::for_each_part(parts, |at, direction| {
            let preconditioned = &preconditioned[blocks.blocks[at].own.clone()];
            if beta == 0.0 {
                direction.copy_from_slice(preconditioned);
                return;
            }
            let mut at = 0;
            while at < direction.len() {
                let ([p, q], [x, y]) = (direction[at], preconditioned[at]);
                direction[at] = [x + by * p, y + by * q];
                at += 1;
            }
        })
        .await;
    }

    /// Returns the length of the way of a sliding vertex in the solution.
    pub(super) fn way(&self, slide: usize) -> f64 {
        self.slides.length(slide, &self.solution)
    }

    /// Writes the positions of the free vertices, moved by `length` times the solution, to `moved`, in the order of the
    /// problem.
    pub(super) async fn write_moved(&self, positions: &[DVec2], length: f64, moved: &mut [DVec2]) {
        /// Number of vertices that one task moves.
        const VERTICES: usize = 1 << 12;
        let Self { blocks: Blocks { rank, .. }, solution, .. } = self;
        paced::for_each_chunk(moved, VERTICES, |first, moved| {
            for (v, moved) in (first..).zip(moved) {
                let step = solution[rank[v] as usize];
                *moved = positions[v] + DVec2::new(step[0].wide(), step[1].wide()) * length;
            }
        })
        .await;
    }
}

#[cfg(test)]
impl Solver<f64> {
    pub(super) fn blocks(&self) -> &Blocks {
        &self.blocks
    }

    pub(super) fn residual(&self) -> &[[f64; 2]] {
        &self.numbers.residual
    }

    /// Returns the Hessian times a vector.
    pub(super) async fn product_with(&mut self, vector: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let mut product = vec![[0.0; 2]; vector.len()];
        multiply(&self.blocks, &self.numbers, vector, &mut product).await;
        product
    }

    /// Returns the preconditioner times a vector.
    pub(super) async fn preconditioned_of(&mut self, vector: &[[f64; 2]]) -> Vec<[f64; 2]> {
        self.numbers.residual.copy_from_slice(vector);
        self.product.resize(vector.len(), [0.0; 2]);
        self.precondition(0.0).await;
        self.product.clone()
    }
}
