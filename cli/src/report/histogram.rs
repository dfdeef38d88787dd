//! Histograms of measures. The bins depend only on the measure, so that histograms of two meshes are comparable.

use gpu_smooth::measure::{Measure, Measured};

/// Numbers of triangles by bins of a measure.
pub(crate) struct Histogram {
    pub(crate) measure: Measure,
    /// The edges of the bins, ascending: one more than `counts` has entries.
    pub(crate) edges: Vec<f64>,
    pub(crate) counts: Vec<usize>,
}

/// Counts the triangles in each bin of a measure.
pub(crate) fn histogram(measured: &Measured<'_>, measure: Measure) -> Histogram {
    let edges = edges(measure);
    let counts = measured.histogram(measure, &edges);
    Histogram { measure, edges, counts }
}

/// Returns the edges of a measure's bins, ascending.
fn edges(measure: Measure) -> Vec<f64> {
    let definition = measure.definition();
    let [least, most] = definition.range;
    if most.is_finite() {
        // Bins of angles are 5° or 10° wide, other bins of bounded measures 0.1, or narrower in a range shorter than 1.
        let bins = match definition.unit {
            "°" => 12,
            _ => ((10.0 * (most - least)) as u32).max(10),
        };
        let edge = |i| least + (most - least) * f64::from(i) / f64::from(bins);
        return (0..=bins).map(edge).collect();
    }
    // Bins of ratios are measured from the ideal value upward, and the last bin is unbounded. Size ratios may also
    // be below the ideal.
    let below = [0.0, 0.1, 0.25, 0.5, 0.75, 0.9].into_iter().filter(|_| least < definition.ideal);
    let below = below.map(|share| share * definition.ideal);
    let above =
        [0.0, 0.05, 0.1, 0.2, 0.35, 0.5, 0.75, 1.0, 1.5, 2.0, 4.0, 9.0, 99.0, f64::INFINITY];
    below.chain(above.map(|above| definition.ideal + above)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bins_cover_every_value() {
        for &measure in Measure::ALL {
            let (edges, [least, most]) = (edges(measure), measure.definition().range);
            assert!(edges.is_sorted() && (11..22).contains(&edges.len()), "{measure}");
            assert_eq!((edges[0], edges[edges.len() - 1]), (least, most), "{measure}");
        }
        assert_eq!(edges(Measure::MinAngle)[1..3], [5.0, 10.0]);
        assert_eq!(edges(Measure::ScaledJacobian).len(), 21);
    }
}
