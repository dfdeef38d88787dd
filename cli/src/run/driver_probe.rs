//! Trial of GPU drivers in a child process, which isolates this process from a driver's crash.

use std::collections::BTreeMap;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use gpu_smooth::GpuError;

use crate::terminal::process;

/// Time limit for drivers to start and answer. Slow drivers have needed five seconds to compile their first kernel.
const PATIENCE: Duration = Duration::from_secs(60);
/// Interval between two checks whether the child process has ended.
const INTERVAL: Duration = Duration::from_millis(5);

/// Environment variable that marks a child process. A marked process must not start another trial.
const MARK: &str = "GPU_SMOOTH_IS_TRIAL";

/// The drivers of a trial.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Trial<'a> {
    /// The drivers of all adapters.
    All,
    /// The driver of the adapter that [`gpu_smooth::Gpu::open`] opens for this name.
    Adapter(Option<&'a str>),
}

/// Tests whether a driver starts, opens its adapter and computes, for one adapter or all adapters. Results are cached
/// for the life of the process.
///
/// # Errors
/// Returns [`GpuError::Crashed`] if a driver ended the child process, or did not answer in time.
pub(crate) fn drivers(tried: Trial<'_>) -> Result<(), GpuError> {
    static KNOWN: Mutex<BTreeMap<Option<String>, Result<(), GpuError>>> =
        Mutex::new(BTreeMap::new());
    if std::env::var_os(MARK).is_some() {
        return Ok(());
    }
    let name = match tried {
        Trial::All => None,
        // An empty name matches every adapter, so it denotes the first one.
        Trial::Adapter(name) => Some(name.unwrap_or_default().to_owned()),
    };
    let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    let found = known
        .entry(name)
        .or_insert_with_key(|name| outcome(name.as_deref()).map_err(GpuError::Crashed));
    found.clone()
}

fn outcome(name: Option<&str>) -> Result<(), String> {
    let words = process::program();
    let [program, first @ ..] = &words[..] else { return Ok(()) };
    let mut command = Command::new(program);
    command.args(first);
    command.arg("adapters").args(name.map(|name| ["--", name]).into_iter().flatten());
    command.env(MARK, "1").stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    // If no child process can be started, the driver is assumed to work.
    let Ok(mut child) = command.spawn() else { return Ok(()) };
    match ended(&mut child) {
        // Code 0: the adapters were listed. Codes of errors: this process will report the error when it opens a device.
        Some(status) if matches!(status.code(), Some(0..=5)) => Ok(()),
        Some(status) => Err(status.to_string()),
        None => {
            let _ = child.kill();
            let _ = child.wait();
            Err(format!("no answer within {} s", PATIENCE.as_secs()))
        }
    }
}

/// Waits for a process to end; `None` if it exceeds the time limit.
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
