//! The limit on the shape of triangles after a step.

/// A limit on the inverse mean ratio of triangles after a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Guard {
    /// Metrics with a barrier: no limit but the objective. With other metrics, a step may leave no triangle
    /// with an inverse mean ratio larger than that of the worst triangle with a free vertex before the run, nor larger
    /// than 30, unless the patch already had a worse triangle.
    #[default]
    ByMetric,
    /// With any metric, a step may leave no triangle worse than the worst triangle with a free vertex before the run,
    /// by the inverse mean ratio after target maps are applied. So the worst element of a run never gets worse.
    Worst,
}

impl Guard {
    /// The name on the command line and in checkpoints.
    pub fn name(self) -> &'static str {
        match self {
            Self::ByMetric => "by-metric",
            Self::Worst => "worst",
        }
    }
}
