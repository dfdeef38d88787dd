//! Colors by quality.

use gpu_smooth::measure::{Better, Measure};

pub(crate) type Color = [u8; 3];

pub(crate) const BLACK: Color = [0, 0, 0];
pub(crate) const WHITE: Color = [255, 255, 255];
/// Color of inverted and flat triangles. The color is not on the scale, and differs in lightness from neighboring
/// colors.
pub(crate) const BAD: Color = [230, 25, 75];

/// Color of quadrilaterals and polygons, which no measure judges. The color is not on the scale.
pub(crate) const NEUTRAL: Color = [196, 198, 201];

/// Goodness that stands for [`NEUTRAL`]. Goodness of triangles is at most 1.
pub(crate) const UNJUDGED: f32 = 2.0;

/// The color map Viridis (Smith & van der Walt, 2015), from bad to good. Its steps appear equal to normal and
/// color-blind vision, and in gray.
pub(crate) const VIRIDIS: [Color; 10] = [
    [68, 1, 84],
    [72, 40, 120],
    [62, 73, 137],
    [49, 104, 142],
    [38, 130, 142],
    [31, 158, 137],
    [53, 183, 121],
    [110, 206, 88],
    [181, 222, 43],
    [253, 231, 37],
];

/// Returns the color for a goodness from 0 (bad) to 1 (ideal), [`BAD`] for a negative one (inverted or flat), and
/// [`NEUTRAL`] for one above 1.
pub(crate) fn of_goodness(goodness: f32) -> Color {
    if goodness < 0.0 {
        return BAD;
    }
    if goodness > 1.0 {
        return NEUTRAL;
    }
    let place = goodness * (VIRIDIS.len() - 1) as f32;
    let first = (place as usize).min(VIRIDIS.len() - 2);
    let share = place - first as f32;
    let mix =
        |from: u8, to: u8| (f32::from(from) * (1.0 - share) + f32::from(to) * share).round() as u8;
    let (from, to) = (VIRIDIS[first], VIRIDIS[first + 1]);
    [0, 1, 2].map(|i: usize| mix(from[i], to[i]))
}

/// Distance of a ratio above its ideal at the bad end of the scale.
const WORST_ABOVE: f64 = 9.0;

/// Rates a value from 0 (bad) to 1 (ideal). The scale depends only on the measure, so that pictures are comparable. A
/// bounded measure has a linear scale over its range; an unbounded one has a logarithmic scale up to 9 above the
/// ideal.
pub(crate) fn goodness(measure: Measure, value: f64) -> f32 {
    let definition = measure.definition();
    let share = match bad_end(measure) {
        Some(bad) => (value - bad) / (definition.ideal - bad),
        None => 1.0 - (1.0 + (value - definition.ideal).abs()).ln() / (1.0 + WORST_ABOVE).ln(),
    };
    // Clamping also maps NaN, which no measure returns, to a defined color.
    share.clamp(0.0, 1.0) as f32
}

/// Returns the bad end of a measure's scale; `None` for unbounded measures. The scale of the scaled Jacobian ends at
/// 0, because lower values belong to inverted triangles.
pub(crate) fn bad_end(measure: Measure) -> Option<f64> {
    let definition = measure.definition();
    let bad = match definition.better {
        Better::Higher => definition.range[0].max(0.0),
        Better::Lower => definition.range[1],
    };
    bad.is_finite().then_some(bad)
}

/// Returns the labeled values beside a scale, from bad to good.
pub(crate) fn ticks(measure: Measure) -> Vec<(f64, String)> {
    let definition = measure.definition();
    let Some(bad) = bad_end(measure) else {
        let above = [WORST_ABOVE, 4.0, 2.0, 1.0, 0.5, 0.0];
        let name = |value: f64, above: f64| match above == WORST_ABOVE {
            true => format!("≥ {}", short(value)),
            false => short(value),
        };
        return above.map(|a| (definition.ideal + a, name(definition.ideal + a, a))).to_vec();
    };
    let steps = if (definition.ideal - bad).abs() == 60.0 { 6 } else { 4 };
    let value = |i| bad + (definition.ideal - bad) * f64::from(i) / f64::from(steps);
    (0..=steps)
        .map(value)
        .map(|value| (value, format!("{}{}", short(value), definition.unit)))
        .collect()
}

/// Formats a number with the digits of single precision, which hides rounding errors of double precision.
pub(crate) fn short(number: f64) -> String {
    (number as f32).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scale_goes_from_bad_to_ideal() {
        for &measure in Measure::ALL {
            assert_eq!(goodness(measure, measure.definition().ideal), 1.0, "{measure}");
            let ticks = ticks(measure);
            let places: Vec<f32> = ticks.iter().map(|tick| goodness(measure, tick.0)).collect();
            assert!(places.is_sorted() && places[0] < 1e-6 && places[places.len() - 1] == 1.0);
        }
        assert_eq!(goodness(Measure::Condition, f64::INFINITY), 0.0);
        assert!((goodness(Measure::MinAngle, 30.0) - 0.5).abs() < 1e-6);
        assert_eq!(ticks(Measure::MinAngle)[1].1, "10°");
    }

    /// Each step up the scale must be lighter in gray.
    #[test]
    fn better_is_lighter() {
        let gray = |goodness: f32| {
            let [r, g, b] = of_goodness(goodness).map(f32::from);
            0.299 * r + 0.587 * g + 0.114 * b
        };
        let grays: Vec<f32> = (0..=100).map(|i| gray(i as f32 / 100.0)).collect();
        assert!(grays.windows(2).all(|pair| pair[1] > pair[0]));
        assert_eq!(
            (of_goodness(0.0), of_goodness(1.0), of_goodness(-1.0)),
            (VIRIDIS[0], VIRIDIS[9], BAD)
        );
    }
}
