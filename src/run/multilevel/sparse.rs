//! Sparse matrices of the coarse levels, in compressed rows.

use crate::parallel::pace::pause;
use crate::parallel::paced;

/// Largest number of rows between two pauses.
const ROWS: usize = 1 << 12;
/// Largest number of rows that a task builds. A row of a Galerkin product takes about a microsecond.
const ROWS_OF_TASK: usize = 1 << 10;

/// A sparse matrix in compressed rows.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sparse {
    start: Vec<u32>,
    column: Vec<u32>,
    value: Vec<f32>,
}

impl Sparse {
    /// Builds a matrix of `rows` rows on all threads. `fill` adds the entries of a row to the given sum.
    pub(crate) async fn from_rows(
        rows: usize,
        fill: impl Fn(usize, &mut RowSum) + Sync + Send,
    ) -> Self {
        Self::from_rows_with(rows, || (), |row, (), sum| fill(row, sum)).await
    }

    /// Returns the Galerkin product Pᵀ A P, given P and its transpose. `row(i, factor, sum)` must add `factor` times
    /// row `i` of A to `sum`.
    pub(crate) async fn galerkin(
        prolongation: &Self,
        restriction: &Self,
        row: impl Fn(usize, f32, &mut RowSum) + Sync + Send,
    ) -> Self {
        // The product is computed row by row, so that A P is never stored.
        Self::from_rows_with(restriction.rows(), RowSum::default, |coarse, of_ap, sum| {
            for (k, value) in restriction.row(coarse) {
                row(k, value, of_ap);
            }
            for (k, value) in of_ap.entries() {
                for (column, share) in prolongation.row(k as usize) {
                    sum.add(column as u32, value * share);
                }
            }
            of_ap.clear();
        })
        .await
    }

    /// Builds a matrix like [`Self::from_rows`], with scratch memory that the rows of one task share.
    async fn from_rows_with<S>(
        rows: usize,
        scratch: impl Fn() -> S + Sync + Send,
        fill: impl Fn(usize, &mut S, &mut RowSum) + Sync + Send,
    ) -> Self {
        let chunk = rows.div_ceil(4 * rayon::current_num_threads()).clamp(64, ROWS_OF_TASK);
        let parts: Vec<Sparse> = paced::map_ranges(rows, chunk, |range| {
            let (mut scratch, mut sum) = (scratch(), RowSum::default());
            let mut matrix = Sparse::default();
            for row in range {
                fill(row, &mut scratch, &mut sum);
                sum.drain_into(&mut matrix);
            }
            matrix
        })
        .await;
        let mut whole = Sparse { start: Vec::with_capacity(rows + 1), ..Sparse::default() };
        let entries = parts.iter().map(|part| part.column.len()).sum();
        whole.column.reserve_exact(entries);
        whole.value.reserve_exact(entries);
        whole.start.push(0);
        for part in parts {
            let before = whole.column.len() as u32;
            whole.start.extend(part.start.iter().map(|end| before + end));
            whole.column.extend_from_slice(&part.column);
            whole.value.extend_from_slice(&part.value);
            drop(part);
            pause().await;
        }
        whole
    }

    /// Returns the number of rows.
    pub(crate) fn rows(&self) -> usize {
        self.starts().len() - 1
    }

    /// Returns the offset of each row in [`Self::columns`] and [`Self::values`], with the end of the last row as a
    /// further entry.
    pub(crate) fn starts(&self) -> &[u32] {
        &self.start
    }

    /// Returns the column of each entry, row by row.
    pub(crate) fn columns(&self) -> &[u32] {
        &self.column
    }

    /// Returns the value of each entry, row by row.
    pub(crate) fn values(&self) -> &[f32] {
        &self.value
    }

    /// Returns the columns and values of the entries of a row.
    pub(crate) fn row(&self, row: usize) -> impl Iterator<Item = (usize, f32)> + '_ {
        let range = self.starts()[row] as usize..self.starts()[row + 1] as usize;
        let columns = self.columns()[range.clone()].iter().map(|&c| c as usize);
        columns.zip(self.values()[range].iter().copied())
    }

    /// Returns the reciprocal of the diagonal entry of each row.
    pub(crate) async fn diagonal_inverted(&self) -> Vec<f32> {
        let diagonal =
            |i: usize| self.row(i).find(|&(c, _)| c == i).map_or(0.0, |(_, value)| value);
        paced::collect(self.rows(), |i| 1.0 / diagonal(i)).await
    }

    /// Multiplies each entry off the diagonal by the factors of its row and its column. Then adapts the diagonal, such
    /// that each row sum is multiplied by the square of the row's factor.
    pub(crate) async fn scale_couplings(&mut self, factors: &[f32]) {
        paced::in_order(self.rows(), ROWS, |rows| {
            rows.for_each(|row| self.scale_row(row, factors));
        })
        .await;
    }

    /// Does the work of [`Self::scale_couplings`] for a row.
    fn scale_row(&mut self, row: usize, factors: &[f32]) {
        let range = self.start[row] as usize..self.start[row + 1] as usize;
        let (mut of_constant, mut couplings) = (0.0, 0.0);
        let mut diagonal = range.start;
        for entry in range {
            of_constant += self.value[entry];
            match self.column[entry] as usize {
                column if column == row => diagonal = entry,
                column => {
                    self.value[entry] *= factors[row] * factors[column];
                    couplings += self.value[entry];
                }
            }
        }
        self.value[diagonal] = of_constant * factors[row] * factors[row] - couplings;
    }

    /// Returns for each row the mean of `values` over its columns, weighted by the absolute values of its entries.
    pub(crate) async fn means(&self, values: &[f32]) -> Vec<f32> {
        let mean = |row: usize| {
            let (mut sum, mut weights) = (0.0, 0.0);
            for (column, entry) in self.row(row) {
                sum += entry.abs() * values[column];
                weights += entry.abs();
            }
            sum / weights
        };
        paced::collect(self.rows(), mean).await
    }

    /// Returns the transpose of a matrix with `columns` columns. In each row of the transpose, columns ascend.
    pub(crate) async fn transposed(&self, columns: usize) -> Self {
        let mut start = vec![0u32; columns + 1];
        paced::in_order(self.column.len(), 8 * ROWS, |entries| {
            for &column in &self.column[entries] {
                start[column as usize + 1] += 1;
            }
        })
        .await;
        for column in 0..columns {
            start[column + 1] += start[column];
        }
        let mut next = start.clone();
        let mut transposed = Sparse {
            start,
            column: vec![0; self.column.len()],
            value: vec![0.0; self.value.len()],
        };
        paced::in_order(self.rows(), ROWS, |rows| {
            for row in rows {
                for (column, value) in self.row(row) {
                    let at = next[column] as usize;
                    transposed.column[at] = row as u32;
                    transposed.value[at] = value;
                    next[column] += 1;
                }
            }
        })
        .await;
        transposed
    }
}

