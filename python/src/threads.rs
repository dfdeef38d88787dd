//! The threads of the library, and work without Python's global lock.

use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex, PoisonError, mpsc};
use std::time::Duration;

use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::error;
use crate::observer::RunObserver;

/// The process that first computed, and whose threads rayon's global pool has; 0 before the first computation.
static OWNER: AtomicU32 = AtomicU32::new(0);

/// The thread pool of a forked process, and the identifier of the process. A thread that holds this lock is attached to
/// Python and calls nothing of Python. A fork waits for such threads, also without Python's global lock, so that no other
/// thread holds this lock when a process is forked.
static OF_FORK: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// Returns whether this process was forked from a process that had computed.
pub(crate) fn is_forked() -> bool {
    let own = std::process::id();
    match OWNER.compare_exchange(0, own, Ordering::Relaxed, Ordering::Relaxed) {
        Ok(_) => false,
        Err(owner) => owner != own,
    }
}

/// Returns the threads of a forked process; `None` if the process can use rayon's global pool. A fork does not copy
/// threads, so that a computation in the global pool of the parent would wait for ever.
pub(crate) fn of_fork(py: Python<'_>) -> PyResult<Option<Arc<ThreadPool>>> {
    if !is_forked() {
        return Ok(None);
    }
    let own = std::process::id();
    let built = {
        let mut kept = OF_FORK.lock().unwrap_or_else(PoisonError::into_inner);
        match &*kept {
            Some((process, pool)) if *process == own => Ok(Arc::clone(pool)),
            _ => ThreadPoolBuilder::new().build().map(|pool| {
                let pool = Arc::new(pool);
                // The pool of the parent has no threads here. Dropping it would wait for their locks.
                std::mem::forget(kept.replace((own, Arc::clone(&pool))));
                pool
            }),
        }
    };
    built.map(Some).map_err(|refused| {
        error::device(py, &format!("no threads can be started in the forked process: {refused}"))
    })
}

/// Runs `work` without Python's lock, so that other threads of Python go on.
pub(crate) fn detached<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    let pool = of_fork(py)?;
    Ok(py.detach(|| match pool {
        None => work(),
        Some(pool) => pool.install(work),
    }))
}

/// Runs `work` without Python's lock, and ends it by `observer` if a signal arrives.
///
/// Python runs its handlers of signals on the main thread alone. In a forked process the sweeps are on another thread,
/// so that the calling thread waits for signals meanwhile.
pub(crate) fn watched<T: Send>(
    py: Python<'_>,
    observer: &RunObserver<'_>,
    work: impl FnOnce() -> T + Send,
) -> PyResult<T> {
    const INTERVAL: Duration = Duration::from_millis(50);
    let Some(pool) = of_fork(py)? else { return Ok(py.detach(work)) };
    let watch = || {
        let (sender, receiver) = mpsc::channel();
        std::thread::scope(|scope| {
            scope.spawn(move || sender.send(pool.install(work)));
            loop {
                match receiver.recv_timeout(INTERVAL) {
                    Ok(done) => return Some(done),
                    Err(mpsc::RecvTimeoutError::Disconnected) => return None,
                    Err(mpsc::RecvTimeoutError::Timeout) => Python::attach(|py| {
                        if let Err(raised) = py.check_signals() {
                            observer.cancel(raised);
                        }
                    }),
                }
            }
        })
    };
    py.detach(watch).ok_or_else(|| error::device(py, "a thread of the run has ended"))
}
