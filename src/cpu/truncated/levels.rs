//! The coarser levels: aggregates that move, turn and scale.
//!
//! A vertex z of an aggregate with center c and size s moves by a + b (z - c)/s, with complex a and b. An aggregate of
//! aggregates moves its members alike, so a level is a matrix of 4x4 blocks. The matrix of the first level is a sum over
//! triangles. The matrix of each coarser level is a sum of blocks of the next finer matrix.

use super::matrix::{Matrix, Quad, ROWS, Square, times};
use super::scalar::Scalar;
use crate::parallel::paced;
use crate::run::multilevel::invert;
use crate::run::truncated::aggregation::{CHEBYSHEV, Members, Pattern, STIFFNESS, UNKNOWNS};

/// Largest number of aggregates that are solved for directly.
const DIRECT: usize = 12;

/// Place and size of an aggregate.
#[derive(Clone, Copy, Default)]
pub(super) struct Extent {
    pub(super) center: [f64; 2],
    /// Root of the mean squared distance of the vertices from the center. 1 for a single vertex.
    pub(super) size: f64,
    /// Inverse of the size.
    pub(super) inverse: f64,
}

impl Extent {
    pub(super) fn new(center: [f64; 2], size: f64) -> Self {
        Self { center, size, inverse: 1.0 / size }
    }
}

/// A level with its matrix and vectors.
pub(super) struct Lattice<T> {
    pub(super) matrix: Matrix<T>,
    pub(super) extents: Vec<Extent>,
    /// Number of vertices of each aggregate.
    counts: Vec<f64>,
    /// Right-hand side.
    pub(super) b: Vec<Quad<T>>,
    /// Solution.
    pub(super) x: Vec<Quad<T>>,
    residual: Vec<Quad<T>>,
    step: Vec<Quad<T>>,
    coarser: Option<Coarser<T>>,
}

/// The aggregates of a level in those of the next coarser level.
struct Coarser<T> {
    members: Members,
    /// Motion of each aggregate with that of its coarser aggregate: a' = a + (x + iy) b and b' = σ b, as x, y and σ.
    shifts: Vec<[T; 3]>,
}

/// All coarser levels, the finest first.
pub(super) struct Levels<T> {
    pub(super) lattices: Vec<Lattice<T>>,
    /// Inverse of the last matrix. Empty if the last level has too many aggregates.
    direct: Vec<T>,
}

impl<T: Scalar> Lattice<T> {
    fn new(pattern: Pattern, counts: Vec<f64>) -> Self {
        let zero = vec![Quad::default(); pattern.rows()];
        Self {
            extents: vec![Extent::default(); pattern.rows()],
            matrix: Matrix::new(pattern),
            counts,
            b: zero.clone(),
            x: zero.clone(),
            residual: zero.clone(),
            step: zero,
            coarser: None,
        }
    }

    /// Returns the next coarser level, without numbers. `None` if the level is solved directly, or hardly shrinks.
    async fn coarsened(&mut self) -> Option<Self> {
        let (members, coarse) = self.matrix.pattern.joined(DIRECT).await?;
        let all = |of: &[u32]| of.iter().map(|&row| self.counts[row as usize]).sum();
        let counts = (0..members.count()).map(|coarse| all(members.of(coarse))).collect();
        let shifts = vec![[T::default(); 3]; self.matrix.pattern.rows()];
        self.coarser = Some(Coarser { members, shifts });
        Some(Self::new(coarse, counts))
    }

    /// Sets the extents of the next level, and the motions of this level's aggregates with it.
    async fn set_extents(&mut self, next: &mut Self) {
        let Some(Coarser { members, shifts }) = &mut self.coarser else { return };
        let members = &*members;
        let (extents, counts) = (&self.extents, &self.counts);
        paced::for_each_chunk(&mut next.extents, ROWS, |first, coarse| {
            for (at, extent) in (first..).zip(coarse) {
                let members = members.of(at);
                let all: f64 = members.iter().map(|&k| counts[k as usize]).sum();
                let mut center = [0.0; 2];
                for &k in members {
                    let (of, weight) = (&extents[k as usize], counts[k as usize] / all);
                    center = [center[0] + weight * of.center[0], center[1] + weight * of.center[1]];
                }
                let square = |&k: &u32| {
                    let of = &extents[k as usize];
                    let [x, y] = [of.center[0] - center[0], of.center[1] - center[1]];
                    (x * x + y * y + of.size * of.size) * counts[k as usize] / all
                };
                *extent = Extent::new(center, members.iter().map(square).sum::<f64>().sqrt());
            }
        })
        .await;
        let coarse = &next.extents;
        paced::for_each_chunk(shifts, ROWS, |first, shifts| {
            for (at, shift) in (first..).zip(shifts) {
                let (own, of) = (&extents[at], &coarse[members.group[at] as usize]);
                let [x, y] = [own.center[0] - of.center[0], own.center[1] - of.center[1]];
                *shift = [x / of.size, y / of.size, own.size / of.size].map(T::of);
            }
        })
        .await;
    }

