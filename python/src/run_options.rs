//! The options of a run, by the names of the command line.

use std::path::{Path, PathBuf};
use std::time::Duration;

use gpu_smooth::options::{Derivatives, OptionRange, Options, Paper, WorstBy};
use gpu_smooth::precision::Precision;
use gpu_smooth::{Guard, Metric, Scheme};
use gpu_smooth_job::{CheckpointFile, EngineRequest, MethodName, RunRequest};
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

/// The options of a run; `None` for options that the caller left out.
#[derive(Default)]
pub(crate) struct RunOptions {
    request: RunRequest,
    engine: Option<EngineRequest>,
    adapter: Option<String>,
    time_limit: Option<Duration>,
    on_sweep: Option<Py<PyAny>>,
    checkpoint: Option<PathBuf>,
    checkpoint_every: Option<Duration>,
    resume: Option<PathBuf>,
}

impl RunOptions {
    /// Sets an option. Returns false if no option of a run has the name.
    pub(crate) fn set(&mut self, given: Given<'_, '_>) -> PyResult<bool> {
        let to = &mut self.request;
        match given.name {
            "scheme" => to.scheme = Some(scheme(given)?),
            "engine" => {
                let engines = [
                    ("auto", EngineRequest::Auto),
                    ("gpu", EngineRequest::Gpu { adapter: None }),
                    ("cpu", EngineRequest::Cpu),
                ];
                self.engine = Some(given.word(&engines)?);
            }
            "adapter" => self.adapter = Some(given.text()?),
            "max_sweeps" => to.max_sweeps = Some(given.count(0, u32::MAX)?),
            "tolerance" => to.tolerance = Some(given.number(OptionRange::TOLERANCE)?),
            "fraction" => to.fraction = Some(given.number(OptionRange::FRACTION)?),
            "desired" => {
                let is_searched = given.value.extract::<&str>().is_ok_and(|word| word == "auto");
                let number = || given.number_in("a finite number or \"auto\"", f64::is_finite);
                to.desired = Some(if is_searched { None } else { Some(number()?) });
            }
            "time_limit" => self.time_limit = Some(given.seconds()?),
            "method" => {
                to.method = given.word(&[
                    ("auto", MethodName::Auto),
                    ("multilevel", MethodName::Multilevel),
                    ("relaxed", MethodName::Relaxed),
                    ("paper", MethodName::Paper),
                ])?;
            }
            "omega" => to.omega = Some(given.number(OptionRange::OMEGA)?),
            "inner" => to.newton_steps = Some(given.count(1, Paper::MAX_NEWTON_STEPS)?),
            "derivatives" => {
                to.derivatives = Some(given.word(&[
                    ("analytic", Derivatives::Analytic),
                    ("finite-difference", Derivatives::FiniteDifference),
                ])?);
            }
            "edge_norm" => {
                to.doubles_exponent = Some(given.word(&[("fixed", false), ("continued", true)])?);
            }
            "guard" => {
                let guards = [Guard::ByMetric, Guard::Worst].map(|guard| (guard.name(), guard));
                to.guard = given.word(&guards)?;
            }
            "improve_worst" => to.improve_worst = worst_by(given)?,
            "max_move" => to.max_move = Some(given.number(OptionRange::MAX_MOVE)?),
            "keep_altitude" => to.keep_altitude = given.flag()?,
            "history" => to.track_all = given.word(&[("base", false), ("all", true)])?,
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
        let RunRequest { method, omega, newton_steps, derivatives, tolerance, .. } = &self.request;
        let is_auto_or = |own| [MethodName::Auto, own].contains(method);
        let has_paper = newton_steps.is_some() || derivatives.is_some();
        let has_goal = self.request.has_goal();
        let refusals = [
            (
                omega.is_some() && !is_auto_or(MethodName::Relaxed),
                "omega belongs to method=\"relaxed\". Drop it, or pass this method",
            ),
            (
                has_paper && !is_auto_or(MethodName::Paper),
                "inner and derivatives belong to method=\"paper\". Drop them, or pass this method",
            ),
            (
                has_paper && omega.is_some(),
                "omega does not go with inner and derivatives: each selects another method. Drop one of them",
            ),
            (
                has_goal && tolerance.is_some(),
                "tolerance does not go with fraction and desired: a run has one criterion to end. Drop one of them",
            ),
            (
                self.adapter.is_some() && self.engine == Some(EngineRequest::Cpu),
                "adapter does not go with engine=\"cpu\": it names a GPU. Drop one of them",
            ),
            (
                self.checkpoint_every.is_some() && self.checkpoint_file().is_none(),
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
        self.request.options(default, stored)
    }

    /// Returns the engine. The name of an adapter selects the GPU.
    pub(crate) fn engine(&self) -> EngineRequest {
        self.engine.clone().unwrap_or_default().with_adapter(self.adapter.clone())
    }

    /// Returns the time after which the run ends.
    pub(crate) fn time_limit(&self) -> Option<Duration> {
        self.time_limit
    }

    /// Returns the file of the run's checkpoints.
    pub(crate) fn checkpoint_file(&self) -> Option<CheckpointFile> {
        CheckpointFile::of(self.checkpoint.clone(), self.resume.clone(), self.checkpoint_every)
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
