//! Smooths a mesh made from any bytes; `fuzz/checks.rs` says what must hold.
#![no_main]

#[path = "../checks.rs"]
#[allow(dead_code)]
mod checks;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    checks::any_mesh(bytes, &gpu_smooth::Backend::Cpu);
});
