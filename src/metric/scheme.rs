//! Schemes: the metric of each sweep.

use crate::metric::table::{Metric, UnknownMetric};

/// A sequence of metrics, used sweep by sweep in turn. The first is the base metric, which alone judges convergence
/// (Park & Shontz, Section 2.2). Parsed from and displayed as names joined by `+`, such as `edge+imr+imr`.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Scheme(Vec<Metric>);

impl Scheme {
    /// Largest number of metrics in a scheme. The stop rule looks back over four periods or more, and a device stores
    /// 256 evaluations.
    pub const LONGEST: u32 = 60;

    /// Makes a scheme of the given metrics, `None` for an empty list.
    pub fn new(metrics: impl Into<Vec<Metric>>) -> Option<Self> {
        let metrics = metrics.into();
        (!metrics.is_empty()).then_some(Self(metrics))
    }

    /// Returns the base metric, which judges convergence.
    pub fn base(&self) -> Metric {
        self.0[0]
    }

    /// Returns the metric of a sweep. Sweeps count from 1, and sweep 1 uses the base metric.
    pub fn metric(&self, sweep: u32) -> Metric {
        self.0[(sweep.max(1) as usize - 1) % self.0.len()]
    }

    /// Returns the number of sweeps after which the scheme repeats.
    pub fn period(&self) -> u32 {
        self.0.len() as u32
    }

    /// Returns the metrics in the order of their sweeps.
    pub fn metrics(&self) -> &[Metric] {
        &self.0
    }

    /// Returns whether the scheme has metrics other than the base metric.
    pub fn alternates(&self) -> bool {
        self.0.iter().any(|&metric| metric != self.base())
    }

    /// Returns whether every sweep lowers the base objective, so that the last state is the best. True for a single
    /// metric that is smooth.
    pub fn is_monotone(&self) -> bool {
        !self.alternates() && self.base().is_smooth()
    }
}

impl From<Metric> for Scheme {
    fn from(metric: Metric) -> Self {
        Self(vec![metric])
    }
}

impl std::fmt::Display for Scheme {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0.iter().map(|m| m.name()).collect::<Vec<_>>().join("+"))
    }
}

impl std::str::FromStr for Scheme {
    type Err = UnknownMetric;
    fn from_str(text: &str) -> Result<Self, UnknownMetric> {
        text.split('+').map(str::parse).collect::<Result<Vec<_>, _>>().map(Self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scheme_alternates_beginning_with_its_base_metric() {
        let scheme: Scheme = "EDGE+imr+ imr".parse().unwrap();
        assert_eq!(scheme.to_string(), "edge+imr+imr");
        assert_eq!(scheme.base(), Metric::Edge);
        let metrics: Vec<_> = (1..=4).map(|k| scheme.metric(k).name()).collect();
        assert_eq!(metrics, ["edge", "imr", "imr", "edge"]);
    }

    #[test]
    fn an_unknown_metric_is_named_in_the_error() {
        let error = "edge+foo".parse::<Scheme>().unwrap_err();
        let told = error.to_string();
        assert!(told.starts_with("no metric is called 'foo'; there are edge, area, "), "{told}");
        assert!(Metric::ALL.iter().all(|metric| told.contains(metric.name())), "{told}");
        assert!("".parse::<Scheme>().is_err());
        assert!("imr+".parse::<Scheme>().is_err());
    }
}
