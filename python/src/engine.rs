//! The engine of a run: the CPU, or a device that is opened once.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use gpu_smooth::options::Options;
use gpu_smooth::{Backend, Gpu, GpuError, MeshSize};
use pyo3::prelude::*;

use crate::error;
use crate::run_options::EngineChoice;
use crate::threads;

/// Open devices, each with the requested text in the adapter's name. Locked only by threads that hold Python's lock.
static OPEN: Mutex<Vec<(Option<String>, Arc<Backend>)>> = Mutex::new(Vec::new());
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
) -> PyResult<Arc<Backend>> {
    match choice {
        EngineChoice::Cpu => Ok(Arc::new(Backend::Cpu)),
        EngineChoice::Auto if check_fork(py).is_err() => Ok(Arc::new(Backend::Cpu)),
        EngineChoice::Auto => {
            let (backend, _) =
                threads::detached(py, || Backend::auto_tried(size, options, try_drivers))?;
            Ok(Arc::new(backend))
        }
        EngineChoice::Gpu(name) => {
            start_drivers(py)?;
            opened(py, name.as_deref())
        }
    }
}

/// Opens the device of an adapter, or returns the device if it is open.
fn opened(py: Python<'_>, name: Option<&str>) -> PyResult<Arc<Backend>> {
    let of_name = |open: &[(Option<String>, Arc<Backend>)]| {
        let found = open.iter().find(|(own, _)| own.as_deref() == name);
        found.map(|(_, backend)| Arc::clone(backend))
    };
    let locked = || OPEN.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(backend) = of_name(&locked()) {
        return Ok(backend);
    }
    let gpu = threads::detached(py, || Gpu::open(name))?;
    let gpu = gpu.map_err(|error| error::of_gpu(py, &error))?;
    let mut open = locked();
    // Another thread may have opened the device meanwhile.
    if let Some(backend) = of_name(&open) {
        return Ok(backend);
    }
    let backend = Arc::new(Backend::Gpu(gpu));
    open.push((name.map(str::to_owned), Arc::clone(&backend)));
    Ok(backend)
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
