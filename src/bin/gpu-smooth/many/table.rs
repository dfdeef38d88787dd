//! What became of many meshes: as a table, as CSV and as JSON.

use std::fmt::Write;
use std::path::PathBuf;

use serde_json::{Value, json};

use crate::columns::{left, quoted, right, shortened};
use crate::many::entry::{Entry, Told};
use crate::numbers::{five, six};
use crate::report::Report;

/// The width of the names in the table.
const NAME: usize = 22;

/// A line for each mesh, and one for all of them.
pub(crate) fn text(entries: &[Entry], seconds: f64) -> String {
    let base = entries.iter().find_map(|entry| entry.told.report()).map_or("imr", Report::base);
    let mut text = left("mesh", NAME);
    for column in ["vertices", "sweeps"] {
        text += &right(column, 9);
    }
    for column in [format!("f {base}"), "after".into(), "min angle".into(), "after".into()] {
        text += &right(&column, 11);
    }
    text += &right("s", 9);
    for entry in entries {
        // No two have the same.
        let name = entry.input.file_name().unwrap_or_default().display().to_string();
        let _ = write!(text, "\n{}", left(&shortened(&name, NAME - 1), NAME));
        match entry.told.report() {
            Some(report) => text += &numbers(report),
            None => text += &format!("  {}", entry.told.status()),
        }
    }
    let _ = write!(text, "\n\n{}", counts(entries));
    let vertices: usize =
        entries.iter().filter_map(|entry| Some(entry.told.report()?.mesh.vertices)).sum();
    let _ = write!(text, "; {vertices} vertices in {seconds:.3} s");
    text
}

/// The columns of a mesh that was smoothed.
fn numbers(report: &Report) -> String {
    let (before, after) = (&report.before, &report.after);
    let base = report.base();
    let mut text = right(&report.mesh.vertices.to_string(), 9);
    text += &right(&report.sweeps.to_string(), 9);
    let angle = |angle: f64| format!("{angle:.2}°");
    for column in
        [six(before.f[base]), six(after.f[base]), angle(before.min_angle), angle(after.min_angle)]
    {
        text += &right(&column, 11);
    }
    text += &right(&five(report.seconds.total), 9);
    match report.stop {
        "converged" | "reached" => text,
        stop => text + "  " + stop,
    }
}

/// How many meshes came to which end.
fn counts(entries: &[Entry]) -> String {
    let mut counts: Vec<(&str, usize)> = Vec::new();
    for status in ["smoothed", "skipped", "failed", "interrupted"] {
        let count = entries.iter().filter(|entry| entry.told.status() == status).count();
        if count > 0 {
            counts.push((status, count));
        }
    }
    let told: Vec<String> =
        counts.iter().map(|(status, count)| format!("{count} {status}")).collect();
    format!("{} of {}", told.join(", "), counted(entries.len()))
}

fn counted(meshes: usize) -> String {
    if meshes == 1 { "1 mesh".into() } else { format!("{meshes} meshes") }
}

/// The meshes that failed with their reasons, if any did.
pub(crate) fn failures(entries: &[Entry]) -> Option<String> {
    let failed = || entries.iter().filter_map(|entry| Some((entry, entry.told.problem()?)));
    let count = failed().count();
    let mut text = format!("{count} of {} failed", counted(entries.len()));
    for (entry, problem) in failed() {
        let input = entry.input.display().to_string();
        // Most reasons start with a file of the mesh.
        let named = |path: &PathBuf| problem.starts_with(&*path.to_string_lossy());
        let _ = match entry.files.iter().any(named) || problem.starts_with(&input) {
            true => write!(text, "\n  {problem}"),
            false => write!(text, "\n  {input}: {problem}"),
        };
    }
    (count > 0).then_some(text)
}

/// The columns of CSV and keys of JSON.
const KEYS: [&str; 18] = [
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
    "engine",
    "seconds",
    "problem",
];

fn values(entry: &Entry) -> [Value; KEYS.len()] {
    let [input, out] = [&entry.input, &entry.out].map(|path| path.display().to_string());
    let head = [json!(input), json!(out), json!(entry.told.status())];
    let numbers = match entry.told.report() {
        None => std::array::from_fn(|_| Value::Null),
        Some(report) => {
            let Report { mesh, before, after, .. } = report;
            let base = report.base();
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
                json!(report.engine.kind),
                json!(report.seconds.total),
            ]
        }
    };
    let mut all =
        head.into_iter().chain::<[Value; 14]>(numbers).chain([json!(entry.told.problem())]);
    std::array::from_fn(|_| all.next().unwrap_or_default())
}

/// A row for each mesh.
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

/// An object for each mesh, in a list.
pub(crate) fn json(entries: &[Entry]) -> Result<String, String> {
    let object =
        |entry| Value::Object(KEYS.map(str::to_owned).into_iter().zip(values(entry)).collect());
    let list: Vec<Value> = entries.iter().map(object).collect();
    serde_json::to_string_pretty(&list).map_err(|error| error.to_string())
}

/// All that is known of all meshes: of each that was smoothed the report that a run by itself writes.
pub(crate) fn report(entries: &[Entry], seconds: f64) -> Result<String, String> {
    let told = |error: serde_json::Error| error.to_string();
    let mut meshes = Vec::new();
    for Entry { input, out, told: what, .. } in entries {
        let mut object = json!({
            "mesh": input.display().to_string(), "out": out.display().to_string(), "status": what.status(),
        });
        match what {
            Told::Smoothed { report, remarks } => {
                object["remarks"] = json!(remarks);
                object["report"] = serde_json::to_value(report).map_err(told)?;
            }
            Told::Failed(failure) => {
                object["error"] = json!(what.problem());
                object["triangles"] = serde_json::to_value(&failure.triangles).map_err(told)?;
            }
            Told::Skipped | Told::Interrupted => {}
        }
        meshes.push(object);
    }
    let all = json!({ "meshes": meshes, "seconds": seconds });
    serde_json::to_string_pretty(&all).map(|text| text + "\n").map_err(told)
}
