//! The signal that has requested the end of a run.

use std::sync::atomic::{AtomicI32, Ordering};

/// Number of the signal; 0 without a request.
static REQUESTED: AtomicI32 = AtomicI32::new(0);

/// Requests the end of the run. Returns false if a signal has done so before.
pub(super) fn request(signal: i32) -> bool {
    REQUESTED.compare_exchange(0, signal, Ordering::SeqCst, Ordering::SeqCst).is_ok()
}

/// Returns whether a signal has requested the end of the run.
pub(crate) fn is_requested() -> bool {
    REQUESTED.load(Ordering::SeqCst) != 0
}

/// Returns the exit code of a successful command: 0, or that of the signal that interrupted the run.
pub(crate) fn exit_code() -> u8 {
    match REQUESTED.load(Ordering::SeqCst) {
        0 => 0,
        signal => exit_status(signal),
    }
}

/// Returns the exit status with which shells report a signal: 130 for SIGINT, 143 for SIGTERM, 129 for SIGHUP.
pub(super) fn exit_status(signal: i32) -> u8 {
    128 + signal as u8
}
