//! The values of a measure that colors show, for pictures, pages and the Python package.

use gpu_smooth::measure::{Better, Measure};

use crate::terminal::numbers::short;

/// The values of a measure between which colors change. Values beyond have the color of the nearer end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColorScale {
    measure: Measure,
    bad: f64,
    good: f64,
}

impl ColorScale {
    /// Returns the default scale of a measure, where good meshes differ: the better half of a bounded range, or up to 1
    /// above the ideal; by `flow-link`, 0 to 0.8, which shows the limits of solvers. The scale depends only on the measure, so that pictures are comparable. Negative values of the
    /// scaled Jacobian belong to inverted triangles, and do not count.
    pub fn usual(measure: Measure) -> Self {
        let definition = measure.definition();
        let [least, most] = definition.range;
        let worst = match definition.better {
            Better::Higher => least.max(0.0),
            Better::Lower => most,
        };
        let ideal = definition.ideal;
        let [bad, good] = match measure {
            // The ideals of these measures are not round.
            Measure::FlowLink => [0.0, 0.8],
            Measure::SchismSkewness => [3.7, 2.7],
            _ if worst.is_finite() => [(worst + ideal) / 2.0, ideal],
            _ => [ideal + 1.0, ideal],
        };
        Self { measure, bad, good }
    }

    /// Returns the scale between two values of a measure.
    ///
    /// # Errors
    /// The reason as a sentence: the first value is not below the second, or a value is outside of the range of the measure.
    pub fn new(measure: Measure, [low, high]: [f64; 2]) -> Result<Self, String> {
        let definition = measure.definition();
        let [least, most] = definition.range;
        if !(least..=most).contains(&low) || !(least..=most).contains(&high) || high.is_infinite() {
            let values = match most.is_finite() {
                true => format!("from {least} to {most}"),
                false => format!("finite and at least {least}"),
            };
            return Err(format!("both values of {measure} must be {values}"));
        }
        if low >= high {
            return Err("the first value must be below the second".into());
        }
        let [bad, good] = match definition.better {
            Better::Higher => [low, high],
            Better::Lower => [high, low],
        };
        Ok(Self { measure, bad, good })
    }

    /// Returns this scale if the scale is that of `measure`, and the default scale of `measure` otherwise.
    pub(crate) fn or_usual(self, measure: Measure) -> Self {
        if measure == self.measure { self } else { Self::usual(measure) }
    }

    /// Describes the colors in a sentence without a period.
    pub fn legend(self) -> String {
        let ticks = self.ticks();
        let [bad, good] = [&ticks[0].1, &ticks[ticks.len() - 1].1];
        let name = match (self.measure.is_of_edges(), self.measure.name()) {
            (true, name) => format!("the worst {name} of their edges"),
            (false, name) => name.to_owned(),
        };
        format!(
            "Triangles by {name}: dark blue is {bad}, yellow is {good}, red is inverted or flat"
        )
    }

    /// Returns the measure that the colors show.
    pub(crate) fn measure(self) -> Measure {
        self.measure
    }

    /// Returns the values of the colors for bad and for good triangles.
    pub fn ends(self) -> [f64; 2] {
        [self.bad, self.good]
    }

    /// Returns the two values of [`new`](Self::new).
    pub(crate) fn range(self) -> [f64; 2] {
        [self.bad.min(self.good), self.bad.max(self.good)]
    }

    /// Rates a value from 0 (the bad end, or worse) to 1 (the good end, or better).
    pub(crate) fn goodness(self, value: f64) -> f32 {
        ((value - self.bad) / (self.good - self.bad)).clamp(0.0, 1.0) as f32
    }

    /// Returns the labeled values beside a scale, from bad to good. Signs at the ends state which further values have the
    /// color.
    pub(crate) fn ticks(self) -> Vec<(f64, String)> {
        let definition = self.measure.definition();
        let span = self.good - self.bad;
        let steps = [5, 6, 4, 3].into_iter().find(|&n| is_round(span / f64::from(n))).unwrap_or(5);
        let [worse, better] = match definition.better {
            Better::Higher => ["≤ ", "≥ "],
            Better::Lower => ["≥ ", "≤ "],
        };
        let tick = |i| {
            let value = self.bad + span * f64::from(i) / f64::from(steps);
            let sign = match i {
                0 if !definition.range.contains(&value) => worse,
                i if i == steps && self.good != definition.ideal => better,
                _ => "",
            };
            (value, format!("{sign}{}{}", short(value), definition.unit))
        };
        (0..=steps).map(tick).collect()
    }
}

