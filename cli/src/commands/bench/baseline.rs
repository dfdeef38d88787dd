//! Earlier measurements, with which new measurements are compared.

use std::path::Path;

use serde::Deserialize;

use crate::commands::bench::report::Row;
use crate::error::CliError;

/// The parsed output of an earlier `bench --json`.
pub(super) struct Baseline {
    rows: Vec<Known>,
}

#[derive(Deserialize)]
struct Known {
    engine: String,
    scheme: String,
    vertices: usize,
    triangles: usize,
    seconds_per_sweep: f64,
}

impl Baseline {
    pub(super) fn read(path: &Path) -> Result<Self, CliError> {
        let refused = |problem: String| {
            CliError::input(format!("{}: {problem}", path.display()))
                .with_remedy("A baseline is a file with the output of `gpu-smooth bench --json`")
        };
        let text = std::fs::read_to_string(path).map_err(|error| refused(error.to_string()))?;
        let rows = serde_json::from_str(&text).map_err(|error| refused(error.to_string()))?;
        Ok(Self { rows })
    }

    /// Returns the seconds per sweep of the first earlier row with equal engine, scheme and mesh size; `None` without
    /// such a row.
    pub(super) fn seconds(&self, row: &Row) -> Option<f64> {
        let is_same = |known: &&Known| {
            (&known.engine, &known.scheme) == (&row.engine, &row.scheme)
                && (known.vertices, known.triangles) == (row.vertices, row.triangles)
        };
        self.rows.iter().find(is_same).map(|known| known.seconds_per_sweep)
    }
}
