//! Quantiles of many values, in one pass that stores only a few values.
//!
//! A sample determines a bracket: two values that probably enclose the value of the rank. The pass counts the values
//! below the bracket and stores the values inside. Values are rounded to single precision, so that values equal up to
//! rounding have equal keys.

/// Number of values in a sample.
pub(crate) const SAMPLE: usize = 1 << 13;

/// Returns an integer whose order is the order of values, rounded to single precision.
#[inline]
pub(crate) fn key(value: f64) -> u32 {
    let bits = (value as f32).to_bits();
    if bits >> 31 == 0 { bits | 1 << 31 } else { !bits }
}

/// Returns the value of a key; inverse of [`key`].
pub(crate) fn value(key: u32) -> f64 {
    let bits = if key >> 31 == 1 { key & !(1 << 31) } else { !key };
    f64::from(f32::from_bits(bits))
}

/// Returns the 0-based rank of a quantile: the least value that at least `share` of all `count` values do not exceed.
pub(crate) fn rank(share: f64, count: usize) -> usize {
    ((share * count as f64).ceil() as usize).clamp(1, count.max(1)) - 1
}

/// A bracket between two keys, with the counts of keys below it and at its ends, and the keys inside.
#[derive(Clone)]
pub(crate) struct Bracket {
    low: u32,
    high: u32,
    below: usize,
    at_low: usize,
    at_high: usize,
    /// Keys strictly between `low` and `high`, in any order.
    inside: Vec<u32>,
}

impl Bracket {
    /// Makes the bracket for the quantile `share` of all values from the sorted keys of a sample. The bracket extends
    /// six standard deviations to either side, and so misses the quantile about once in a billion times.
    pub(crate) fn new(sample: &[u32], share: f64) -> Self {
        let last = sample.len().saturating_sub(1);
        let middle = share * sample.len() as f64;
        let reach = 6.0 * (middle * (1.0 - share)).sqrt() + 1.0;
        let key = |place: f64| sample.get((place.max(0.0) as usize).min(last)).copied();
        let (low, high) = (key(middle - reach).unwrap_or(0), key(middle + reach).unwrap_or(0));
        Self { low, high, below: 0, at_low: 0, at_high: 0, inside: Vec::new() }
    }

    pub(crate) fn count(&mut self, keys: &[u32]) {
        let Self { low, high, .. } = *self;
        self.below += keys.iter().map(|&key| u32::from(key < low)).sum::<u32>() as usize;
        for &key in keys {
            // Most keys are outside the bracket, and one comparison rules them out.
            if key.wrapping_sub(low) <= high - low {
                match key {
                    key if key == low => self.at_low += 1,
                    key if key == high => self.at_high += 1,
                    key => self.inside.push(key),
                }
            }
        }
    }

    /// Adds the counts and keys of another bracket with equal bounds.
    pub(crate) fn add(&mut self, other: &Self) {
        self.below += other.below;
        self.at_low += other.at_low;
        self.at_high += other.at_high;
        self.inside.extend_from_slice(&other.inside);
    }

    /// Returns the key of a rank, `None` if the rank is outside the bracket.
    pub(crate) fn find(&mut self, rank: usize) -> Option<u32> {
        let rank = rank.checked_sub(self.below)?;
        let Some(rank) = rank.checked_sub(self.at_low) else { return Some(self.low) };
        if rank < self.inside.len() {
            return Some(*self.inside.select_nth_unstable(rank).1);
        }
        (rank - self.inside.len() < self.at_high).then_some(self.high)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values() -> Vec<f64> {
        let mut values: Vec<f64> =
            (0..5000).map(|i| f64::from(i * i % 1999 - 900) * 1e-3).collect();
        values.extend([f64::INFINITY, f64::NEG_INFINITY, 0.0, 1e300, 1e-300, -1e300]);
        values
    }

    #[test]
    fn keys_are_in_the_order_of_the_values() {
        let mut values = values();
        values.sort_by(f64::total_cmp);
        let keys: Vec<u32> = values.iter().map(|&value| key(value)).collect();
        assert!(keys.is_sorted());
        assert!(keys.iter().zip(&values).all(|(&key, &x)| value(key) == f64::from(x as f32)));
    }

    #[test]
    fn ranks_are_those_of_the_sorted_values() {
        let mut keys: Vec<u32> = values().into_iter().map(key).collect();
        let mut sorted = keys.clone();
        sorted.sort_unstable();
        let sample: Vec<u32> = sorted.iter().copied().step_by(7).collect();
        for share in [0.05, 0.5, 0.95] {
            let mut parts = [Bracket::new(&sample, share), Bracket::new(&sample, share)];
            keys.rotate_left(123);
            keys.iter().enumerate().for_each(|(i, &key)| parts[i % 2].count(&[key]));
            let [mut sum, other] = parts;
            sum.add(&other);
            assert!(sum.inside.len() < keys.len() / 2);
            let rank = rank(share, keys.len());
            assert_eq!(sum.find(rank), Some(sorted[rank]), "{share}");
            // For the first and the last rank, the sample gives a wrong bracket.
            assert!([0, keys.len() - 1].iter().any(|&rank| sum.find(rank).is_none()));
        }
    }

    #[test]
    fn equal_values_are_counted_and_not_kept() {
        let mut bracket = Bracket::new(&[key(1.0); 100], 0.5);
        bracket.count(&[key(1.0 + 1e-12); 1000]);
        assert!(bracket.inside.is_empty());
        assert_eq!((bracket.find(999).map(value), bracket.find(1000)), (Some(1.0), None));
    }
}