/// Returns whether a number is 1, 2 or 5 times a power of ten, but for rounding.
fn is_round(number: f64) -> bool {
    let digit = number.abs() / 10_f64.powf(number.abs().log10().floor());
    [1.0, 2.0, 5.0, 10.0].iter().any(|round| (digit / round - 1.0).abs() < 1e-6)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scale_goes_from_bad_to_ideal() {
        for &measure in Measure::ALL {
            let scale = ColorScale::usual(measure);
            assert_eq!(scale.goodness(measure.definition().ideal), 1.0, "{measure}");
            let ticks = scale.ticks();
            let places: Vec<f32> = ticks.iter().map(|tick| scale.goodness(tick.0)).collect();
            assert!(places.is_sorted() && places[0] < 1e-6 && places[places.len() - 1] == 1.0);
            assert_eq!(ColorScale::new(measure, scale.range()), Ok(scale));
        }
        let goodness = |measure, value| ColorScale::usual(measure).goodness(value);
        assert_eq!(goodness(Measure::Condition, f64::INFINITY), 0.0);
        assert!((goodness(Measure::MinAngle, 45.0) - 0.5).abs() < 1e-6);
        assert_eq!([0.0, 0.5, 1.0].map(|value| goodness(Measure::Shape, value)), [0.0, 0.0, 1.0]);
    }

    #[test]
    fn ticks_are_round_and_state_what_lies_beyond_the_ends() {
        let names = |scale: ColorScale| {
            let names: Vec<String> = scale.ticks().into_iter().map(|tick| tick.1).collect();
            names.join(" ")
        };
        let usual = |measure| names(ColorScale::usual(measure));
        let of = |measure, range| names(ColorScale::new(measure, range).unwrap());
        assert_eq!(usual(Measure::Shape), "≤ 0.5 0.6 0.7 0.8 0.9 1");
        assert_eq!(usual(Measure::MinAngle), "≤ 30° 35° 40° 45° 50° 55° 60°");
        assert_eq!(usual(Measure::Condition), "≥ 2 1.8 1.6 1.4 1.2 1");
        assert_eq!(usual(Measure::FlowLink), "0 0.2 0.4 0.6 ≥ 0.8");
        assert_eq!(usual(Measure::SchismSkewness), "≥ 3.7 3.5 3.3 3.1 2.9 ≤ 2.7");
        assert_eq!(of(Measure::Shape, [0.0, 1.0]), "0 0.2 0.4 0.6 0.8 1");
        assert_eq!(of(Measure::Shape, [0.6, 0.9]), "≤ 0.6 0.65 0.7 0.75 0.8 0.85 ≥ 0.9");
        let legend = ColorScale::usual(Measure::Shape).legend();
        assert!(legend.starts_with("Triangles by shape: dark blue is ≤ 0.5, yellow is 1,"));
        let legend = ColorScale::usual(Measure::Orthogonality).legend();
        assert!(legend.starts_with("Triangles by the worst orthogonality of their edges: "));
        assert_eq!(of(Measure::MaxAngle, [80.0, 180.0]), "180° 160° 140° 120° 100° ≤ 80°");
    }

    #[test]
    fn other_values_than_those_of_the_measure_are_refused() {
        let refused = |measure, range| ColorScale::new(measure, range).unwrap_err();
        let ends = "both values of shape must be from 0 to 1";
        for range in [[0.5, 1.2], [-0.5, 1.0], [f64::NAN, 1.0], [0.5, f64::INFINITY]] {
            assert_eq!(refused(Measure::Shape, range), ends);
        }
        for range in [[0.5, 0.5], [1.0, 0.5]] {
            let order = "the first value must be below the second";
            assert_eq!(refused(Measure::Shape, range), order);
        }
        let ends = "both values of condition must be finite and at least 1";
        assert_eq!(refused(Measure::Condition, [1.0, f64::INFINITY]), ends);
        assert_eq!(refused(Measure::Condition, [0.5, 2.0]), ends);
    }
}
