//! The results of a batch as text, CSV and JSON.

use std::collections::HashMap;
use std::fmt::Write;
use std::path::PathBuf;

use serde_json::{Value, json};
use unicode_width::UnicodeWidthStr;

use crate::commands::batch::entry::{BatchStatus, Entry};
use crate::error::CliError;
use crate::render::columns::{left, quoted, right, shortened};
use crate::report::{ProfileChange, Report, versioned_json};
use crate::terminal::numbers::fit8;

/// Widths of the columns of numbers. A narrow terminal does not show the first two.
const WIDTHS: [usize; 7] = [9, 7, 10, 10, 10, 8, 8];

/// Width of the name column, and whether the terminal is narrow.
struct Widths {
    name: usize,
    is_narrow: bool,
}

impl Widths {
    fn new(entries: &[Entry], terminal: Option<usize>) -> Self {
        let longest = entries.iter().map(|entry| name(entry).width()).max().unwrap_or(0);
        let numbers: usize = WIDTHS.iter().sum();
        let room = |numbers: usize| terminal.unwrap_or(120).saturating_sub(numbers);
        let is_narrow = room(numbers) < 12;
        let left_out = if is_narrow { WIDTHS[0] + WIDTHS[1] } else { 0 };
        let room = room(numbers - left_out);
        Self { name: longest.clamp(7, room.max(8)), is_narrow }
    }

    fn line(&self, name: &str, columns: [String; WIDTHS.len()]) -> String {
        let mut text = left(&shortened(name, self.name), self.name);
        let skipped = if self.is_narrow { 2 } else { 0 };
        for (column, width) in columns.iter().zip(WIDTHS).skip(skipped) {
            text += &right(column, width);
        }
        text
    }
}

/// Returns the file name of a mesh, which is unique in a batch.
fn name(entry: &Entry) -> String {
    entry.input.file_name().unwrap_or_default().display().to_string()
}

/// Returns a table with one row per mesh, and a last line on all meshes. `terminal` is the width of the terminal in
/// columns; `None` without a terminal.
pub(crate) fn text(entries: &[Entry], seconds: f64, terminal: Option<usize>) -> String {
    let widths = Widths::new(entries, terminal);
    let base = entries.iter().find_map(|entry| entry.status.report()).map_or("imr", Report::base);
    let base = format!("f {base}");
    let head = ["vertices", "sweeps", &base, "after", "min angle", "after", "s"];
    let mut text = widths.line("mesh", head.map(str::to_owned));
    for entry in entries {
        text.push('\n');
        match entry.status.report() {
            Some(report) => {
                text += &widths.line(&name(entry), numbers(report));
                if !matches!(report.stop, "converged" | "reached") {
                    text += &format!("  {}", report.stop);
                }
            }
            None => {
                let name = left(&shortened(&name(entry), widths.name), widths.name);
                text += &format!("{name}  {}", entry.status.name());
            }
        }
    }
    text += &limits(entries, &widths);
    let _ = write!(text, "\n\n{}", counts(entries));
    let vertices: usize =
        entries.iter().filter_map(|entry| Some(entry.status.report()?.mesh.vertices)).sum();
    let _ = write!(text, "; {vertices} vertices in {seconds:.3} s");
    text
}

/// Returns a table of the parts beyond the limits of a profile, before and after, with a row for each smoothed mesh; empty
/// without a profile.
fn limits(entries: &[Entry], widths: &Widths) -> String {
    let mut text = String::new();
    for entry in entries {
        let Some(profile) = entry.status.report().and_then(|report| report.profile.as_ref()) else {
            continue;
        };
        if text.is_empty() {
            let title = left(&format!("limits of {}", profile.after.name()), widths.name);
            text = format!(
                "\n\n{title}{:>9}{:>9}{:>9}{:>9}  verdict",
                "failed", "after", "warned", "after"
            );
        }
        let (before, after) = (profile.before.beyond(), profile.after.beyond());
        let name = left(&shortened(&name(entry), widths.name), widths.name);
        let verdict = profile.after.verdict().name();
        let [failed, warned] = [0, 1].map(|k| format!("{:>9}{:>9}", before[k], after[k]));
        let _ = write!(text, "\n{name}{failed}{warned}  {verdict}");
    }
    text
}

