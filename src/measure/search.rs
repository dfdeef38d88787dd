//! Counts elements by the values of a measure, and selects the worst elements.

use std::cmp::Ordering;

use crate::measure::measured::Measured;
use crate::measure::table::Measure;
use crate::parallel::map_ranges;

const CHUNK: usize = 1 << 12;

impl Measured<'_> {
    /// Returns the number of elements with a value in each interval between consecutive `edges`, which must ascend. An
    /// interval includes its lower edge; only the last interval includes its upper edge. Values outside all intervals
    /// and elements without the measure are not counted.
    pub fn histogram(&self, measure: Measure, edges: &[f64]) -> Vec<usize> {
        let Some(bins) = edges.len().checked_sub(1) else { return Vec::new() };
        self.prepare(&[measure]);
        let counts = map_ranges(self.count_with(measure), CHUNK, |range| {
            let mut counts = vec![0; bins];
            for t in range {
                let value = self.prepared_value(measure, t);
                let after = edges.partition_point(|&edge| edge <= value);
                let bin = if after > bins && value <= edges[bins] { bins } else { after };
                if (1..=bins).contains(&bin) {
                    counts[bin - 1] += 1;
                }
            }
            counts
        });
        let mut sum = vec![0; bins];
        counts.iter().flat_map(|part| part.iter().enumerate()).for_each(|(i, n)| sum[i] += n);
        sum
    }

    /// Returns the `most` worst elements by a measure as pairs of index and value, worst first. Equally bad elements are in
    /// ascending order of indices. Elements without the measure are left out.
    pub fn worst(&self, measure: Measure, most: usize) -> Vec<(usize, f64)> {
        self.prepare(&[measure]);
        let order = |a: &(usize, f64), b: &(usize, f64)| match measure.is_worse(a.1, b.1) {
            true => Ordering::Less,
            false if measure.is_worse(b.1, a.1) => Ordering::Greater,
            false => a.0.cmp(&b.0),
        };
        let keep = |mut found: Vec<(usize, f64)>| {
            if found.len() > most && most > 0 {
                found.select_nth_unstable_by(most - 1, order);
            }
            found.truncate(most);
            found
        };
        let parts = map_ranges(self.count_with(measure), CHUNK, |range| {
            keep(range.map(|t| (t, self.prepared_value(measure, t))).collect())
        });
        // Parts are joined one by one, so that the list never holds more than twice the wanted number of elements and
        // one part.
        let mut worst = Vec::new();
        for part in parts {
            worst.extend(part);
            if worst.len() > 2 * most.max(CHUNK) {
                worst = keep(worst);
            }
        }
        worst = keep(worst);
        worst.sort_by(order);
        worst
    }

    /// Returns the number of elements whose value satisfies `test`, and the index of the first such element. Elements without
    /// the measure are left out.
    pub fn count_where(
        &self,
        measure: Measure,
        test: impl Fn(f64) -> bool + Sync,
    ) -> (usize, Option<usize>) {
        self.prepare(&[measure]);
        let holds = |t: &usize| test(self.prepared_value(measure, *t));
        let parts = map_ranges(self.count_with(measure), CHUNK, |range| {
            let mut found = range.filter(holds);
            let first = found.next();
            (usize::from(first.is_some()) + found.count(), first)
        });
        let count = parts.iter().map(|part| part.0).sum();
        (count, parts.into_iter().find_map(|part| part.1))
    }
}
