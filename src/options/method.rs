//! The method of a run: sweeps with or without corrections, and the settings of each method.

/// The method by which a run lowers the objective.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Method {
    /// [`Multilevel`](Self::Multilevel) if the base metric and the device allow corrections, else
    /// [`RELAXED`](Self::RELAXED). Sweeps that an application encodes are not corrected by this method.
    #[default]
    Auto,
    /// Sweeps alone at first. Once sweeps gain little, each sweep is followed by a correction from coarser levels.
    /// The number of sweeps until f is within 1e-6 of its limit hardly depends on the size of the mesh; docs/guide.md has
    /// the numbers. If the scheme has several metrics, only the sweeps alone alternate between them. Sweeps with
    /// corrections use the base metric, so that the run ends at the optimum of the base metric.
    ///
    /// Needs a base metric that [supports corrections](crate::Metric::supports_multilevel) (all but area). Sweeps that
    /// an application encodes with this method are corrected from the first sweep on; they need a single metric other
    /// than edge.
    Multilevel,
    /// Sweeps alone, with over-relaxed Newton steps.
    Relaxed(Relaxed),
    /// The method of Park & Shontz (ICCS 2011): sweeps alone, with plain Newton steps.
    Paper(Paper),
}

impl Method {
    /// [`Relaxed`](Self::Relaxed) with the default settings.
    pub const RELAXED: Self = Self::Relaxed(Relaxed::DEFAULT);
    /// [`Paper`](Self::Paper) with the default settings.
    pub const PAPER: Self = Self::Paper(Paper::DEFAULT);

    /// Returns the settings of over-relaxation in sweeps without corrections: those of [`Relaxed`], or the defaults.
    pub(crate) fn relaxed(self) -> Relaxed {
        match self {
            Self::Relaxed(relaxed) => relaxed,
            Self::Paper(_) => Relaxed { omega: Some(1.0), ..Relaxed::DEFAULT },
            Self::Auto | Self::Multilevel => Relaxed::DEFAULT,
        }
    }

    /// Returns the settings of a visit: those of [`Paper`], or the defaults.
    pub(crate) fn paper(self) -> Paper {
        match self {
            Self::Paper(paper) => paper,
            Self::Auto | Self::Multilevel | Self::Relaxed(_) => Paper::DEFAULT,
        }
    }
}

/// The settings of [`Method::Relaxed`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relaxed {
    /// Factor by which each Newton step is multiplied in its first trial, above 0 and below 2.
    ///
    /// `None` takes the factor of the metric in a scheme of one metric, and 1 in a scheme that alternates. If metrics
    /// alternate, each would have to undo the overshoot of the metric before, and the run would end worse (edge+imr on
    /// a 2,000-vertex mesh at 1.536 instead of 1.492).
    pub omega: Option<f64>,
    /// Number of sweeps with plain Newton steps before over-relaxation starts; 4 by default.
    pub unrelaxed_sweeps: u32,
}

impl Relaxed {
    const DEFAULT: Self = Self { omega: None, unrelaxed_sweeps: 4 };
}

impl Default for Relaxed {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// The settings of [`Method::Paper`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Paper {
    /// Largest number of Newton steps per visit of a vertex, from 1 to [`MAX_NEWTON_STEPS`](Self::MAX_NEWTON_STEPS); 1
    /// by default. With analytic derivatives, a visit ends earlier once its steps have become short.
    pub newton_steps: u32,
    /// Differentiation of metrics, by formulas or by differences.
    pub derivatives: Derivatives,
}

impl Paper {
    /// Upper limit of [`newton_steps`](Self::newton_steps). The limit exists because an [`Observer`](crate::Observer)
    /// cannot end a sweep.
    pub const MAX_NEWTON_STEPS: u32 = 1000;

    const DEFAULT: Self = Self { newton_steps: 1, derivatives: Derivatives::Analytic };
}

impl Default for Paper {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// Method to differentiate a metric.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Derivatives {
    /// Exactly, by formulas that tests compare with dual numbers.
    #[default]
    Analytic,
    /// By forward differences of the value, with 16 evaluations per triangle. Mesquite differentiates metrics without
    /// analytic derivatives this way (EDGE, AREA and RMS of Park & Shontz). Slower than formulas and no better,
    /// differences serve only to test the paper's cost model.
    FiniteDifference,
}