    /// Sets the matrix of the next level to the sums of the blocks of this level.
    async fn sum_up(&self, next: &mut Self) {
        let Some(Coarser { members, shifts }) = &self.coarser else { return };
        let Matrix { pattern: coarse, blocks, .. } = &mut next.matrix;
        if blocks.is_empty() {
            *blocks = vec![Square::default(); coarse.columns.len()];
        }
        let rows = coarse.rows();
        let lengths = (0..rows).map(|row| coarse.row(row).len());
        let mut parts: Vec<_> = super::blocks::split(blocks, lengths).collect();
        paced::for_each_part(parts.chunks_mut(ROWS / 8).collect::<Vec<_>>(), |task, parts| {
            for (row, sums) in (task * (ROWS / 8)..).zip(parts) {
                sums.fill(Square::default());
                let columns = coarse.columns(row);
                for &k in members.of(row) {
                    let fine = &self.matrix;
                    for at in fine.pattern.row(k as usize) {
                        let other = fine.pattern.columns[at] as usize;
                        let column = members.group[other];
                        let place = columns.partition_point(|&c| c < column);
                        let block = moved(&fine.blocks[at], shifts[k as usize], shifts[other]);
                        for (sum, entry) in sums[place].iter_mut().zip(block) {
                            *sum += entry;
                        }
                    }
                }
            }
        })
        .await;
    }

    /// Sets the solution to two steps of Chebyshev's method from zero, or adds two steps to it.
    async fn smooth(&mut self, from_zero: bool) {
        let [first, again, more] = CHEBYSHEV.map(T::of);
        let Self { matrix, b, x, residual, step, .. } = self;
        if !from_zero {
            matrix
                .for_each_row(
                    residual,
                    #[inline(always)]
                    |row, left| *left = matrix.residual(row, b, x),
                )
                .await;
        }
        let left = if from_zero { b } else { residual };
        matrix
            .for_each_row(
                step,
                #[inline(always)]
                |row, step| {
                    let [k, l, m, n] = times(&matrix.inverses[row], &left[row]);
                    *step = [first * k, first * l, first * m, first * n];
                },
            )
            .await;
        matrix
            .for_each_row(
                x,
                #[inline(always)]
                |row, x| {
                    let left = matrix.residual(row, left, step);
                    let [k, l, m, n] = times(&matrix.inverses[row], &left);
                    let [p, q, r, s] = step[row];
                    let [t, u, v, w] = if from_zero { [T::default(); UNKNOWNS] } else { *x };
                    *x = [
                        t + (again * p + more * k),
                        u + (again * q + more * l),
                        v + (again * r + more * m),
                        w + (again * s + more * n),
                    ];
                },
            )
            .await;
    }

    /// Sets the right-hand side of the next level to the residual of this level.
    async fn restrict(&self, next: &mut Self) {
        let Some(Coarser { members, shifts }) = &self.coarser else { return };
        let Members { start, members, .. } = members;
        let Self { matrix, b, x, .. } = self;
        next.matrix
            .for_each_row(
                &mut next.b,
                #[inline(always)]
                |row, sum| {
                    *sum = [T::default(); UNKNOWNS];
                    let (mut at, end) = (start[row] as usize, start[row + 1] as usize);
                    while at < end {
                        let k = members[at] as usize;
                        let left = matrix.residual(k, b, x);
                        let [u, v, size] = shifts[k];
                        sum[0] += left[0];
                        sum[1] += left[1];
                        sum[2] += u * left[0] + v * left[1] + size * left[2];
                        sum[3] += u * left[1] - v * left[0] + size * left[3];
                        at += 1;
                    }
                },
            )
            .await;
    }

