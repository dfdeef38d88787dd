//! Tries the drivers of GPUs in a process of its own. A driver that crashes ends that process, not this one.

use std::collections::BTreeMap;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use gpu_smooth::GpuError;

/// How long drivers may take to start and answer. Slow ones have taken five seconds to compile their first kernel.
const PATIENCE: Duration = Duration::from_secs(60);
/// How often the process is checked for its end.
const INTERVAL: Duration = Duration::from_millis(5);

/// Environment variable that marks a trial process, which must not start another one.
const MARK: &str = "GPU_SMOOTH_IS_TRIAL";

/// The drivers that are tried.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Tried<'a> {
    /// The drivers of all adapters.
    All,
    /// The driver of the adapter that [`gpu_smooth::Gpu::open`] takes for this name.
    Adapter(Option<&'a str>),
}

/// Tries whether the driver of an adapter, or of all adapters, starts, opens the adapter and computes. Each driver is
/// tried once.
///
/// # Errors
/// [`GpuError::Crashed`] if the driver ended the process, or did not answer.
pub(crate) fn drivers(tried: Tried<'_>) -> Result<(), GpuError> {
    static KNOWN: Mutex<BTreeMap<Option<String>, Result<(), GpuError>>> =
        Mutex::new(BTreeMap::new());
    if std::env::var_os(MARK).is_some() {
        return Ok(());
    }
    let name = match tried {
        Tried::All => None,
        // Every name contains the empty text, so this stands for the first adapter.
        Tried::Adapter(name) => Some(name.unwrap_or_default().to_owned()),
    };
    let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    let found = known
        .entry(name)
        .or_insert_with_key(|name| outcome(name.as_deref()).map_err(GpuError::Crashed));
    found.clone()
}

fn outcome(name: Option<&str>) -> Result<(), String> {
    let Ok(program) = std::env::current_exe() else { return Ok(()) };
    let mut command = Command::new(program);
    command.arg("adapters").args(name.map(|name| ["--", name]).into_iter().flatten());
    command.env(MARK, "1").stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    // If no second process can be started, the driver counts as working.
    let Ok(mut child) = command.spawn() else { return Ok(()) };
    match ended(&mut child) {
        // 0: the adapters were listed. 1: an error that will be reported when a device is opened here.
        Some(status) if matches!(status.code(), Some(0 | 1)) => Ok(()),
        Some(status) => Err(status.to_string()),
        None => {
            let _ = child.kill();
            let _ = child.wait();
            Err(format!("no answer within {} s", PATIENCE.as_secs()))
        }
    }
}

/// Waits for the process to end. `None` if it does not end in time.
fn ended(child: &mut Child) -> Option<ExitStatus> {
    let start = Instant::now();
    while start.elapsed() < PATIENCE {
        match child.try_wait() {
            Ok(Some(status)) => return Some(status),
            Ok(None) => std::thread::sleep(INTERVAL),
            Err(_) => return None,
        }
    }
    None
}
