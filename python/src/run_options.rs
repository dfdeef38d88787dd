//! The options of a run, by the names of the command line.

use std::path::{Path, PathBuf};
use std::time::Duration;

use gpu_smooth::options::{
    Derivatives, OptionRange, Options, PNormExponent, Paper, Relaxed, WorstBy,
};
use gpu_smooth::precision::Precision;
use gpu_smooth::{Goal, Guard, Method, Metric, Scheme, Stopping};
use pyo3::prelude::*;

use crate::error;
use crate::values::{self, Given};

/// Names of the options of a run.
pub(crate) const NAMES: &[&str] = &[
    "scheme",
    "engine",
    "adapter",
    "max_sweeps",
    "tolerance",
    "fraction",
    "desired",
    "time_limit",
    "method",
    "omega",
    "inner",
    "derivatives",
    "edge_norm",
    "guard",
    "improve_worst",
    "max_move",
    "keep_altitude",
    "history",
    "on_sweep",
    "checkpoint",
    "checkpoint_every",
    "resume",
];

/// The file of a run's checkpoints, and the time between two checkpoints.
pub(crate) struct CheckpointPlan {
    pub(crate) file: PathBuf,
    pub(crate) every: Duration,
}

/// The processor on which a run computes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum EngineChoice {
    /// The CPU or a GPU, whichever is estimated to end the run sooner.
    Auto,
    Cpu,
    /// The best GPU adapter with the text in its name; `None` for any name.
    Gpu(Option<String>),
}

#[derive(Clone, Copy, PartialEq)]
enum MethodChoice {
    Auto,
    Multilevel,
    Relaxed,
    Paper,
}

/// The options of a run; `None` for options that the caller left out.
#[derive(Default)]
pub(crate) struct RunOptions {
    scheme: Option<Scheme>,
    engine: Option<EngineChoice>,
    adapter: Option<String>,
    max_sweeps: Option<u32>,
    tolerance: Option<f64>,
    fraction: Option<f64>,
    /// The desired f; `Some(None)` to search for it.
    desired: Option<Option<f64>>,
    time_limit: Option<Duration>,
    method: Option<MethodChoice>,
    omega: Option<f64>,
    inner: Option<u32>,
    derivatives: Option<Derivatives>,
    /// Whether the exponent of edge's p-norm doubles.
    edge_norm: Option<bool>,
    guard: Option<Guard>,
    improve_worst: Option<WorstBy>,
    max_move: Option<f64>,
    keep_altitude: bool,
    tracks_all: bool,
    on_sweep: Option<Py<PyAny>>,
    checkpoint: Option<PathBuf>,
    checkpoint_every: Option<Duration>,
    resume: Option<PathBuf>,
}

impl RunOptions {
    /// Sets an option. Returns false if no option of a run has the name.
    pub(crate) fn set(&mut self, given: Given<'_, '_>) -> PyResult<bool> {
        match given.name {
            "scheme" => self.scheme = Some(scheme(given)?),
            "engine" => {
                let engines = [
                    ("auto", EngineChoice::Auto),
                    ("gpu", EngineChoice::Gpu(None)),
                    ("cpu", EngineChoice::Cpu),
                ];
                self.engine = Some(given.word(&engines)?);
            }
            "adapter" => self.adapter = Some(given.text()?),
            "max_sweeps" => self.max_sweeps = Some(given.count(0, u32::MAX)?),
            "tolerance" => self.tolerance = Some(given.number(OptionRange::TOLERANCE)?),
            "fraction" => self.fraction = Some(given.number(OptionRange::FRACTION)?),
            "desired" => {
                let is_searched = given.value.extract::<&str>().is_ok_and(|word| word == "auto");
                let number = || given.number_in("a finite number or \"auto\"", f64::is_finite);
                self.desired = Some(if is_searched { None } else { Some(number()?) });
            }
            "time_limit" => self.time_limit = Some(given.seconds()?),
            "method" => {
                self.method = Some(given.word(&[
                    ("auto", MethodChoice::Auto),
                    ("multilevel", MethodChoice::Multilevel),
                    ("relaxed", MethodChoice::Relaxed),
                    ("paper", MethodChoice::Paper),
                ])?);
            }
            "omega" => self.omega = Some(given.number(OptionRange::OMEGA)?),
            "inner" => self.inner = Some(given.count(1, Paper::MAX_NEWTON_STEPS)?),
            "derivatives" => {
                self.derivatives = Some(given.word(&[
                    ("analytic", Derivatives::Analytic),
                    ("finite-difference", Derivatives::FiniteDifference),
                ])?);
            }
            "edge_norm" => {
                self.edge_norm = Some(given.word(&[("fixed", false), ("continued", true)])?);
            }
            "guard" => {
                let guards = [Guard::ByMetric, Guard::Worst].map(|guard| (guard.name(), guard));
                self.guard = Some(given.word(&guards)?);
            }
            "improve_worst" => self.improve_worst = worst_by(given)?,
            "max_move" => self.max_move = Some(given.number(OptionRange::MAX_MOVE)?),
            "keep_altitude" => self.keep_altitude = given.flag()?,
            "history" => self.tracks_all = given.word(&[("base", false), ("all", true)])?,
            "on_sweep" => {
                if !given.value.is_callable() {
                    return Err(given.refused("a function of one argument"));
                }
                self.on_sweep = Some(given.value.clone().unbind());
            }
            "checkpoint" => self.checkpoint = Some(given.path()?),
            "checkpoint_every" => self.checkpoint_every = Some(given.seconds()?),
            "resume" => self.resume = Some(given.path()?),
            _ => return Ok(false),
        }
        Ok(true)
    }