    /// Adds the solution of the next level to the solution of this level.
    async fn prolong(&mut self, next: &Self) {
        let Some(Coarser { members: Members { group, .. }, shifts }) = &self.coarser else {
            return;
        };
        let by = T::of(STIFFNESS);
        self.matrix
            .for_each_row(
                &mut self.x,
                #[inline(always)]
                |row, x| {
                    let [a, c, p, q] = next.x[group[row] as usize];
                    let [a, c, p, q] = [by * a, by * c, by * p, by * q];
                    let [u, v, size] = shifts[row];
                    x[0] += a + u * p - v * q;
                    x[1] += c + u * q + v * p;
                    x[2] += size * p;
                    x[3] += size * q;
                },
            )
            .await;
    }
}

/// Returns the block of two aggregates for the motions of their coarser aggregates.
#[inline(always)]
fn moved<T: Scalar>(block: &Square<T>, left: [T; 3], right: [T; 3]) -> Square<T> {
    let column = |k: usize| std::array::from_fn::<T, UNKNOWNS, _>(|row| block[k * UNKNOWNS + row]);
    let [a, b, c, d] = [column(0), column(1), column(2), column(3)];
    let [u, v, size] = right;
    let turned = std::array::from_fn(|k| u * a[k] + v * b[k] + size * c[k]);
    let scaled = std::array::from_fn(|k| u * b[k] - v * a[k] + size * d[k]);
    let [u, v, size] = left;
    let mut moved = Square::default();
    for (at, [a, b, c, d]) in [a, b, turned, scaled].into_iter().enumerate() {
        let column = [a, b, u * a + v * b + size * c, u * b - v * a + size * d];
        moved[at * UNKNOWNS..(at + 1) * UNKNOWNS].copy_from_slice(&column);
    }
    moved
}

impl<T: Scalar> Levels<T> {
    /// Makes the levels, with zero matrices, from the pattern of the first matrix. `counts` has the number of vertices of each
    /// aggregate of the first level.
    pub(super) async fn new(pattern: Pattern, counts: Vec<f64>) -> Self {
        let mut lattices = vec![Lattice::new(pattern, counts)];
        while let Some(last) = lattices.last_mut()
            && let Some(next) = last.coarsened().await
        {
            lattices.push(next);
        }
        Self { lattices, direct: Vec::new() }
    }

    /// Computes all levels from the first, whose matrix and extents are set.
    pub(super) async fn update(&mut self) {
        for at in 0..self.lattices.len() {
            if let [level, next, ..] = &mut self.lattices[at..] {
                level.set_extents(next).await;
                level.sum_up(next).await;
            }
            self.lattices[at].matrix.invert_diagonal().await;
        }
        self.direct = self.lattices.last().map(direct).unwrap_or_default();
    }

    /// Solves approximately for the right-hand side of the first level.
    pub(super) async fn solve(&mut self) {
        let count = self.lattices.len();
        for at in 0..count {
            let is_last = at + 1 == count;
            if is_last && !self.direct.is_empty() {
                self.solve_directly();
                break;
            }
            self.lattices[at].smooth(true).await;
            if let [level, next, ..] = &mut self.lattices[at..] {
                level.restrict(next).await;
            }
        }
        for at in (1..count).rev() {
            if let [level, next, ..] = &mut self.lattices[at - 1..] {
                level.prolong(next).await;
                level.smooth(false).await;
            }
        }
    }

    fn solve_directly(&mut self) {
        let Some(Lattice { b, x, .. }) = self.lattices.last_mut() else { return };
        let b = b.as_flattened();
        for (row, x) in x.as_flattened_mut().iter_mut().enumerate() {
            let entries = &self.direct[row * b.len()..(row + 1) * b.len()];
            let mut sum = T::default();
            for (&entry, &b) in entries.iter().zip(b) {
                sum += entry * b;
            }
            *x = sum;
        }
    }
}

/// Returns the inverse of a matrix of few rows, empty for more.
fn direct<T: Scalar>(level: &Lattice<T>) -> Vec<T> {
    let Matrix { pattern, blocks, .. } = &level.matrix;
    if pattern.rows() > DIRECT {
        return Vec::new();
    }
    let size = pattern.rows() * UNKNOWNS;
    let mut dense = vec![0.0; size * size];
    for row in 0..pattern.rows() {
        for at in pattern.row(row) {
            for (k, entry) in blocks[at].iter().enumerate() {
                let (down, across) = (k % UNKNOWNS, k / UNKNOWNS);
                let column = pattern.columns[at] as usize * UNKNOWNS + across;
                dense[(row * UNKNOWNS + down) * size + column] = entry.wide();
            }
        }
    }
    let mut scratch = vec![0.0; size * size];
    invert(&mut dense, &mut scratch, size, T::LEAST_PIVOT);
    dense.into_iter().map(T::of).collect()
}
