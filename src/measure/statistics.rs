//! Statistics of measures over the elements of a mesh.

use std::iter;
use std::ops::Range;

use crate::measure::definition::Better;
use crate::measure::measured::Measured;
use crate::measure::moments::Moments;
use crate::measure::ranks::{self, Bracket, SAMPLE, key, rank};
use crate::measure::table::Measure;
use crate::parallel::counting_sort::Groups;
use crate::parallel::map_parts;

/// Shares of the elements, from 0 to 1, for which [`Statistics::quantiles`] are given.
pub const QUANTILES: [f64; 3] = [0.05, 0.5, 0.95];

/// Number of elements that are measured at once. Their values fit a processor's cache.
const CHUNK: usize = 1024;

/// Chunks per part; a thread measures one part at a time.
const PART: usize = 64;

/// Statistics of a measure over the elements of a mesh or of a region. Elements without the measure are left out.
#[derive(Clone, Debug, PartialEq)]
pub struct Statistics {
    /// The measure.
    pub measure: Measure,
    /// Number of elements with the measure. If there are none (0), all other fields are meaningless.
    pub count: usize,
    /// Least value.
    pub min: f64,
    /// Mean; infinite if any value is infinite.
    pub mean: f64,
    /// Largest value.
    pub max: f64,
    /// Standard deviation of the values themselves (divisor n); infinite if any value is infinite.
    pub deviation: f64,
    /// For each share of [`QUANTILES`], the least value that this share of the elements does not exceed. The quantile
    /// is the value of an element, not interpolated, rounded to single precision.
    pub quantiles: [f64; 3],
    /// Index of the worst element, the first if several are equally bad.
    pub worst: usize,
}

/// The elements over which statistics are taken.
#[derive(Clone, Copy)]
enum Selection<'s> {
    /// All elements of the mesh; the field is their number.
    All(usize),
    /// Elements with the listed indices.
    Of(&'s [u32]),
}

impl Selection<'_> {
    fn len(&self) -> usize {
        match self {
            Self::All(count) => *count,
            Self::Of(indices) => indices.len(),
        }
    }

    #[inline]
    fn at(&self, i: usize) -> usize {
        match self {
            Self::All(_) => i,
            Self::Of(indices) => indices[i] as usize,
        }
    }
}

/// Partial result for one measure.
#[derive(Clone)]
struct Tally {
    moments: Moments,
    brackets: [Bracket; 3],
}

