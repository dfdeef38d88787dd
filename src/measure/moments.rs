//! Minimum, maximum, mean and standard deviation of many values.

/// Count, mean, sum of squared deviations, minimum and maximum of a sequence of values.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moments {
    pub(crate) count: usize,
    pub(crate) mean: f64,
    /// Sum of the squared deviations from the mean.
    squares: f64,
    /// Minimum, with the index of the first chunk where the minimum occurs.
    pub(crate) least: (f64, usize),
    /// Maximum, with the index of the first chunk where the maximum occurs.
    pub(crate) most: (f64, usize),
}

/// Folds values by `f` in four independent lanes: lane i takes the values i, i + 4, i + 8, and so on.
#[inline]
fn four_lanes(values: &[f64], start: f64, f: impl Fn(f64, f64) -> f64) -> [f64; 4] {
    let mut lanes = [start; 4];
    let (fours, rest) = values.as_chunks::<4>();
    for four in fours {
        lanes = [0, 1, 2, 3].map(|i: usize| f(lanes[i], four[i]));
    }
    for (lane, &value) in lanes.iter_mut().zip(rest) {
        *lane = f(*lane, value);
    }
    lanes
}

impl Moments {
    pub(crate) const NONE: Self = Self {
        count: 0,
        mean: 0.0,
        squares: 0.0,
        least: (f64::INFINITY, 0),
        most: (f64::NEG_INFINITY, 0),
    };

    /// Returns the moments of the values of a chunk, [`Self::NONE`] if there are none.
    pub(crate) fn of(values: &[f64], chunk: usize) -> Self {
        if values.is_empty() {
            return Self::NONE;
        }
        let total = |lanes: [f64; 4]| (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]);
        let mean = total(four_lanes(values, 0.0, |sum, value| sum + value)) / values.len() as f64;
        let square = |sum, value| sum + (value - mean) * (value - mean);
        let min = |a: f64, b: f64| if b < a { b } else { a };
        let max = |a: f64, b: f64| if b > a { b } else { a };
        let least = four_lanes(values, f64::INFINITY, min).into_iter().fold(f64::INFINITY, min);
        let most = four_lanes(values, f64::NEG_INFINITY, max);
        let most = most.into_iter().fold(f64::NEG_INFINITY, max);
        Self {
            count: values.len(),
            mean,
            squares: total(four_lanes(values, 0.0, square)),
            least: (least, chunk),
            most: (most, chunk),
        }
    }

    /// Returns the moments of these values joined with `other`, whose chunks come later (Chan, Golub & LeVeque, Am.
    /// Stat. 37, 1983).
    pub(crate) fn and(self, other: &Self) -> Self {
        if self.count == 0 || other.count == 0 {
            return if self.count == 0 { *other } else { self };
        }
        let count = self.count + other.count;
        let (before, share) = (self.count as f64, other.count as f64 / count as f64);
        let apart = other.mean - self.mean;
        let (mean, squares) = match self.mean.is_finite() && other.mean.is_finite() {
            true => (
                self.mean + apart * share,
                self.squares + other.squares + apart * apart * before * share,
            ),
            false => (f64::INFINITY, f64::INFINITY),
        };
        Self {
            count,
            mean,
            squares,
            least: if other.least.0 < self.least.0 { other.least } else { self.least },
            most: if other.most.0 > self.most.0 { other.most } else { self.most },
        }
    }

    /// Returns the standard deviation of the values themselves, not the estimate for a larger population.
    pub(crate) fn deviation(&self) -> f64 {
        match (self.squares / self.count as f64).sqrt() {
            deviation if deviation.is_nan() => f64::INFINITY,
            deviation => deviation,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_of_parts_add_up_to_those_of_the_whole() {
        // The values are far from zero, where a difference of two sums would lose all digits.
        let values: Vec<f64> = (0..1000).map(|i| 1e9 + f64::from(i * i % 37)).collect();
        let whole = Moments::of(&values, 0);
        let parts = values.chunks(130).enumerate();
        let of_parts = parts.fold(Moments::NONE, |sum, (k, part)| sum.and(&Moments::of(part, k)));
        let least = values.iter().position(|&x| x == whole.least.0).unwrap();
        assert_eq!(of_parts.least, (1e9, least / 130));
        assert_eq!((whole.count, whole.most.0), (of_parts.count, of_parts.most.0));
        let mean = (0..1000).map(|i| f64::from(i * i % 37)).sum::<f64>() / 1000.0;
        let off = |i: i32| f64::from(i * i % 37) - mean;
        let deviation = ((0..1000).map(|i| off(i) * off(i)).sum::<f64>() / 1000.0).sqrt();
        for found in [whole, of_parts] {
            assert!((found.mean - 1e9 - mean).abs() < 1e-6);
            assert!((found.deviation() / deviation - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn an_infinite_value_makes_the_mean_infinite() {
        let infinite = Moments::of(&[1.0, f64::INFINITY], 0);
        for moments in [infinite, Moments::of(&[1.0], 0).and(&infinite)] {
            assert_eq!((moments.mean, moments.deviation()), (f64::INFINITY, f64::INFINITY));
            assert_eq!((moments.least.0, moments.most.0), (1.0, f64::INFINITY));
        }
    }
}