    /// Sets an option of `function`, which has no other options. None is the default of each option.
    pub(crate) fn set_named(
        &mut self,
        name: &Bound<'_, PyAny>,
        value: &Bound<'_, PyAny>,
        function: &str,
    ) -> PyResult<()> {
        let name: String = name.extract()?;
        let is_known = match value.is_none() {
            true => NAMES.contains(&&*name),
            false => self.set(Given { name: &name, value })?,
        };
        match is_known {
            true => Ok(()),
            false => Err(values::unknown(value.py(), &name, function, NAMES)),
        }
    }

    /// Checks for options that exclude each other, apart from the pairs that the library refuses.
    pub(crate) fn check(&self, py: Python<'_>) -> PyResult<()> {
        let method = self.method.unwrap_or(MethodChoice::Auto);
        let is_auto_or = |own| [MethodChoice::Auto, own].contains(&method);
        let has_paper = self.inner.is_some() || self.derivatives.is_some();
        let has_goal = self.fraction.is_some() || self.desired.is_some();
        let refusals = [
            (
                self.omega.is_some() && !is_auto_or(MethodChoice::Relaxed),
                "omega belongs to method=\"relaxed\". Drop it, or pass this method",
            ),
            (
                has_paper && !is_auto_or(MethodChoice::Paper),
                "inner and derivatives belong to method=\"paper\". Drop them, or pass this method",
            ),
            (
                has_paper && self.omega.is_some(),
                "omega does not go with inner and derivatives: each selects another method. Drop one of them",
            ),
            (
                has_goal && self.tolerance.is_some(),
                "tolerance does not go with fraction and desired: a run has one criterion to end. Drop one of them",
            ),
            (
                self.adapter.is_some() && self.engine == Some(EngineChoice::Cpu),
                "adapter does not go with engine=\"cpu\": it names a GPU. Drop one of them",
            ),
            (
                self.checkpoint_every.is_some() && self.checkpoint_plan().is_none(),
                "checkpoint_every needs checkpoint or resume. Pass the file of the checkpoints, or drop checkpoint_every",
            ),
        ];
        match refusals.iter().find(|(is_refused, _)| *is_refused) {
            Some((_, text)) => Err(error::option(py, text)),
            None => Ok(()),
        }
    }

