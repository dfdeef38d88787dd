//! Colors by quality: the map of [`ColorScale`](crate::color_scale::ColorScale)s.

pub(crate) type Color = [u8; 3];

pub(crate) const BLACK: Color = [0, 0, 0];
pub(crate) const WHITE: Color = [255, 255, 255];
/// Color of inverted and flat triangles. The color is not on the scale, and differs in lightness from neighboring
/// colors.
pub const BAD: Color = [230, 25, 75];

/// Color of quadrilaterals and polygons, which no measure judges. The color is not on the scale.
pub(crate) const NEUTRAL: Color = [196, 198, 201];

/// Color of triangles between colored edges. The color is not on the scale, and lighter than [`NEUTRAL`].
pub(crate) const PALE: Color = [236, 238, 241];

/// Goodness that stands for [`NEUTRAL`]. Goodness of triangles is at most 1.
pub(crate) const UNJUDGED: f32 = 2.0;

/// Goodness that stands for [`PALE`].
pub(crate) const BETWEEN_EDGES: f32 = 3.0;

/// The color map Viridis (Smith & van der Walt, 2015), from bad to good. Its steps appear equal to normal and
/// color-blind vision, and in gray.
pub const VIRIDIS: [Color; 10] = [
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

/// Returns the color for a goodness from 0 (bad) to 1 (ideal), [`BAD`] for a negative one (inverted or flat), [`NEUTRAL`]
/// for [`UNJUDGED`], and [`PALE`] for [`BETWEEN_EDGES`].
pub(crate) fn of_goodness(goodness: f32) -> Color {
    if goodness < 0.0 {
        return BAD;
    }
    if goodness > 1.0 {
        return if goodness < BETWEEN_EDGES { NEUTRAL } else { PALE };
    }
    let place = goodness * (VIRIDIS.len() - 1) as f32;
    let first = (place as usize).min(VIRIDIS.len() - 2);
    let share = place - first as f32;
    let mix =
        |from: u8, to: u8| (f32::from(from) * (1.0 - share) + f32::from(to) * share).round() as u8;
    let (from, to) = (VIRIDIS[first], VIRIDIS[first + 1]);
    [0, 1, 2].map(|i: usize| mix(from[i], to[i]))
}

#[cfg(test)]
mod tests {
    use super::*;

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