/// Formats the numbers in the row of a smoothed mesh.
fn numbers(report: &Report) -> [String; WIDTHS.len()] {
    let (before, after) = (&report.before, &report.after);
    let base = report.base();
    let angle = |angle: f64| format!("{angle:.2}°");
    [
        report.mesh.vertices.to_string(),
        report.sweeps.to_string(),
        fit8(before.f[base]),
        fit8(after.f[base]),
        angle(before.min_angle),
        angle(after.min_angle),
        format!("{:.3}", report.seconds.total),
    ]
}

/// Counts the meshes by status.
fn counts(entries: &[Entry]) -> String {
    let mut counts: Vec<(&str, usize)> = Vec::new();
    for status in ["smoothed", "skipped", "failed", "interrupted"] {
        let count = entries.iter().filter(|entry| entry.status.name() == status).count();
        if count > 0 {
            counts.push((status, count));
        }
    }
    let counts: Vec<String> =
        counts.iter().map(|(status, count)| format!("{count} {status}")).collect();
    format!("{} of {}", counts.join(", "), counted(entries.len()))
}

fn counted(meshes: usize) -> String {
    if meshes == 1 { "1 mesh".into() } else { format!("{meshes} meshes") }
}

/// Returns each distinct remark on smoothed meshes once, with the mesh, or with the number of meshes and the first of them.
pub(crate) fn notes(entries: &[Entry]) -> Vec<String> {
    let mut meshes_of: Vec<(&str, Vec<&Entry>)> = Vec::new();
    let mut index_of: HashMap<&str, usize> = HashMap::new();
    for entry in entries {
        let BatchStatus::Smoothed { remarks, .. } = &entry.status else { continue };
        for remark in remarks {
            let index = *index_of.entry(remark).or_insert(meshes_of.len());
            if index == meshes_of.len() {
                meshes_of.push((remark, Vec::new()));
            }
            meshes_of[index].1.push(entry);
        }
    }
    let note = |(remark, meshes): &(&str, Vec<&Entry>)| {
        let first = meshes[0].input.display();
        match meshes.len() {
            1 => format!("{first}: {remark}"),
            count => {
                let all = counted(entries.len());
                format!("{remark} ({count} of {all}; the first is {first})")
            }
        }
    };
    meshes_of.iter().map(note).collect()
}

/// Returns an error that lists the failed meshes with their problems; `None` without failures.
pub(crate) fn failures(entries: &[Entry]) -> Option<CliError> {
    let failed = || entries.iter().filter_map(|entry| Some((entry, entry.status.problem()?)));
    let count = failed().count();
    let line = |(entry, problem): (&Entry, String)| {
        let input = entry.input.display().to_string();
        // Most problems begin with the path of a file of the mesh.
        let named = |path: &PathBuf| problem.starts_with(&*path.to_string_lossy());
        match entry.files.iter().any(named) || problem.starts_with(&input) {
            true => problem,
            false => format!("{input}: {problem}"),
        }
    };
    let text = format!("{count} of {} failed", counted(entries.len()));
    (count > 0).then(|| CliError::run(text).with_details(failed().map(line).collect()))
}

/// Columns of CSV, and keys of JSON.
const KEYS: [&str; 23] = [
    "mesh",
    "out",
    "status",
    "vertices",
    "triangles",
    "free",
    "sweeps",
    "stop",
    "metric",
    "f_before",
    "f_after",
    "min_angle_before",
    "min_angle_after",
    "worst_imr_before",
    "worst_imr_after",
    "failed_before",
    "failed_after",
    "warned_before",
    "warned_after",
    "verdict",
    "engine",
    "seconds",
    "problem",
];

