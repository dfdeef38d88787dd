//! Panics of wgpu, which reports some failures of drivers by panics. The library converts panics of wgpu to errors,
//! so nothing is printed for them. If a panic escapes the library, for example while a device is dropped, the
//! process ends with an error message.

use std::cell::Cell;
use std::panic::{self, AssertUnwindSafe};

use crate::error::CliError;
use crate::terminal::tell;

thread_local! {
    /// Whether the latest panic of this thread came from wgpu.
    static OF_WGPU: Cell<bool> = const { Cell::new(false) };
}

/// Runs `work`, the whole process, and reports an uncaught panic of wgpu as an error.
pub(crate) fn reporting_panics(work: impl FnOnce() -> u8) -> u8 {
    let usual = panic::take_hook();
    panic::set_hook(Box::new(move |panic| {
        let of_wgpu = panic.location().is_some_and(|place| is_of_wgpu(place.file()));
        OF_WGPU.set(of_wgpu);
        if !of_wgpu {
            usual(panic);
        }
    }));
    match panic::catch_unwind(AssertUnwindSafe(work)) {
        Ok(code) => code,
        Err(_) if OF_WGPU.get() => {
            let error = CliError::device("the driver of the GPU failed");
            let code = error.kind.exit_code();
            tell::error(&error.with_remedy("Use --engine cpu, or another driver"));
            code
        }
        Err(payload) => panic::resume_unwind(payload),
    }
}

/// Returns whether a source file belongs to a crate of wgpu (wgpu, wgpu-core, wgpu-hal).
fn is_of_wgpu(file: &str) -> bool {
    file.split(['/', '\\']).any(|folder| folder.starts_with("wgpu"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_wgpu_are_distinguished_from_others() {
        assert!(is_of_wgpu("/home/a/registry/src/b/wgpu-hal-30.0.1/src/vulkan/descriptor.rs"));
        assert!(is_of_wgpu(r"C:\registry\wgpu-30.0.1\src\lib.rs"));
        assert!(!is_of_wgpu("src/gpu/device/open.rs"));
        assert!(!is_of_wgpu("/home/a/my-wgpu/src/main.rs"));
    }
}
