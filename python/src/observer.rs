//! Signals, the time limit and the user's function, which may end a run between two sweeps.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use gpu_smooth::{Phase, Progress};
use pyo3::prelude::*;

use crate::error;
use crate::run_options::RunOptions;

/// The observer of a run. A run ends if a signal arrives, if the time limit has passed, or if the function of the user
/// returns a true value or raises an exception.
pub(crate) struct RunObserver<'a> {
    on_sweep: Option<&'a Py<PyAny>>,
    end: Option<Instant>,
    /// The exception that a signal or the user's function raised.
    raised: Mutex<Option<PyErr>>,
    is_canceled: AtomicBool,
}

impl<'a> RunObserver<'a> {
    /// Makes the observer of a run that begins now.
    pub(crate) fn new(options: &'a RunOptions) -> Self {
        let end = options.settings().time_limit.and_then(|limit| Instant::now().checked_add(limit));
        Self {
            on_sweep: options.on_sweep(),
            end,
            raised: Mutex::new(None),
            is_canceled: AtomicBool::new(false),
        }
    }

    /// Ends the run with an exception.
    pub(crate) fn cancel(&self, raised: PyErr) {
        let mut kept = self.raised.lock().unwrap_or_else(PoisonError::into_inner);
        let later = if kept.is_none() { kept.replace(raised) } else { Some(raised) };
        // Python code may run when an exception is dropped, so that the lock is released before.
        drop(kept);
        drop(later);
        self.is_canceled.store(true, Ordering::Relaxed);
    }

    /// Issues a `MeshWarning`. A filter of warnings may make the warning an exception, which ends the run.
    pub(crate) fn warn(&self, text: &str) {
        if let Err(raised) = Python::attach(|py| error::warn(py, text)) {
            self.cancel(raised);
        }
    }

    /// Returns the exception that ended the run, if there is one.
    pub(crate) fn take_raised(&self) -> Option<PyErr> {
        self.raised.lock().unwrap_or_else(PoisonError::into_inner).take()
    }

    /// Tells whether a run goes on. Called between sweeps.
    pub(crate) fn sweep(&self, progress: &Progress) -> ControlFlow<()> {
        let phase = match progress.phase {
            Phase::Reference => "reference",
            Phase::Improving => "improving",
            _ => "smoothing",
        };
        self.step(phase, progress.sweep, progress.f)
    }

    /// Tells whether work goes on. `phase`, `sweep` and `value` are what the function of the user receives.
    pub(crate) fn step(&self, phase: &str, sweep: u32, value: f64) -> ControlFlow<()> {
        let is_over = self.end.is_some_and(|end| Instant::now() >= end);
        if is_over || self.is_canceled.load(Ordering::Relaxed) {
            return ControlFlow::Break(());
        }
        Python::attach(|py| match self.ask(py, phase, sweep, value) {
            Ok(false) => ControlFlow::Continue(()),
            Ok(true) => ControlFlow::Break(()),
            Err(raised) => {
                self.cancel(raised);
                ControlFlow::Break(())
            }
        })
    }

    /// Returns whether the function of the user ends the run.
    fn ask(&self, py: Python<'_>, phase: &str, sweep: u32, value: f64) -> PyResult<bool> {
        py.check_signals()?;
        let Some(on_sweep) = self.on_sweep else { return Ok(false) };
        let progress = py.import("gpu_smooth._progress")?.getattr("Progress")?;
        match on_sweep.bind(py).call1((progress.call1((phase, sweep, value))?,)) {
            Ok(answer) => answer.is_truthy(),
            Err(raised) if raised.is_instance_of::<pyo3::exceptions::PyStopIteration>(py) => {
                Ok(true)
            }
            Err(raised) => Err(raised),
        }
    }
}
