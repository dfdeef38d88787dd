//! Acceleration of rounds: extrapolates the last rounds to where further ones would lead.

use glam::DVec2;

use crate::run::records::{Reader, Writer};
use crate::slide::params::{Params, read_params, write_params};

/// The most rounds that are stored.
const MOST: usize = 6;
/// Tikhonov term of Anderson's least squares, relative to the diagonal of the normal equations. Without the term, similar
/// residuals would make the equations singular.
const LEAST: f64 = 1e-10;

/// The latest rounds, for Anderson's acceleration (D. G. Anderson, J. ACM 12, 1965) of the map from one round to the
/// next. The results of the rounds are combined so that their changes along the curves cancel as far as possible.
#[derive(Default)]
pub(crate) struct Acceleration(Vec<Past>);

/// The result of a round.
struct Past {
    /// The change of each parameter in the round, divided by the edge length there.
    change: Vec<f64>,
    params: Params,
    positions: Vec<DVec2>,
}

impl Acceleration {
    /// Drops all rounds.
    pub(crate) fn forget(&mut self) {
        self.0.clear();
    }

    /// Writes the stored rounds to a checkpoint.
    pub(crate) fn save(&self, out: &mut Writer) {
        out.list(&self.0, |out, Past { change, params, positions }| {
            out.reals(change);
            write_params(params, out);
            out.points(positions);
        });
    }

    /// Reads rounds from a checkpoint, of the curves that `params` belong to and of `vertices` vertices. `None` if they
    /// are of other curves.
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
        (past.len() <= MOST).then_some(Self(past))
    }

    /// Stores a round. Returns parameters and positions from which the next round may begin; the caller must check that
    /// they are sound.
    pub(crate) fn next(
        &mut self,
        change: Vec<f64>,
        params: &Params,
        positions: &[DVec2],
    ) -> Option<(Params, Vec<DVec2>)> {
        if self.0.len() == MOST {
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

/// Returns the weights of the columns whose weighted sum, added to `start`, has the least sum of squares. `None` if
/// there are no columns.
fn least_squares(columns: &[Vec<f64>], start: &[f64]) -> Option<Vec<f64>> {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let count = columns.len();
    // The normal equations, solved by Gaussian elimination. They are positive definite, as their diagonal is raised.
    let row = |i: usize| {
        let mut row: Vec<f64> = columns.iter().map(|column| dot(&columns[i], column)).collect();
        row[i] *= 1.0 + LEAST;
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

    /// A linear map with slow and fast components. After as many rounds as it has components, the fixed point is found.
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
