//! The direct solution on the coarsest level.

use crate::run::multilevel::sparse::Sparse;

/// Returns the inverse of a symmetric positive definite matrix, in row-major order.
///
/// If rounding has made a pivot small or negative, the row and the column of its unknown are zero in the inverse.
pub(crate) fn inverse(matrix: &Sparse) -> Vec<f32> {
    /// Share of its diagonal entry below which a pivot is small.
    const LEAST_PIVOT: f64 = 1e-6;
    let n = matrix.rows();
    let mut lower = vec![0.0f64; n * n];
    for row in 0..n {
        for (column, value) in matrix.row(row) {
            lower[row * n + column] = f64::from(value);
        }
    }
    let mut scratch = vec![0.0; n * n];
    invert(&mut lower, &mut scratch, n, LEAST_PIVOT);
    lower.into_iter().map(|entry| entry as f32).collect()
}

/// Inverts a symmetric positive definite matrix of `n` rows in place, in row-major order. `columns` is scratch memory of
/// equal length. A pivot is small if it is at most `least_pivot` times its diagonal entry; the row and the column of its
/// unknown are then zero in the inverse.
#[inline]
pub(crate) fn invert(lower: &mut [f64], columns: &mut [f64], n: usize, least_pivot: f64) {
    // Computes the Cholesky factor in place.
    for j in 0..n {
        let diagonal = lower[j * n + j];
        let square = diagonal - (0..j).map(|k| lower[j * n + k].powi(2)).sum::<f64>();
        let pivot = if square > least_pivot * diagonal { square.sqrt() } else { f64::INFINITY };
        lower[j * n + j] = pivot;
        for i in j + 1..n {
            let (upper_rows, row_i) = lower.split_at_mut(i * n);
            let row_j = &upper_rows[j * n..j * n + j];
            let dot: f64 = row_j.iter().zip(&row_i[..j]).map(|(a, b)| a * b).sum();
            row_i[j] = if pivot.is_finite() { (row_i[j] - dot) / pivot } else { 0.0 };
        }
    }
    // The inverse L⁻¹ of the factor, in column-major order. The inverse of the matrix is L⁻ᵀ L⁻¹.
    columns.fill(0.0);
    for c in 0..n {
        columns[c * n + c] = 1.0 / lower[c * n + c];
        for r in c + 1..n {
            let row = &lower[r * n + c..r * n + r];
            let dot: f64 = row.iter().zip(&columns[c * n + c..c * n + r]).map(|(a, b)| a * b).sum();
            columns[c * n + r] = -dot / lower[r * n + r];
        }
    }
    for (at, entry) in lower.iter_mut().enumerate() {
        let (i, j) = (at / n, at % n);
        let from = i.max(j);
        let (a, b) = (&columns[i * n + from..(i + 1) * n], &columns[j * n + from..(j + 1) * n]);
        *entry = a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parallel::pace::now;

    #[test]
    fn the_inverse_times_the_matrix_is_the_identity() {
        let n = 12;
        let matrix = now(Sparse::from_rows(n, |row, sum| {
            for column in 0..n {
                let apart = row.abs_diff(column);
                sum.add(
                    column as u32,
                    if apart == 0 { 3.0 } else { -1.0 / (1 + apart * apart) as f32 },
                );
            }
        }));
        let inverse = inverse(&matrix);
        for i in 0..n {
            for j in 0..n {
                let product: f32 = matrix.row(i).map(|(k, a)| a * inverse[k * n + j]).sum();
                let wanted = if i == j { 1.0 } else { 0.0 };
                assert!((product - wanted).abs() < 1e-5, "({i}, {j}): {product}");
            }
        }
    }
}
