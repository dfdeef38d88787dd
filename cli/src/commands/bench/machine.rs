//! The machine and the version, on which measurements depend.

use gpu_smooth::Gpu;
/// An engine to measure. `copy_rate` is the bytes per second that the engine reads and writes in a
/// pure copy.
pub(super) struct Place {
    pub(super) gpu: Option<Gpu>,
    pub(super) name: String,
    pub(super) copy_rate: f64,
}

/// Returns the name of the processor, or the architecture if the system does not reveal the name.
fn processor() -> String {
    let of_linux = || {
        let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
        let line = text.lines().find(|line| line.starts_with("model name"))?;
        Some(line.split_once(':')?.1.trim().to_owned())
    };
    let of_windows = || std::env::var("PROCESSOR_IDENTIFIER").ok();
    of_linux().or_else(of_windows).unwrap_or_else(|| std::env::consts::ARCH.to_owned())
}

/// Returns processor, threads and system in one line.
pub(super) fn machine() -> String {
    let (threads, system) = (rayon::current_num_threads(), std::env::consts::OS);
    format!("{}, {threads} threads, {system} {}", processor(), std::env::consts::ARCH)
}

/// Returns the name and version of the program. Builds with debug assertions are marked as not
/// optimized.
pub(super) fn version() -> String {
    let slow = if cfg!(debug_assertions) { ", not optimized: measure with --release" } else { "" };
    format!("gpu-smooth {}{slow}", env!("CARGO_PKG_VERSION"))
}
