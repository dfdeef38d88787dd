//! Signals that request the end of a run: SIGINT (Ctrl-C), SIGTERM, and SIGHUP of a closed terminal.
//!
//! Before a smoothed state exists, a signal ends the process at once. Afterwards, the first signal ends the run at the
//! next sweep, and the best mesh so far is written; a second signal ends the process at once. No signal leaves a
//! half-written file.

#[cfg(unix)]
use std::io::IsTerminal;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

#[cfg(unix)]
use signal_hook::consts::SIGHUP;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::{flag, low_level};

pub(crate) use crate::terminal::requested::{exit_code, is_requested};
use crate::terminal::{progress, requested, tell};

/// Interval at which the thread polls for signals. A blocking wait would need different code on each system.
const INTERVAL: Duration = Duration::from_millis(20);

/// Whether a smoothed state exists that can be written.
static HAS_RESULT: AtomicBool = AtomicBool::new(false);

/// Turns a write beyond the user's limit on file sizes (`ulimit -f`) into an error, like that of a full disk. Without a
/// handler, SIGXFSZ would end the process and leave a temporary file.
pub(crate) fn survive_large_files() {
    #[cfg(unix)]
    {
        // If registration fails, a write beyond the limit ends the process.
        let _ = flag::register(signal_hook::consts::SIGXFSZ, Arc::default());
    }
}

/// Starts to handle signals. If the system refuses a handler, the signal ends the process at once.
pub(crate) fn watch(quiet: bool) {
    let register = |signal| {
        let arrived = Arc::new(AtomicBool::new(false));
        flag::register(signal, Arc::clone(&arrived)).ok().map(|_| (signal, arrived))
    };
    let signals: Vec<_> = signals().into_iter().filter_map(register).collect();
    let wait = move || loop {
        std::thread::sleep(INTERVAL);
        for (signal, arrived) in &signals {
            if arrived.swap(false, Ordering::SeqCst) {
                received(*signal, quiet);
            }
        }
    };
    let _ = std::thread::Builder::new().name("signals".into()).spawn(wait);
}

/// Returns the signals that request the end of a run. SIGHUP is omitted if the process was started to outlive its
/// terminal, as by nohup.
fn signals() -> Vec<i32> {
    #[cfg(unix)]
    if !ignores_hangup() {
        return vec![SIGINT, SIGTERM, SIGHUP];
    }
    vec![SIGINT, SIGTERM]
}

/// Returns whether the process was started with SIGHUP ignored. On systems without `/proc`, a standard output that is
/// no terminal indicates nohup.
#[cfg(unix)]
fn ignores_hangup() -> bool {
    let ignored = std::fs::read_to_string("/proc/self/status").ok().and_then(|status| {
        let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"))?;
        u64::from_str_radix(mask.trim(), 16).ok()
    });
    match ignored {
        Some(mask) => mask & (1 << (SIGHUP - 1)) != 0,
        None => !std::io::stdout().is_terminal(),
    }
}

/// Handles a signal. The first signal requests the end of the run if a result exists; other signals end the process.
fn received(signal: i32, quiet: bool) {
    let has_result = HAS_RESULT.load(Ordering::SeqCst);
    if has_result && requested::request(signal) {
        return;
    }
    let blocked = mesh_io::atomic::discard_pending_writes();
    progress::remove_bar();
    let text = match (has_result, blocked.has_written()) {
        (true, _) => "interrupted again: ended at once",
        (false, true) => "interrupted after a file was written",
        (false, false) => "interrupted: nothing was written",
    };
    tell::note(quiet, text);
    // `std::process::exit` would run clean-up code of GPU drivers whose threads are still active.
    low_level::exit(requested::exit_status(signal).into());
}

/// From now on the first signal only sets what `is_requested` returns, so that the run can write its result. Before, a
/// signal ends the process.
pub(crate) fn has_result() {
    HAS_RESULT.store(true, Ordering::SeqCst);
}