/// A sum of sparse rows, as a hash table with columns as keys. A row has some tens of entries, so the table stays in
/// the first-level cache for meshes of any size.
pub(crate) struct RowSum {
    /// Column and value of each slot. The length is a power of two.
    slots: Vec<(u32, f32)>,
    /// Indices of the used slots, in the order of their first use.
    taken: Vec<u32>,
    /// Number of bits by which a 32-bit hash is shifted right to give the index of a slot.
    shift: u32,
}

/// Marks an unused slot, in place of its column.
const FREE: u32 = u32::MAX;

impl Default for RowSum {
    fn default() -> Self {
        Self::with_bits(7)
    }
}

impl RowSum {
    fn with_bits(bits: u32) -> Self {
        let slots = vec![(FREE, 0.0); 1 << bits];
        Self { taken: Vec::with_capacity(slots.len()), slots, shift: 32 - bits }
    }

    /// Adds `value` to the entry of a column.
    #[inline(always)]
    pub(crate) fn add(&mut self, column: u32, value: f32) {
        let mask = self.slots.len() - 1;
        let mut at = (column.wrapping_mul(0x9e37_79b1) >> self.shift) as usize;
        loop {
            let slot = &mut self.slots[at & mask];
            if slot.0 == column {
                slot.1 += value;
                return;
            }
            if slot.0 == FREE {
                *slot = (column, value);
                self.taken.push((at & mask) as u32);
                if 2 * self.taken.len() > mask {
                    self.grow();
                }
                return;
            }
            at += 1;
        }
    }

    /// Returns columns and values of the entries so far, in the order in which columns were first added.
    pub(crate) fn entries(&self) -> impl Iterator<Item = (u32, f32)> + '_ {
        self.taken.iter().map(|&slot| self.slots[slot as usize])
    }

    fn clear(&mut self) {
        self.taken.iter().for_each(|&slot| self.slots[slot as usize].0 = FREE);
        self.taken.clear();
    }

    #[cold]
    #[inline(never)]
    fn grow(&mut self) {
        let mut larger = Self::with_bits(32 - self.shift + 1);
        self.entries().for_each(|(column, value)| larger.add(column, value));
        *self = larger;
    }

    fn drain_into(&mut self, matrix: &mut Sparse) {
        matrix.column.extend(self.entries().map(|(column, _)| column));
        matrix.value.extend(self.entries().map(|(_, value)| value));
        matrix.start.push(matrix.column.len() as u32);
        self.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parallel::pace::now;

    fn dense(matrix: &Sparse, columns: usize) -> Vec<Vec<f32>> {
        let mut dense = vec![vec![0.0; columns]; matrix.rows()];
        for (row, values) in dense.iter_mut().enumerate() {
            matrix.row(row).for_each(|(column, value)| values[column] += value);
        }
        dense
    }

    /// Returns a matrix of a thousand rows, which fill several chunks. The entries of each row are added in two parts.
    fn sample() -> Sparse {
        now(Sparse::from_rows(1000, |row, sum| {
            for k in 0..row % 5 {
                sum.add(((row * 7 + k * 13) % 70) as u32, 1.0 + k as f32);
                sum.add((row * 7 % 70) as u32, row as f32);
            }
        }))
    }

    #[test]
    fn entries_of_a_column_are_added_up() {
        let matrix = sample();
        let values = dense(&matrix, 70);
        assert_eq!((matrix.rows(), matrix.row(10).count()), (1000, 0));
        // Row 13 has k = 0, 1, 2. The entry for k = 0 is in the column to which the second part adds.
        assert_eq!(matrix.row(13).count(), 3);
        assert_eq!(values[13][13 * 7 % 70], 1.0 + 3.0 * 13.0);
        assert_eq!(values[13][(13 * 7 + 26) % 70], 3.0);
    }

    #[test]
    fn the_transpose_swaps_rows_and_columns() {
        let (matrix, transposed) = (sample(), now(sample().transposed(70)));
        let (straight, swapped) = (dense(&matrix, 70), dense(&transposed, 1000));
        for row in 0..1000 {
            for column in 0..70 {
                assert_eq!(straight[row][column], swapped[column][row]);
            }
        }
    }
}
