//! The options of a run as users give them, by the words of all front ends.

use gpu_smooth::options::{Derivatives, PNormExponent, Paper, Precision, Relaxed};
use gpu_smooth::{Goal, Method, Metric, Options, Scheme, Stopping};

/// The share of the way to the desired f at which a run with a goal ends, if the user gives none.
const FRACTION: f64 = 0.95;
/// The tolerances of a run by ACUTE without and with sliding vertices, if the user gives none. By a smaller tolerance, no
/// triangle more becomes acute.
const ACUTE_TOLERANCES: [f64; 2] = [1e-4, 1e-3];

/// The name of a method.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum MethodName {
    /// The method that a setting of a single method selects, else [`Method::Auto`].
    #[default]
    Auto,
    /// [`Method::Multilevel`].
    Multilevel,
    /// [`Method::Relaxed`].
    Relaxed,
    /// [`Method::Paper`].
    Paper,
}

/// The options of a run as users give them. `None` stands for an option that the user left out.
#[derive(Clone, Debug, Default)]
pub struct RunRequest {
    /// Metrics of the sweeps, in turn.
    pub scheme: Option<Scheme>,
    /// The method, by its name.
    pub method: MethodName,
    /// Over-relaxation factor of [`Method::Relaxed`].
    pub omega: Option<f64>,
    /// Largest number of Newton steps in one visit of a vertex, by [`Method::Paper`].
    pub newton_steps: Option<u32>,
    /// Method of differentiation of [`Method::Paper`].
    pub derivatives: Option<Derivatives>,
    /// Whether the exponent of EDGE's p-norm doubles.
    pub doubles_exponent: Option<bool>,
    /// Estimated remaining gain, as a share of f, at which the run ends.
    pub tolerance: Option<f64>,
    /// Share of the way to the desired f at which a run with a goal ends.
    pub fraction: Option<f64>,
    /// Whether vertices slide, which sets the tolerance of a run by ACUTE.
    pub slides: bool,
    /// The desired f of a goal; `Some(None)` to search for it.
    pub desired: Option<Option<f64>>,
    /// The options that stand as they are: all but the scheme, the method, the end of the run, the precision and EDGE's norm.
    pub options: Options,
}

impl RunRequest {
    /// Returns whether the run has a goal instead of a tolerance.
    pub fn has_goal(&self) -> bool {
        self.fraction.is_some() || self.desired.is_some()
    }

    /// Returns the options of the library for points of a precision. `default` is the metric of a run without a scheme; see
    /// [`TargetKind::default_metric`](crate::TargetKind::default_metric).
    pub fn options(&self, default: Metric, stored: Precision) -> Options {
        let scheme = self.scheme.clone().unwrap_or_else(|| default.into());
        let fraction = self.fraction.unwrap_or(FRACTION);
        let goal = Goal { fraction, desired: self.desired.flatten() };
        let stopping = match (self.has_goal(), self.tolerance) {
            (true, _) => Stopping::Goal(goal),
            (false, Some(tolerance)) => Stopping::Tolerance(tolerance),
            (false, None) if matches!(scheme.base(), Metric::Acute | Metric::AcuteSize) => {
                Stopping::Tolerance(ACUTE_TOLERANCES[usize::from(self.slides)])
            }
            (false, None) => Stopping::default(),
        };
        let options = self
            .options
            .clone()
            .scheme(scheme)
            .method(self.method())
            .stopping(stopping)
            .stored(stored);
        // By default, the exponent of runs with corrections doubles as far as the tolerance requires.
        let doubles_anyway = options.is_multilevel() && options.scheme.base() == Metric::Edge;
        let edge_norm = match self.doubles_exponent {
            Some(false) => Some(PNormExponent::FIXED),
            Some(true) if !doubles_anyway => Some(PNormExponent::CONTINUED),
            _ => None,
        };
        options.edge_norm(edge_norm)
    }

    /// Returns the method. A setting that only one method has selects that method.
    fn method(&self) -> Method {
        let usual = Paper::default();
        let paper = Paper {
            newton_steps: self.newton_steps.unwrap_or(usual.newton_steps),
            derivatives: self.derivatives.unwrap_or(usual.derivatives),
        };
        let relaxed = Relaxed { omega: self.omega, ..Relaxed::default() };
        match self.method {
            MethodName::Multilevel => Method::Multilevel,
            MethodName::Relaxed => Method::Relaxed(relaxed),
            MethodName::Paper => Method::Paper(paper),
            MethodName::Auto if relaxed != Relaxed::default() => Method::Relaxed(relaxed),
            MethodName::Auto if paper != usual => Method::Paper(paper),
            MethodName::Auto => Method::Auto,
        }
    }
}

/// The processor on which a run computes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum EngineRequest {
    /// The CPU or a GPU, whichever is estimated to end the run sooner.
    #[default]
    Auto,
    /// The CPU.
    Cpu,
    /// The first GPU adapter with the text `adapter` in its name, or the best adapter if that is `None`.
    Gpu {
        /// Text that the name of the adapter contains.
        adapter: Option<String>,
    },
}

impl EngineRequest {
    /// Adds the name of an adapter, which selects the GPU.
    pub fn with_adapter(self, adapter: Option<String>) -> Self {
        match (self, adapter) {
            (Self::Cpu, _) => Self::Cpu,
            (Self::Auto, None) => Self::Auto,
            (Self::Auto | Self::Gpu { .. }, adapter) => Self::Gpu { adapter },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_setting_of_one_method_selects_the_method() {
        let method = |request: RunRequest| request.options(Metric::Imr, Precision::Double).method;
        assert_eq!(method(RunRequest::default()), Method::Auto);
        let paper = Paper { newton_steps: 3, ..Paper::default() };
        let asked = RunRequest { newton_steps: Some(3), ..RunRequest::default() };
        assert_eq!(method(asked), Method::Paper(paper));
        let asked = RunRequest { newton_steps: Some(1), ..RunRequest::default() };
        assert_eq!(method(asked), Method::Auto);
        let asked = RunRequest { omega: Some(1.2), ..RunRequest::default() };
        assert!(matches!(method(asked), Method::Relaxed(Relaxed { omega: Some(1.2), .. })));
    }

    #[test]
    fn acute_has_a_tolerance_of_its_own() {
        let stopping = |tolerance, slides| {
            let request = RunRequest { tolerance, slides, ..RunRequest::default() };
            request.options(Metric::Acute, Precision::Double).stopping
        };
        assert_eq!(stopping(None, false), Stopping::Tolerance(1e-4));
        assert_eq!(stopping(None, true), Stopping::Tolerance(1e-3));
        assert_eq!(stopping(Some(1e-6), true), Stopping::Tolerance(1e-6));
    }

    #[test]
    fn a_goal_replaces_the_tolerance_and_the_usual_exponent_of_edge_stays() {
        let request =
            RunRequest { desired: Some(None), tolerance: Some(1e-3), ..Default::default() };
        let goal = Goal { fraction: 0.95, desired: None };
        assert_eq!(request.options(Metric::Imr, Precision::Double).stopping, Stopping::Goal(goal));
        let norm = |scheme: Metric, doubles| {
            let (scheme, doubles_exponent) = (Some(scheme.into()), Some(doubles));
            let request = RunRequest { scheme, doubles_exponent, ..RunRequest::default() };
            request.options(Metric::Imr, Precision::Double).edge_norm
        };
        assert_eq!(norm(Metric::Edge, true), None);
        assert_eq!(norm(Metric::Imr, true), Some(PNormExponent::CONTINUED));
        assert_eq!(norm(Metric::Edge, false), Some(PNormExponent::FIXED));
    }
}