fn values(entry: &Entry) -> [Value; KEYS.len()] {
    let [input, out] = [&entry.input, &entry.out].map(|path| path.display().to_string());
    let head = [json!(input), json!(out), json!(entry.status.name())];
    let numbers = match entry.status.report() {
        None => std::array::from_fn(|_| Value::Null),
        Some(report) => {
            let Report { mesh, before, after, .. } = report;
            let base = report.base();
            let profile = report.profile.as_ref();
            let [failed, warned] = [0, 1].map(|k| {
                let counts = |profile: &ProfileChange| {
                    [&profile.before, &profile.after].map(|state| state.beyond()[k])
                };
                profile
                    .map(counts)
                    .map_or([Value::Null, Value::Null], |counts| counts.map(Value::from))
            });
            let [failed_before, failed_after] = failed;
            let [warned_before, warned_after] = warned;
            [
                json!(mesh.vertices),
                json!(mesh.triangles),
                json!(mesh.free),
                json!(report.sweeps),
                json!(report.stop),
                json!(base),
                json!(before.f[base]),
                json!(after.f[base]),
                json!(before.min_angle),
                json!(after.min_angle),
                json!(before.worst_imr),
                json!(after.worst_imr),
                failed_before,
                failed_after,
                warned_before,
                warned_after,
                json!(profile.map(|profile| profile.after.verdict().name())),
                json!(report.engine.kind),
                json!(report.seconds.total),
            ]
        }
    };
    let mut all =
        head.into_iter().chain::<[Value; 19]>(numbers).chain([json!(entry.status.problem())]);
    std::array::from_fn(|_| all.next().unwrap_or_default())
}

/// Returns CSV: a header, then one row per mesh.
pub(crate) fn csv(entries: &[Entry]) -> String {
    let mut text = KEYS.join(",");
    for entry in entries {
        let fields = values(entry).map(|value| match value {
            Value::Null => String::new(),
            Value::String(text) => quoted(&text),
            number => number.to_string(),
        });
        let _ = write!(text, "\n{}", fields.join(","));
    }
    text
}

/// Returns a JSON array with one object per mesh.
pub(crate) fn json(entries: &[Entry]) -> Result<String, CliError> {
    let object =
        |entry| Value::Object(KEYS.map(str::to_owned).into_iter().zip(values(entry)).collect());
    let list: Vec<Value> = entries.iter().map(object).collect();
    Ok(serde_json::to_string_pretty(&list)?)
}

/// Returns the JSON report on all meshes. Each smoothed mesh has the report of a single run.
pub(crate) fn report(entries: &[Entry], seconds: f64) -> Result<String, CliError> {
    let mut meshes = Vec::new();
    for Entry { input, out, status, .. } in entries {
        let mut object = json!({
            "mesh": input.display().to_string(), "out": out.display().to_string(), "status": status.name(),
        });
        match status {
            BatchStatus::Smoothed { report, remarks } => {
                object["remarks"] = json!(remarks);
                object["report"] = serde_json::to_value(report)?;
            }
            BatchStatus::Failed(failure) => {
                object["error"] = json!(status.problem());
                object["triangles"] = json!(failure.triangles.as_deref().unwrap_or_default());
            }
            BatchStatus::Skipped | BatchStatus::Interrupted => {}
        }
        meshes.push(object);
    }
    versioned_json(json!({ "meshes": meshes, "seconds": seconds }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::PathBuf;

    fn entry(name: &str) -> Entry {
        let path = PathBuf::from(name);
        Entry {
            input: path.clone(),
            out: path.clone(),
            files: vec![path],
            status: BatchStatus::Skipped,
        }
    }

    #[test]
    fn tables_fit_their_terminal() {
        let entries = ["a.msh", "東京湾の網格.msh", "a-mesh-with-quite-a-long-name-of-its-own.msh"];
        let entries = entries.map(entry);
        for (terminal, name, is_narrow) in
            [(Some(80), 18, false), (Some(60), 14, true), (Some(200), 44, false), (None, 44, false)]
        {
            let widths = Widths::new(&entries, terminal);
            assert_eq!((widths.name, widths.is_narrow), (name, is_narrow), "{terminal:?}");
            let text = text(&entries, 0.0, terminal);
            let head = text.lines().next().unwrap();
            assert!(head.width() <= terminal.unwrap_or(120), "{text}");
            for line in text.lines().filter(|line| line.ends_with("skipped")) {
                assert_eq!(line.width(), name + "  skipped".len(), "{text}");
            }
            assert_eq!(head.contains("sweeps"), !is_narrow);
        }
    }
}
