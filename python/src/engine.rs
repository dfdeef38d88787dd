//! The engine of a run: the CPU, or a device that is opened once.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

use gpu_smooth::choice::BackendChooser;
use gpu_smooth::options::Options;
use gpu_smooth::{Backend, Checkpoint, Gpu, GpuError, MeshSize};
use pyo3::prelude::*;

use crate::error;
use crate::run_options::EngineChoice;
use crate::threads;

// A process that was forked after drivers were started uses neither of these, as another thread may have held the lock.
/// The device of runs that choose their engine.
static CHOOSER: BackendChooser = BackendChooser::new();
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
    choice: &EngineChoice,
    size: MeshSize,
    options: &Options,
) -> PyResult<Backend> {
    match choice {
        EngineChoice::Cpu => Ok(Backend::Cpu),
        EngineChoice::Auto if check_fork(py).is_err() => Ok(Backend::Cpu),
        EngineChoice::Auto => {
            let choose = || CHOOSER.choose(size, options, try_drivers);
            threads::detached(py, choose).map(|(backend, _)| backend)
        }
        EngineChoice::Gpu(name) => {
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
            let gpu = threads::detached(py, || try_drivers().and_then(|()| opened(Some(name))))?;
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
    let gpu = Gpu::open(name)?;
    open.push((name.map(str::to_owned), gpu.clone()));
    Ok(gpu)
}

/// Tries the drivers of all GPUs in another process, as a driver that crashes would end this one.
fn try_drivers() -> Result<(), GpuError> {
    HAS_STARTED.store(true, Ordering::Relaxed);
    Python::attach(|py| {
        let tried = py.import("gpu_smooth._drivers")?.call_method0("trial")?;
        tried.extract::<Option<String>>()
    })
    .unwrap_or_else(|error| Some(error.to_string()))
    .map_or(Ok(()), |failure| Err(GpuError::Crashed(failure)))
}
