//! The limit on the inverse mean ratio of triangles after a step.

/// A limit on the inverse mean ratio of triangles after a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Guard {
    /// No limit for metrics with a barrier, whose objective already holds off flat triangles. With other metrics, the
    /// limit is the inverse mean ratio of the worst triangle with a free vertex before the run, or 30 if that is less.
    /// In a patch that already has a worse triangle, the ratio of that triangle is the limit.
    #[default]
    ByMetric,
    /// With any metric, the limit is the inverse mean ratio of the worst triangle with a free vertex before the run,
    /// after target maps are applied. The worst element of a run therefore never gets worse.
    Worst,
}

impl Guard {
    /// Returns the name on the command line and in checkpoints.
    pub fn name(self) -> &'static str {
        match self {
            Self::ByMetric => "by-metric",
            Self::Worst => "worst",
        }
    }
}
