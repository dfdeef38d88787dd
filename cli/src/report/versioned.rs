//! The version of the keys of reports.

use serde::Serialize;

use crate::error::CliError;

/// The version of the keys of reports. A change of the meaning of a key, or its removal, raises the version. A new key
/// does not. docs/report.md describes the keys.
const SCHEMA_VERSION: u32 = 3;

/// A report with the version of its keys and the program that wrote the report.
#[derive(Serialize)]
struct Versioned<R> {
    schema_version: u32,
    program: &'static str,
    #[serde(flatten)]
    report: R,
}

/// Returns a report as JSON, with the version of its keys, ending in a line break.
pub(crate) fn versioned_json(report: impl Serialize) -> Result<String, CliError> {
    let program = concat!("gpu-smooth ", env!("CARGO_PKG_VERSION"));
    let report = Versioned { schema_version: SCHEMA_VERSION, program, report };
    Ok(serde_json::to_string_pretty(&report)? + "\n")
}
