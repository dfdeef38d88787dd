//! Reads any bytes as a mesh file; `fuzz/checks.rs` says what must hold.
#![no_main]

#[path = "../checks.rs"]
#[allow(dead_code)]
mod checks;

use std::sync::LazyLock;
use tempfile::TempDir;

static FOLDER: LazyLock<TempDir> = LazyLock::new(|| TempDir::new().unwrap());

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    checks::any_file(bytes);
    if bytes.starts_with(b"\x89HDF") {
        checks::any_file_beside(FOLDER.path(), bytes);
    }
});
