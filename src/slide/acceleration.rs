//! Acceleration of periods: extrapolates the results of the last periods toward their limit.

use glam::DVec2;

use crate::run::records::{Reader, Writer};
use crate::slide::params::{Params, read_params, write_params};

/// Largest number of stored periods.
const MAX_PERIODS: usize = 6;
/// Tikhonov term of Anderson's least squares, relative to the diagonal of the normal equations. Without the term,
/// similar residuals would make the equations singular.
const TIKHONOV: f64 = 1e-10;

/// Results of the latest periods, for Anderson's acceleration (D. G. Anderson, J. ACM 12, 1965) of the map from one
/// period to the next. A combination of the results makes their changes along the curves cancel as far as possible.
#[derive(Default)]
pub(crate) struct Acceleration(Vec<Past>);

/// Parameters and positions at the end of one period.
struct Past {
    /// Change of each parameter in the period, relative to the edge length at the vertex.
    change: Vec<f64>,
    params: Params,
    positions: Vec<DVec2>,
}

impl Acceleration {
    /// Drops all stored periods.
    pub(crate) fn forget(&mut self) {
        self.0.clear();
    }

    /// Writes the stored periods to a checkpoint.
    pub(crate) fn save(&self, out: &mut Writer) {
        out.list(&self.0, |out, Past { change, params, positions }| {
            out.reals(change);
            write_params(params, out);
            out.points(positions);
        });
    }

    /// Reads stored periods from a checkpoint, for a mesh with `vertices` vertices and curves like those of `params`.
    /// Returns `None` for counts of another mesh, and for numbers that are not finite.
    pub(crate) fn restored(
        params: &Params,
        vertices: usize,
        from: &mut Reader<'_>,
    ) -> Option<Self> {
        let count: usize = params.iter().map(Vec::len).sum();
        let past = from.list(24, |from| {
            let (change, params) = (from.reals()?, read_params(params, from)?);
            let positions = from.points()?;
            let fits = change.len() == count && positions.len() == vertices;
            let is_finite = change.iter().all(|x| x.is_finite())
                && positions.iter().all(|point| point.is_finite());
            (fits && is_finite).then_some(Past { change, params, positions })
        })?;
        (past.len() <= MAX_PERIODS).then_some(Self(past))
    }

    /// Stores a period and returns the combined parameters and positions, from which the next period may begin. The
    /// caller must check that triangles and curves are valid there. `None` for the first period.
    pub(crate) fn next(
        &mut self,
        change: Vec<f64>,
        params: &Params,
        positions: &[DVec2],
    ) -> Option<(Params, Vec<DVec2>)> {
        if self.0.len() == MAX_PERIODS {
            self.0.remove(0);
        }
        let (params, positions) = (params.clone(), positions.to_vec());
        self.0.push(Past { change, params, positions });
        let (last, before) = self.0.split_last()?;
        let differences: Vec<Vec<f64>> = before
            .iter()
            .map(|past| past.change.iter().zip(&last.change).map(|(a, b)| a - b).collect())
            .collect();
        let weights = least_squares(&differences, &last.change)?;
        let (mut params, mut positions) = (last.params.clone(), last.positions.clone());
        for (past, weight) in before.iter().zip(weights) {
            let pairs = params.iter_mut().flatten().zip(past.params.iter().flatten());
            for ((to, from), last) in pairs.zip(last.params.iter().flatten()) {
                *to += weight * (from - last);
            }
            let pairs = positions.iter_mut().zip(&past.positions).zip(&last.positions);
            for ((to, from), last) in pairs {
                *to += (*from - *last) * weight;
            }
        }
        Some((params, positions))
    }
}

/// Returns the weights that minimize |`start` + weighted sum of `columns`|². `None` if `columns` is empty or a weight
/// is not finite.
fn least_squares(columns: &[Vec<f64>], start: &[f64]) -> Option<Vec<f64>> {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let count = columns.len();
    // The normal equations, solved by Gaussian elimination. Their raised diagonal makes them positive definite.
    let row = |i: usize| {
        let mut row: Vec<f64> = columns.iter().map(|column| dot(&columns[i], column)).collect();
        row[i] *= 1.0 + TIKHONOV;
        row.push(-dot(&columns[i], start));
        row
    };
    let mut rows: Vec<Vec<f64>> = (0..count).map(row).collect();
    for i in 0..count {
        let pivot = rows[i].clone();
        for below in &mut rows[i + 1..] {
            let factor = below[i] / pivot[i];
            below.iter_mut().zip(&pivot).for_each(|(x, pivot)| *x -= factor * pivot);
        }
    }
    let mut weights = vec![0.0; count];
    for i in (0..count).rev() {
        let known: f64 = (i + 1..count).map(|j| rows[i][j] * weights[j]).sum();
        weights[i] = (rows[i][count] - known) / rows[i][i];
    }
    (count > 0 && weights.iter().all(|weight| weight.is_finite())).then_some(weights)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A linear map with slow and fast components. Three components need three periods before the fixed point is found.
    #[test]
    fn the_fixed_point_of_a_linear_map_is_found() {
        let rates = [0.9, -0.5, 0.3];
        let mut acceleration = Acceleration::default();
        let mut at = vec![1.0, -2.0, 0.5];
        for _ in 0..5 {
            let to: Vec<f64> =
                at.iter().zip(rates).map(|(x, rate)| 4.0 + rate * (x - 4.0)).collect();
            let change = to.iter().zip(&at).map(|(to, at)| to - at).collect();
            at = match acceleration.next(change, &vec![to.clone()], &[]) {
                Some((params, _)) => params[0].clone(),
                None => to,
            };
        }
        assert!(at.iter().all(|x| (x - 4.0).abs() < 1e-6), "{at:?}");
    }
}
