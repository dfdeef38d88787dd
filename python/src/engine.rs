//! The engine of a run: the CPU, or a device that is opened once.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use gpu_smooth::front_ends::BackendChooser;
use gpu_smooth::options::Options;
use gpu_smooth::{Backend, Checkpoint, Gpu, GpuError, MeshSize};
use gpu_smooth_job::EngineRequest;
use pyo3::prelude::*;

use crate::error;
use crate::threads;

// A process that was forked after drivers were started uses neither of these, as another thread may have held the lock.
/// The device of runs that choose their engine; `None` before the first choice, and after a choice that an exception has
/// ended. The lock is held only by threads that are attached to Python.
static CHOOSER: Mutex<Option<Arc<BackendChooser>>> = Mutex::new(None);
/// Open devices of runs that name their engine, each with the requested text in the adapter's name.
static OPEN: Mutex<Vec<(Option<String>, Gpu)>> = Mutex::new(Vec::new());
/// Whether this process, or a parent before a fork, has started a driver of a GPU.
static HAS_STARTED: AtomicBool = AtomicBool::new(false);

/// Returns an error if a driver of a GPU cannot be used because the process was forked after the start of the driver.
pub(crate) fn check_fork(py: Python<'_>) -> PyResult<()> {
    match threads::is_forked() && HAS_STARTED.load(Ordering::Relaxed) {
        false => Ok(()),
        true => Err(error::device(
            py,
            "engine: the process was forked after a GPU was used, and drivers do not survive a fork. Start processes by \
             multiprocessing's \"spawn\" or \"forkserver\", or pass engine=\"cpu\"",
        )),
    }
}

/// Notes that drivers are started in this process.
pub(crate) fn start_drivers(py: Python<'_>) -> PyResult<()> {
    check_fork(py)?;
    HAS_STARTED.store(true, Ordering::Relaxed);
    Ok(())
}

/// Returns the engine of a run on a mesh of a given size.
pub(crate) fn open(
    py: Python<'_>,
    choice: &EngineRequest,
    size: MeshSize,
    options: &Options,
) -> PyResult<Backend> {
    match choice {
        EngineRequest::Cpu => Ok(Backend::Cpu),
        EngineRequest::Auto if check_fork(py).is_err() => Ok(Backend::Cpu),
        EngineRequest::Auto => {
            let lock = || CHOOSER.lock().unwrap_or_else(PoisonError::into_inner);
            let chooser = Arc::clone(lock().get_or_insert_default());
            let raised = Mutex::new(None);
            let choose = || chooser.choose(size, options, || try_drivers(&raised));
            let (backend, _) = threads::detached(py, choose)?;
            // The chooser keeps the failure of the trial that the exception has ended.
            ended(raised).inspect_err(|_| *lock() = None)?;
            Ok(backend)
        }
        EngineRequest::Gpu { adapter: name } => {
            start_drivers(py)?;
            let gpu = threads::detached(py, || opened(name.as_deref()))?;
            gpu.map(Backend::Gpu).map_err(|error| error::of_gpu(py, &error))
        }
    }
}

/// Returns the engine of a checkpoint's last sweep, or the CPU if that engine cannot be used.
pub(crate) fn of_checkpoint(py: Python<'_>, checkpoint: &Checkpoint) -> PyResult<Backend> {
    match checkpoint.adapter() {
        Some(name) if check_fork(py).is_ok() => {
            let raised = Mutex::new(None);
            let open = || try_drivers(&raised).and_then(|()| opened(Some(name)));
            let gpu = threads::detached(py, open)?;
            ended(raised)?;
            Ok(gpu.map_or(Backend::Cpu, Backend::Gpu))
        }
        _ => Ok(Backend::Cpu),
    }
}

/// Returns the device of an adapter, opened unless it is open. A lost device is replaced. Threads that wait here must be
/// detached from Python.
fn opened(name: Option<&str>) -> Result<Gpu, GpuError> {
    let mut open = OPEN.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(at) = open.iter().position(|(own, _)| own.as_deref() == name) {
        if !open[at].1.is_lost() {
            return Ok(open[at].1.clone());
        }
        open.swap_remove(at).1.discard();
    }
    let gpu = Gpu::open(name).block()?;
    open.push((name.map(str::to_owned), gpu.clone()));
    Ok(gpu)
}

/// Returns the exception that has ended a trial of drivers.
fn ended(raised: Mutex<Option<PyErr>>) -> PyResult<()> {
    raised.into_inner().unwrap_or_else(PoisonError::into_inner).map_or(Ok(()), Err)
}

/// Tries the drivers of all GPUs in another process, as a driver that crashes would end this one. An exception that ends
/// the trial, such as `KeyboardInterrupt`, is stored in `raised`.
fn try_drivers(raised: &Mutex<Option<PyErr>>) -> Result<(), GpuError> {
    HAS_STARTED.store(true, Ordering::Relaxed);
    let tried = Python::attach(|py| {
        let tried = py.import("gpu_smooth._drivers")?.call_method0("trial")?;
        tried.extract::<Option<String>>()
    });
    match tried {
        Ok(failure) => failure.map_or(Ok(()), |failure| Err(GpuError::Crashed(failure))),
        Err(error) => {
            let failure = error.to_string();
            *raised.lock().unwrap_or_else(PoisonError::into_inner) = Some(error);
            Err(GpuError::Crashed(failure))
        }
    }
}
