//! Sparse symmetric matrices of 4x4 blocks: one block row for each aggregate, which moves, turns and scales.

use super::scalar::Scalar;
use crate::parallel::paced;
use crate::patch::instructions::with_instructions;
use crate::run::multilevel::invert;
use crate::run::truncated::aggregation::{Pattern, UNKNOWNS};

/// A 4x4 block, column by column.
pub(super) type Square<T> = [T; UNKNOWNS * UNKNOWNS];
pub(super) type Quad<T> = [T; UNKNOWNS];

/// Number of rows that one task handles.
pub(super) const ROWS: usize = 256;

/// A symmetric positive semidefinite matrix, with the inverses of its diagonal blocks.
pub(super) struct Matrix<T> {
    pub(super) pattern: Pattern,
    /// The blocks in the order of the pattern. The blocks of the first level exist only during a step.
    pub(super) blocks: Vec<Square<T>>,
    pub(super) inverses: Vec<Square<T>>,
}

impl<T: Scalar> Matrix<T> {
    pub(super) fn new(pattern: Pattern) -> Self {
        let inverses = vec![Default::default(); pattern.rows()];
        Self { pattern, blocks: Vec::new(), inverses }
    }

    /// Inverts the diagonal blocks.
    pub(super) async fn invert_diagonal(&mut self) {
        let Self { pattern, blocks, inverses } = self;
        paced::for_each_chunk(inverses, ROWS, |first, inverses| {
            for (row, inverse) in (first..).zip(inverses) {
                *inverse = inverse_of(&blocks[pattern.diagonal[row] as usize]);
            }
        })
        .await;
    }

    /// Returns a row of the residual b - A x.
    #[inline(always)]
    pub(super) fn residual(&self, row: usize, b: &[Quad<T>], x: &[Quad<T>]) -> Quad<T> {
        let Pattern { start, columns, .. } = &self.pattern;
        let [mut k, mut l, mut m, mut n] = b[row];
        let (mut at, end) = (start[row] as usize, start[row + 1] as usize);
        while at < end {
            let [p, q, r, s] = times(&self.blocks[at], &x[columns[at] as usize]);
            (k, l, m, n) = (k - p, l - q, m - r, n - s);
            at += 1;
        }
        [k, l, m, n]
    }

    /// Calls `of(row, value)` for each value of `x`, in parallel.
    pub(super) async fn for_each_row(
        &self,
        x: &mut [Quad<T>],
        of: impl Fn(usize, &mut Quad<T>) + Sync + Send,
    ) {
        paced::for_each_chunk(x, ROWS, |first, x| {
            with_instructions!(simd => {
                let _ = simd;
                let mut at = 0;
                while at < x.len() {
                    of(first + at, &mut x[at]);
                    at += 1;
                }
            });
        })
        .await;
    }
}

/// Returns the product of a block and a vector.
#[inline(always)]
pub(super) fn times<T: Scalar>(block: &Square<T>, x: &Quad<T>) -> Quad<T> {
    let b = block;
    [
        (b[0] * x[0] + b[4] * x[1]) + (b[8] * x[2] + b[12] * x[3]),
        (b[1] * x[0] + b[5] * x[1]) + (b[9] * x[2] + b[13] * x[3]),
        (b[2] * x[0] + b[6] * x[1]) + (b[10] * x[2] + b[14] * x[3]),
        (b[3] * x[0] + b[7] * x[1]) + (b[11] * x[2] + b[15] * x[3]),
    ]
}

/// Returns the transpose of a block.
#[inline(always)]
pub(super) fn transposed<T: Scalar>(block: &Square<T>) -> Square<T> {
    std::array::from_fn(|at| block[at % UNKNOWNS * UNKNOWNS + at / UNKNOWNS])
}

/// Returns the inverse of a symmetric positive definite block. A pivot that is rounding makes its row and column zero in
/// the inverse.
fn inverse_of<T: Scalar>(block: &Square<T>) -> Square<T> {
    let mut inverse = block.map(T::wide);
    let mut scratch = [0.0; UNKNOWNS * UNKNOWNS];
    invert(&mut inverse, &mut scratch, UNKNOWNS, T::LEAST_PIVOT);
    inverse.map(T::of)
}
