//! All options of a run.

use crate::metric::{Metric, Scheme};
use crate::options::conflicts;
use crate::options::error::OptionError;
use crate::options::feature::Feature;
use crate::options::guard::Guard;
use crate::options::method::{Derivatives, Method};
use crate::options::norm::PNormExponent;
use crate::options::ranges::OptionRange;
use crate::options::stopping::{Goal, Stopping};
use crate::options::worst_by::WorstBy;
use crate::precision::Precision;

/// Declares the options of a run, each with its description, type and default. A setter has the name of its option.
macro_rules! options {
    ($($(#[$of:meta])* $name:ident: $kind:ty = $default:expr,)*) => {
        /// The options of a run. The mesh, its targets and its sliding vertices are not options: they belong to the
        /// [`Smoother`](crate::Smoother). [`Options::default`] smooths by IMR, with Newton steps of all vertices at the end, until at
        /// most 1e-6 of f is left to gain, and makes neither the least angle nor the worst inverse mean ratio worse; see
        /// [`Floored`](crate::outcome::Floored).
        ///
        /// Each option has a setter, as versions to come may have more options:
        ///
        /// ```
        /// use gpu_smooth::{Metric, Options, Stopping};
        ///
        /// let options = Options::default().scheme(Metric::Rms.into()).stopping(Stopping::Tolerance(1e-4));
        /// ```
        #[derive(Clone, Debug, PartialEq)]
        #[non_exhaustive]
        pub struct Options {
            $($(#[$of])* pub $name: $kind,)*
        }

        impl Default for Options {
            fn default() -> Self {
                Self { $($name: $default,)* }
            }
        }

        impl Options {
            $(
                #[doc = concat!("Sets [`", stringify!($name), "`](Self#structfield.", stringify!($name), ").")]
                #[must_use]
                pub fn $name(mut self, $name: $kind) -> Self {
                    self.$name = $name;
                    self
                }
            )*
        }
    };
}

options! {
    /// The metric, or several metrics that alternate. The first metric judges convergence.
    scheme: Scheme = Metric::Imr.into(),
    /// The method by which sweeps lower the objective.
    method: Method = Method::Auto,
    /// The criterion that ends the run before `max_sweeps` sweeps.
    stopping: Stopping = Stopping::default(),
    /// Largest number of sweeps.
    max_sweeps: u32 = 1000,
    /// A limit on the inverse mean ratio of triangles after a step. No step ever inverts a triangle.
    guard: Guard = Guard::ByMetric,
    /// Largest distance of a vertex from its position before the run, divided by the mean length of its edges before
    /// the run. Above 0; `None` for no bound. Only for whole runs.
    max_move: Option<f64> = None,
    /// Whether every triangle must keep an altitude of at least the least altitude in the mesh before the run, which
    /// bounds the time step of explicit solvers. Only for whole runs.
    keep_altitude: bool = false,
    /// Measure by which the worst triangles are improved after the last sweep, on the CPU; `None` for no improvement.
    /// Free vertices around the worst thousandth of the triangles (at least 10, at most 1000 triangles) move so that
    /// the worst triangle around them becomes less bad, and no other triangle around them becomes worse than that
    /// triangle was. f may rise a little. If the worst triangle of the mesh becomes no better, no vertex moves. Only
    /// for whole runs, and not after a canceled run.
    improve_worst: Option<WorstBy> = None,
    /// Precision of the file or buffer that will store the result. The run rounds all positions, fixed vertices
    /// included, to this precision before the final checks: the rounded mesh has no inverted triangle and a lower f.
    stored: Precision = Precision::Double,
    /// Exponent of the p-norm that replaces EDGE in Newton's method. `None` takes [`PNormExponent::CORRECTED`] in runs
    /// with corrections, up to an exponent that suffices for the tolerance, and [`PNormExponent::FIXED`] in runs of
    /// sweeps alone.
    edge_norm: Option<PNormExponent> = None,
    /// Whether the history holds the objective of every metric, or of the base metric alone.
    track_all: bool = false,
}

impl Options {
    /// Returns the options of the method of Park & Shontz (ICCS 2011): sweeps alone, one Newton step per visit, no
    /// over-relaxation.
    pub fn paper(scheme: Scheme) -> Self {
        Self { scheme, method: Method::PAPER, ..Self::default() }
    }

    /// Returns whether runs with these options are corrected from coarser levels, if the device has room for the
    /// levels.
    pub fn is_multilevel(&self) -> bool {
        let may_be = matches!(self.method, Method::Auto | Method::Multilevel);
        may_be && self.scheme.base().supports_multilevel()
    }

    /// Checks every number against its range, and every pair of features against the table of conflicts. The features
    /// are those of these options and `more` features of the run. [`Run`](crate::Run) checks its options too, together
    /// with the features of its smoother.
    ///
    /// # Errors
    /// [`OptionError::OutOfRange`] for the first number outside its range. If all ranges hold,
    /// [`OptionError::Conflict`] for the first conflict in table order.
    pub fn check_with(&self, more: &[Feature]) -> Result<(), OptionError> {
        self.check_ranges()?;
        let mut features = self.features();
        features.extend_from_slice(more);
        conflicts::check(&features)
    }

    /// Returns the features of these options for which the table of conflicts has rules.
    fn features(&self) -> Vec<Feature> {
        let goal = self.stopping.goal();
        let has_differences = self.method.paper().derivatives == Derivatives::FiniteDifference;
        let is_uneven = self.scheme.period() > 1 || !self.scheme.is_monotone();
        Feature::present([
            (Feature::UnevenScheme, is_uneven),
            (Feature::UncorrectedScheme, !self.scheme.base().supports_multilevel()),
            (Feature::Multilevel, self.method == Method::Multilevel),
            (Feature::FiniteDifferences, has_differences),
            (Feature::Goal, goal.is_some()),
            (Feature::WorstGuard, self.guard == Guard::Worst),
            (Feature::MaxMove, self.max_move.is_some()),
            (Feature::KeepAltitude, self.keep_altitude),
            (Feature::ImproveWorst, self.improve_worst.is_some()),
        ])
    }

    fn check_ranges(&self) -> Result<(), OptionError> {
        OptionRange::TOLERANCE.check(self.stopping.tolerance())?;
        if let Some(Goal { fraction, desired }) = self.stopping.goal() {
            OptionRange::FRACTION.check(fraction)?;
            OptionRange::DESIRED.check(desired.unwrap_or_default())?;
        }
        OptionRange::OMEGA.check(self.method.relaxed().omega.unwrap_or(1.0))?;
        OptionRange::NEWTON_STEPS.check(self.method.paper().newton_steps.into())?;
        OptionRange::MAX_MOVE.check(self.max_move.unwrap_or(1.0))?;
        if let Some(PNormExponent { first, last, .. }) = self.edge_norm {
            OptionRange::EXPONENT.check(first.max(last).into())?;
            if first > last {
                return Err(OptionRange::EXPONENT.refuse(first.into()));
            }
        }
        OptionRange::SCHEME_LENGTH.check(self.scheme.period().into())
    }
}