impl Measured<'_> {
    /// Computes statistics of several measures over all elements, in the order of `measures`.
    ///
    /// Values are not stored: beside the mesh, the computation needs 8 bytes per triangle for `size-ratio`, and some
    /// megabytes.
    pub fn statistics(&self, measures: &[Measure]) -> Vec<Statistics> {
        self.prepare(measures);
        self.statistics_of(measures, Selection::All(self.count()))
    }

    /// Computes statistics of several measures over the elements of each region. `regions` has the region of each
    /// element, 0-based. Returns a list for each region below `count`, each in the order of `measures`. Elements of other
    /// regions, and elements beyond the end of `regions`, are left out.
    pub fn statistics_by_region(
        &self,
        measures: &[Measure],
        regions: &[u32],
        count: usize,
    ) -> Vec<Vec<Statistics>> {
        self.prepare(measures);
        // The last group collects the elements that are left out.
        let region =
            |t: usize| regions.get(t).map_or(count, |&region| (region as usize).min(count));
        let groups = Groups::new(self.count(), count + 1, |t| [region(t) as u32]);
        let of_one = |region| self.statistics_of(measures, Selection::Of(groups.of(region)));
        (0..count).map(of_one).collect()
    }

    /// Computes statistics of several measures over the selected elements, in the order of `measures`.
    fn statistics_of(&self, measures: &[Measure], selection: Selection<'_>) -> Vec<Statistics> {
        let new = self.sampled(measures, selection);
        let tallies = self.tallies(measures, selection, &new);
        let one = |(&measure, tally)| self.conclude(measure, selection, tally);
        measures.iter().zip(tallies).map(one).collect()
    }

    /// Returns an empty tally per measure, with brackets determined from a sample of the elements.
    fn sampled(&self, measures: &[Measure], selection: Selection<'_>) -> Vec<Tally> {
        let count = selection.len();
        // The sample has one random element from each of many equal ranges. Equidistant samples might coincide with
        // the order of a regular mesh.
        let taken = count.min(SAMPLE);
        let place = |i: usize| {
            let (start, end) = (i * count / taken, (i + 1) * count / taken);
            start + ((i as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 33) as usize % (end - start)
        };
        let mut samples = vec![Vec::with_capacity(taken); measures.len()];
        for i in 0..taken {
            let index = selection.at(place(i));
            let samples = measures.iter().zip(&mut samples);
            self.visit_values(samples, index, |sample, value| sample.push(key(value)));
        }
        let tally = |mut sample: Vec<u32>| {
            sample.sort_unstable();
            let brackets = QUANTILES.map(|share| Bracket::new(&sample, share));
            Tally { moments: Moments::NONE, brackets }
        };
        samples.into_iter().map(tally).collect()
    }

    /// Measures all selected elements in one pass. Parts have a fixed size and are joined in order, so results are
    /// independent of the thread count.
    fn tallies(&self, measures: &[Measure], selection: Selection<'_>, new: &[Tally]) -> Vec<Tally> {
        let size = PART * CHUNK;
        let parts = (0..selection.len().div_ceil(size)).map(|part| part * PART..(part + 1) * PART);
        let parts = map_parts(parts, |_, chunks| {
            let mut tallies = new.to_vec();
            let mut values = vec![Vec::with_capacity(CHUNK); measures.len()];
            let mut keys = Vec::with_capacity(CHUNK);
            for chunk in chunks {
                self.measure(measures, selection, chunk, &mut values);
                for (tally, values) in tallies.iter_mut().zip(&values) {
                    tally.moments = tally.moments.and(&Moments::of(values, chunk));
                    keys.clear();
                    keys.extend(values.iter().map(|&value| key(value)));
                    tally.brackets.iter_mut().for_each(|bracket| bracket.count(&keys));
                }
            }
            tallies
        });
        let mut sums = new.to_vec();
        for part in &parts {
            for (sum, more) in sums.iter_mut().zip(part) {
                sum.moments = sum.moments.and(&more.moments);
                sum.brackets.iter_mut().zip(&more.brackets).for_each(|(sum, more)| sum.add(more));
            }
        }
        sums
    }

    /// Replaces the values of each measure by those of a chunk of the selected elements.
    fn measure(
        &self,
        measures: &[Measure],
        selection: Selection<'_>,
        chunk: usize,
        values: &mut [Vec<f64>],
    ) {
        values.iter_mut().for_each(Vec::clear);
        for i in range(chunk, selection) {
            let index = selection.at(i);
            let values = measures.iter().zip(&mut *values);
            self.visit_values(values, index, |values, value| values.push(value));
        }
    }

    fn conclude(&self, measure: Measure, selection: Selection<'_>, tally: Tally) -> Statistics {
        let Tally { moments, mut brackets } = tally;
        let ranks = QUANTILES.map(|share| rank(share, moments.count));
        let mut found = ranks.iter().zip(&mut brackets);
        let quantiles = match found.try_fold(Vec::new(), |mut keys, (&rank, bracket)| {
            keys.push(bracket.find(rank)?);
            Some(keys)
        }) {
            Some(keys) => [0, 1, 2].map(|i: usize| ranks::value(keys[i])),
            None => self.ranked(measure, selection, ranks),
        };
        let (extreme, chunk) = match measure.definition().better {
            Better::Higher => moments.least,
            Better::Lower => moments.most,
        };
        let value = |i: &usize| self.prepared_value(measure, selection.at(*i));
        let worst = range(chunk, selection).find(|i| value(i) == extreme);
        Statistics {
            measure,
            count: moments.count,
            min: moments.least.0,
            mean: moments.mean,
            max: moments.most.0,
            deviation: moments.deviation(),
            quantiles,
            worst: worst.map_or(0, |i| selection.at(i)),
        }
    }

    /// Returns the values at the given ranks by selection from a list of all values. Needed only if the sample gave a
    /// wrong bracket.
    #[cold]
    fn ranked(&self, measure: Measure, selection: Selection<'_>, ranks: [usize; 3]) -> [f64; 3] {
        let mut keys = Vec::with_capacity(selection.len());
        for i in 0..selection.len() {
            let all = iter::once((&measure, ()));
            self.visit_values(all, selection.at(i), |(), value| keys.push(key(value)));
        }
        ranks.map(|rank| match rank < keys.len() {
            true => ranks::value(*keys.select_nth_unstable(rank).1),
            false => f64::NAN,
        })
    }
}

/// Returns the elements of a chunk, as indices in the selection.
fn range(chunk: usize, selection: Selection<'_>) -> Range<usize> {
    let end = selection.len();
    (chunk * CHUNK).min(end)..((chunk + 1) * CHUNK).min(end)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Mesh;
    use crate::topology::Topology;

    /// If a sample gives a wrong bracket, quantiles come from a list of all values.
    #[test]
    fn a_misleading_sample_does_not_change_quantiles() {
        let points = (0..31 * 31).map(|i| {
            let (x, y) = (f64::from(i % 31), f64::from(i / 31));
            [x + 0.3 * (1.7 * x * y).sin(), y + 0.3 * (2.3 * x + y * y).cos()]
        });
        let squares = (0..30 * 30).map(|i| i / 30 * 31 + i % 30);
        let halves = squares.flat_map(|a| [[a, a + 1, a + 32], [a, a + 32, a + 31]]);
        let mesh =
            Mesh { points: points.collect(), triangles: halves.collect(), ..Mesh::default() };
        let topology = Topology::new(&mesh).unwrap();
        let measured = Measured::new(&mesh.points, &topology).unwrap();
        let all = Selection::All(measured.count());
        let found = &measured.statistics(&[Measure::Shape])[0];
        let ranks = QUANTILES.map(|share| rank(share, found.count));
        assert_eq!(measured.ranked(Measure::Shape, all, ranks), found.quantiles);
        // A sample of other values, all of them too high.
        let bracket = Bracket::new(&[key(7.0); 100], 0.5);
        let brackets = [bracket.clone(), bracket.clone(), bracket];
        let wrong = Tally { moments: Moments::NONE, brackets };
        let tally = measured.tallies(&[Measure::Shape], all, &[wrong]).remove(0);
        assert_eq!(measured.conclude(Measure::Shape, all, tally), *found);
    }
}