    /// Returns the options of the library for points of a precision. `default` is the metric of a run without a scheme.
    pub(crate) fn library(&self, stored: Precision, default: Metric) -> Options {
        let goal =
            Goal { fraction: self.fraction.unwrap_or(0.95), desired: self.desired.flatten() };
        let has_goal = self.fraction.is_some() || self.desired.is_some();
        let usual = Options::default();
        let options = Options {
            scheme: self.scheme.clone().unwrap_or_else(|| default.into()),
            method: self.method(),
            stopping: match (has_goal, self.tolerance) {
                (true, _) => Stopping::Goal(goal),
                (false, Some(tolerance)) => Stopping::Tolerance(tolerance),
                (false, None) => usual.stopping,
            },
            max_sweeps: self.max_sweeps.unwrap_or(usual.max_sweeps),
            guard: self.guard.unwrap_or_default(),
            max_move: self.max_move,
            keep_altitude: self.keep_altitude,
            improve_worst: self.improve_worst,
            stored,
            track_all: self.tracks_all,
            ..usual
        };
        let doubles_anyway = options.is_multilevel() && options.scheme.base() == Metric::Edge;
        let edge_norm = match self.edge_norm {
            Some(false) => Some(PNormExponent::FIXED),
            Some(true) if !doubles_anyway => Some(PNormExponent::CONTINUED),
            _ => None,
        };
        Options { edge_norm, ..options }
    }

    /// Returns the method. A setting that only one method has selects that method.
    fn method(&self) -> Method {
        let paper = Paper {
            newton_steps: self.inner.unwrap_or(1),
            derivatives: self.derivatives.unwrap_or_default(),
        };
        let relaxed = Relaxed { omega: self.omega, ..Relaxed::default() };
        match self.method.unwrap_or(MethodChoice::Auto) {
            MethodChoice::Multilevel => Method::Multilevel,
            MethodChoice::Relaxed => Method::Relaxed(relaxed),
            MethodChoice::Paper => Method::Paper(paper),
            MethodChoice::Auto if relaxed != Relaxed::default() => Method::Relaxed(relaxed),
            MethodChoice::Auto if paper != Paper::default() => Method::Paper(paper),
            MethodChoice::Auto => Method::Auto,
        }
    }

    /// Returns the engine. The name of an adapter selects the GPU.
    pub(crate) fn engine(&self) -> EngineChoice {
        match (self.engine.clone().unwrap_or(EngineChoice::Auto), &self.adapter) {
            (EngineChoice::Cpu, _) => EngineChoice::Cpu,
            (EngineChoice::Auto, None) => EngineChoice::Auto,
            (_, adapter) => EngineChoice::Gpu(adapter.clone()),
        }
    }

    /// Returns the time after which the run ends.
    pub(crate) fn time_limit(&self) -> Option<Duration> {
        self.time_limit
    }

    /// Returns the file of the run's checkpoints. A continued run saves its checkpoints to the file that it continues
    /// from, unless another file is named.
    pub(crate) fn checkpoint_plan(&self) -> Option<CheckpointPlan> {
        const USUAL: Duration = Duration::from_secs(300);
        let file = self.checkpoint.as_ref().or(self.resume.as_ref())?.clone();
        Some(CheckpointPlan { file, every: self.checkpoint_every.unwrap_or(USUAL) })
    }

    /// Returns the file of the checkpoint from which the run continues.
    pub(crate) fn resume(&self) -> Option<&Path> {
        self.resume.as_deref()
    }

    /// Returns the function that is called during the run.
    pub(crate) fn on_sweep(&self) -> Option<&Py<PyAny>> {
        self.on_sweep.as_ref()
    }
}

/// Returns the scheme of a text such as `edge+imr`, or of a list of metrics.
fn scheme(given: Given<'_, '_>) -> PyResult<Scheme> {
    let names: String = match given.value.extract::<Vec<String>>() {
        Ok(names) if !given.value.is_instance_of::<pyo3::types::PyString>() => names.join("+"),
        _ => given
            .value
            .extract()
            .map_err(|_| given.refused("a text such as \"imr\" or \"edge+imr\""))?,
    };
    names.replace('_', "-").parse().map_err(|unknown: gpu_smooth::metric::UnknownMetric| {
        error::option(given.value.py(), &format!("scheme: {unknown}"))
    })
}

/// Returns the measure of `improve_worst`: True for imr, False for none, or the name of a measure.
fn worst_by(given: Given<'_, '_>) -> PyResult<Option<WorstBy>> {
    match given.value.extract::<bool>() {
        Ok(is_wanted) => Ok(is_wanted.then_some(WorstBy::Imr)),
        Err(_) => given.word(&WorstBy::ALL.map(|by| (by.name(), by))).map(Some),
    }
}
