//! Histograms of measures. The bins depend on the measure and the kinds of elements alone, so that histograms of two meshes are
//! comparable.

use gpu_smooth::measure::{Measure, Measured};

/// Numbers of elements by bins of a measure.
pub(crate) struct Histogram {
    pub(crate) measure: Measure,
    /// The edges of the bins, ascending: one more than `counts` has entries.
    pub(crate) edges: Vec<f64>,
    pub(crate) counts: Vec<usize>,
}

/// Counts the elements in each bin of a measure.
pub(crate) fn histogram(measured: &Measured<'_>, measure: Measure) -> Histogram {
    let has_quadrilaterals = measured.topology().quadrilaterals().len() > 0;
    let edges = edges(measure, has_quadrilaterals);
    let counts = measured.histogram(measure, &edges);
    Histogram { measure, edges, counts }
}

/// Returns the edges of a measure's bins, ascending. Angles of quadrilaterals have further bins above those of triangles.
fn edges(measure: Measure, has_quadrilaterals: bool) -> Vec<f64> {
    let definition = measure.definition();
    let [least, most] = definition.range;
    if most.is_finite() {
        // Bins of angles are 5° or 10° wide, other bins of bounded measures 0.1, or narrower in a range shorter than 1.
        let bins = match definition.unit {
            "°" => 12,
            _ => ((10.0 * (most - least)) as u32).max(10),
        };
        let edge = |i| least + (most - least) * f64::from(i) / f64::from(bins);
        let largest = definition.quadrilateral.filter(|_| has_quadrilaterals);
        let largest = largest.map_or(most, |definition| definition.range[1]);
        let mut edges: Vec<f64> = (0..=bins).map(edge).collect();
        edges.extend((bins + 1..).map(edge).take_while(|&edge| edge <= largest));
        return edges;
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
            let (edges, [least, most]) = (edges(measure, false), measure.definition().range);
            assert!(edges.is_sorted() && (11..22).contains(&edges.len()), "{measure}");
            assert_eq!((edges[0], edges[edges.len() - 1]), (least, most), "{measure}");
        }
        assert_eq!(edges(Measure::MinAngle, false)[1..3], [5.0, 10.0]);
        assert_eq!(edges(Measure::ScaledJacobian, false).len(), 21);
        assert_eq!(
            edges(Measure::MinAngle, true)[12..],
            [60.0, 65.0, 70.0, 75.0, 80.0, 85.0, 90.0]
        );
        assert_eq!(edges(Measure::MaxAngle, true).last(), Some(&360.0));
        assert_eq!(edges(Measure::Shape, true), edges(Measure::Shape, false));
    }
}
