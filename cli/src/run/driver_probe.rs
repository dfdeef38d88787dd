//! Trial of GPU drivers in a child process, which isolates this process from a driver's crash.
//!
//! A driver that has started well is trusted for a day: an empty file in the directory of the user's session stands for
//! the trial. A process removes the file before it starts the driver, and makes the file again afterwards. So after a
//! process that the driver ended, the next process tries the driver again.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::PathBuf;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use gpu_smooth::GpuError;

use crate::terminal::process;

/// Time limit for drivers to start and answer. Slow drivers have needed five seconds to compile their first kernel.
const PATIENCE: Duration = Duration::from_secs(60);
/// Interval between two checks whether the child process has ended.
const INTERVAL: Duration = Duration::from_millis(5);
/// Time for which a driver that has started is trusted to start again.
const TRUST: Duration = Duration::from_secs(24 * 60 * 60);
/// First characters of environment variables that decide which driver starts, and how.
const OF_DRIVERS: [&str; 9] =
    ["VK_", "WGPU_", "MESA_", "LIBGL_", "DRI_", "CUDA_", "NVIDIA_", "LD_", "__"];

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

/// A driver that is about to start in this process. To be dropped once the driver has started, or has returned an error.
#[must_use]
pub(crate) struct Starting(Option<PathBuf>);

impl Drop for Starting {
    fn drop(&mut self) {
        if let Some(file) = self.0.take().filter(|_| !std::thread::panicking()) {
            // Without the file, the next process tries the driver again.
            let _ = File::create_new(file);
        }
    }
}

/// Tests whether a driver starts, opens its adapter and computes, for one adapter or all adapters. Results are cached
/// for the life of the process. The caller keeps the result until the driver has started.
///
/// # Errors
/// Returns [`GpuError::Crashed`] if a driver ended the child process, or did not answer in time.
pub(crate) fn drivers(tried: Trial<'_>) -> Result<Starting, GpuError> {
    static KNOWN: Mutex<BTreeMap<Option<String>, Result<(), GpuError>>> =
        Mutex::new(BTreeMap::new());
    let mut starting = Starting(None);
    if std::env::var_os(MARK).is_some() {
        return Ok(starting);
    }
    let name = match tried {
        Trial::All => None,
        // An empty name matches every adapter, so it denotes the first one.
        Trial::Adapter(name) => Some(name.unwrap_or_default().to_owned()),
    };
    let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    let found = known.entry(name).or_insert_with_key(|name| {
        let file = name.as_deref().map(file_of);
        // A file that cannot be removed would outlast a crash.
        let is_trusted = file.as_deref().is_some_and(|file| {
            let modified = fs::metadata(file).and_then(|about| about.modified());
            let is_young = modified.is_ok_and(|at| at.elapsed().is_ok_and(|age| age < TRUST));
            fs::remove_file(file).is_ok() && is_young
        });
        let outcome = if is_trusted { Ok(()) } else { outcome(name.as_deref()) };
        starting.0 = file.filter(|_| outcome.is_ok());
        outcome.map_err(GpuError::Crashed)
    });
    found.clone().map(|()| starting)
}

/// Returns the file that stands for a successful trial of an adapter, by a name as in [`Trial::Adapter`].
fn file_of(name: &str) -> PathBuf {
    let mut hasher = DefaultHasher::new();
    (name, env!("CARGO_PKG_VERSION"), process::program()).hash(&mut hasher);
    let mut variables: Vec<_> = std::env::vars_os()
        .filter(|(key, _)| {
            let key = key.to_string_lossy();
            OF_DRIVERS.iter().any(|first| key.starts_with(first))
        })
        .collect();
    variables.sort();
    variables.hash(&mut hasher);
    let session = std::env::var_os("XDG_RUNTIME_DIR").map(PathBuf::from);
    let directory = session.filter(|path| path.is_dir()).unwrap_or_else(std::env::temp_dir);
    directory.join(format!("gpu-smooth-driver-{:016x}", hasher.finish()))
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
