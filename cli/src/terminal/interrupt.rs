//! The signals that ask a run to end: SIGINT (Ctrl-C), SIGTERM, and SIGHUP of a closed terminal.
//!
//! Before there is a smoothed state, a signal ends the process at once. After that, the first signal ends the run at the
//! next sweep, and the best mesh so far is written; a second one ends the process at once. No half-written file is left.

#[cfg(unix)]
use std::io::IsTerminal;
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, AtomicI32, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

#[cfg(unix)]
use signal_hook::consts::SIGHUP;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::{flag, low_level};

use crate::terminal::tell;

/// How often signals are looked for. A thread that waits for signals would need different code on each system.
const INTERVAL: Duration = Duration::from_millis(20);

/// Whether there is a smoothed state to write.
static HAS_RESULT: AtomicBool = AtomicBool::new(false);
/// The signal that asked the run to end, or 0.
static REQUESTED: AtomicI32 = AtomicI32::new(0);
/// Held while a file other than the mesh is written.
static WRITING: Mutex<()> = Mutex::new(());

/// Makes a write beyond the user's limit on file sizes (`ulimit -f`) an error, like that of a full disk. Otherwise it
/// would end the process at once and leave a temporary file.
pub(crate) fn survive_large_files() {
    #[cfg(unix)]
    {
        // If the system does not allow that, such a write ends the process as usual.
        let _ = flag::register(signal_hook::consts::SIGXFSZ, Arc::default());
    }
}

/// Handles the signals from now on. If the system does not allow that, they end the process as usual.
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

/// Lists the signals that ask a run to end. SIGHUP is none of them if the process was started to outlive its terminal, as by nohup.
fn signals() -> Vec<i32> {
    #[cfg(unix)]
    if !ignores_hangup() {
        return vec![SIGINT, SIGTERM, SIGHUP];
    }
    vec![SIGINT, SIGTERM]
}

/// Whether the process was started with SIGHUP ignored. Where the system does not tell it, it was if the standard output is no
/// terminal, as nohup leaves none.
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

/// Handles a signal: the first one asks the run to end if there is a result. Otherwise the process ends.
fn received(signal: i32, quiet: bool) {
    let has_result = HAS_RESULT.load(Ordering::SeqCst);
    let set = |from| REQUESTED.compare_exchange(from, signal, Ordering::SeqCst, Ordering::SeqCst);
    if has_result && set(0).is_ok() {
        return;
    }
    let _mesh = mesh_io::atomic::discard_pending_writes();
    let _other = uninterrupted();
    tell::leave_bar();
    let text = if has_result {
        "interrupted again: ended at once"
    } else {
        "interrupted: nothing was written"
    };
    tell::note(quiet, text);
    // `std::process::exit` would let a driver clean up while its threads still run.
    low_level::exit(exit_status(signal).into());
}

/// Leaves the first signal to the run from now on, as there is a result.
pub(crate) fn has_result() {
    HAS_RESULT.store(true, Ordering::SeqCst);
}

/// Whether a signal has asked the run to end.
pub(crate) fn is_requested() -> bool {
    REQUESTED.load(Ordering::SeqCst) != 0
}

/// Keeps signals from ending the process as long as the returned guard lives.
pub(crate) fn uninterrupted() -> MutexGuard<'static, ()> {
    WRITING.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Returns the exit code of a command that succeeded: 0 unless it was interrupted.
pub(crate) fn exit_code() -> ExitCode {
    match REQUESTED.load(Ordering::SeqCst) {
        0 => ExitCode::SUCCESS,
        signal => exit_status(signal).into(),
    }
}

/// Returns the exit status by which shells tell the end by a signal: 130, 143 or 129.
fn exit_status(signal: i32) -> u8 {
    128 + signal as u8
}
