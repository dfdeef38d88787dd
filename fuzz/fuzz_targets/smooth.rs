//! Smooths a mesh made from arbitrary bytes, with the checks of `fuzz/checks.rs`.
#![no_main]

#[path = "../checks.rs"]
#[allow(dead_code)]
mod checks;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    checks::any_mesh(bytes, &gpu_smooth::Backend::Cpu);
});
