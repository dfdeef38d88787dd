//! Tries the drivers of GPUs in a process of its own, which one that crashes ends instead of this one.

use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::OnceLock;
use std::time::{Duration, Instant};

use gpu_smooth::GpuError;

/// How long drivers may take to start and to answer. Slow ones were seen to take five seconds, to compile their first kernel.
const PATIENCE: Duration = Duration::from_secs(60);
/// How often the process is looked at.
const INTERVAL: Duration = Duration::from_millis(5);

/// Whether all drivers of this machine start, open their adapters and compute, as `gpu-smooth adapters` makes them do. Found out once.
///
/// # Errors
/// [`GpuError::Crashed`] if they ended the process, or did not answer.
pub(crate) fn drivers() -> Result<(), GpuError> {
    static TRIED: OnceLock<Result<(), GpuError>> = OnceLock::new();
    TRIED.get_or_init(|| tried().map_err(GpuError::Crashed)).clone()
}

fn tried() -> Result<(), String> {
    let Ok(program) = std::env::current_exe() else { return Ok(()) };
    let mut command = Command::new(program);
    command.arg("adapters").stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    // Where there can be no second process, nothing is known.
    let Ok(mut child) = command.spawn() else { return Ok(()) };
    match ended(&mut child) {
        // 0: they were listed. 1: an error that will be told when a device is opened here.
        Some(status) if matches!(status.code(), Some(0 | 1)) => Ok(()),
        Some(status) => Err(status.to_string()),
        None => {
            let _ = child.kill();
            let _ = child.wait();
            Err(format!("no answer within {} s", PATIENCE.as_secs()))
        }
    }
}

/// How the process ended; `None` if it has not after a while.
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
