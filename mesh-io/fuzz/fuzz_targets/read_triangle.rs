//! Reads any bytes as the files of a Triangle mesh; `fuzz/checks.rs` says what must hold.
#![no_main]

#[path = "../checks.rs"]
#[allow(dead_code)]
mod checks;

use std::sync::LazyLock;
use tempfile::TempDir;

static FOLDER: LazyLock<TempDir> = LazyLock::new(|| TempDir::new().unwrap());

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| checks::any_triangle_files(FOLDER.path(), bytes));
