//! Storage of the data: one record per line, appended immediately, so that a stopped study can be continued.

use std::fs::{self, File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::study::{Case, Size, Start, Study};

/// The parameters of a study, with program version and machine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Header {
    pub(crate) study: Study,
    pub(crate) version: String,
    pub(crate) cores: usize,
    pub(crate) processor: String,
    /// Name and driver of the adapter; `None` without a GPU.
    pub(crate) adapter: Option<String>,
}

/// Properties of a mesh after triangulation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct MeshRecord {
    pub(crate) domain: String,
    pub(crate) size: Size,
    pub(crate) vertices: usize,
    pub(crate) elements: usize,
    pub(crate) boundary: usize,
    pub(crate) min_angle: f64,
}

/// The desired f of a metric on a mesh.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct DesiredRecord {
    pub(crate) domain: String,
    pub(crate) size: Size,
    pub(crate) metric: String,
    pub(crate) f: f64,
    pub(crate) origin: String,
}

/// Time and objectives of a run after a sweep. A run's first sample precedes all sweeps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Sample {
    /// Time in seconds since the start of the first sweep.
    pub(crate) seconds: f64,
    /// Objective by the base metric.
    pub(crate) f: f64,
    /// Objective by EDGE; `None` if no figure needs it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) edge: Option<f64>,
    /// Objective by AREA; `None` if no figure needs it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) area: Option<f64>,
}

/// A run with its history.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct RunRecord {
    #[serde(flatten)]
    pub(crate) case: Case,
    pub(crate) desired: f64,
    pub(crate) stop: String,
    /// Duration of the whole run with its preparation, in seconds, for the estimate of the remaining time.
    pub(crate) wall_seconds: f64,
    pub(crate) history: Vec<Sample>,
    /// Distributions at convergence, for Figures 4 and 5.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) distributions: Vec<DistributionRecord>,
}

/// Histogram of an element quality. Ideal elements have quality 1.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct DistributionRecord {
    pub(crate) domain: String,
    pub(crate) start: Start,
    /// The scheme; empty for the mesh before smoothing.
    pub(crate) scheme: String,
    /// The quality: ratio of the shortest to the longest edge, or mean ratio.
    pub(crate) quality: String,
    pub(crate) mean: f64,
    /// Number of elements in each of [`BINS`] equal intervals from 0 to 1.
    pub(crate) counts: Vec<usize>,
}

/// Number of bins in a distribution.
pub(crate) const BINS: usize = 100;

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "record", rename_all = "kebab-case")]
pub(crate) enum Record {
    Header(Header),
    Mesh(MeshRecord),
    Desired(DesiredRecord),
    Run(RunRecord),
}

/// All records of a study, and the open file for further records.
pub(crate) struct Store {
    file: File,
    pub(crate) records: Vec<Record>,
}

fn path(folder: &Path) -> PathBuf {
    folder.join("data/records.jsonl")
}

/// Reads the records in a folder. An incomplete last line is ignored.
pub(crate) fn read(folder: &Path) -> Result<Vec<Record>, String> {
    let path = path(folder);
    let Ok(text) = fs::read_to_string(&path) else { return Ok(Vec::new()) };
    let complete = text.rfind('\n').map_or("", |end| &text[..end]);
    (1..)
        .zip(complete.lines())
        .map(|(i, line)| {
            serde_json::from_str(line).map_err(|e| format!("{}:{i}: {e}", path.display()))
        })
        .collect()
}

impl Store {
    /// Opens a folder for further records. A folder with records of another study is refused.
    pub(crate) fn open(folder: &Path, header: &Header) -> Result<Self, String> {
        let records = read(folder)?;
        match records.first() {
            None => {}
            Some(Record::Header(there)) if there == header => {}
            Some(_) => {
                return Err(format!(
                    "{} holds another study, of another mode, version or machine: remove it or name \
                     another folder",
                    folder.display()
                ));
            }
        }
        let failed = |e: std::io::Error| format!("{}: {e}", folder.display());
        fs::create_dir_all(folder.join("data")).map_err(failed)?;
        // Rewrites the file without the incomplete line.
        let mut text = String::new();
        for record in &records {
            text += &line(record)?;
        }
        fs::write(path(folder), text).map_err(failed)?;
        let file = OpenOptions::new().append(true).open(path(folder)).map_err(failed)?;
        let mut store = Self { file, records };
        if store.records.is_empty() {
            store.add(Record::Header(header.clone()))?;
        }
        Ok(store)
    }

    pub(crate) fn add(&mut self, record: Record) -> Result<(), String> {
        let line = line(&record)?;
        self.file.write_all(line.as_bytes()).map_err(|e| format!("records.jsonl: {e}"))?;
        self.records.push(record);
        Ok(())
    }

    pub(crate) fn mesh(&self, domain: &str, size: Size) -> Option<&MeshRecord> {
        self.records.iter().find_map(|record| match record {
            Record::Mesh(mesh) if mesh.domain == domain && mesh.size == size => Some(mesh),
            _ => None,
        })
    }

    pub(crate) fn desired(&self, domain: &str, size: Size, metric: &str) -> Option<&DesiredRecord> {
        self.records.iter().find_map(|record| match record {
            Record::Desired(d) if d.domain == domain && d.size == size && d.metric == metric => {
                Some(d)
            }
            _ => None,
        })
    }

    pub(crate) fn runs(&self) -> impl Iterator<Item = &RunRecord> {
        self.records.iter().filter_map(|record| match record {
            Record::Run(run) => Some(run),
            _ => None,
        })
    }
}

fn line(record: &Record) -> Result<String, String> {
    serde_json::to_string(record).map(|text| text + "\n").map_err(|e| e.to_string())
}
