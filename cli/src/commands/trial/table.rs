//! The table of the tried runs, as text and as JSON.

use std::fmt::Write;

use serde_json::{Value, json};

use crate::args::TryArgs;
use crate::commands::trial::best::{ABOUT_LEAST, Best, Gains, MAX_MOVE, MAX_SIZE_CHANGE};
use crate::commands::trial::tried::Tried;
use crate::render::columns::{left, right};
use crate::report::{MeshReport, ProfileReport, QualityReport, Report, change_of, spacing_change};
use crate::request::TrialRun;
use crate::terminal::numbers::{elements, sig6};
use crate::terminal::shell_words;

/// The first two columns are shown with a profile alone.
const COLUMNS: [&str; 10] = [
    "failed",
    "warned",
    "f imr",
    "min angle",
    "max angle",
    "worst imr",
    "sizes",
    "moved",
    "spacing",
    "s",
];
const WIDTHS: [usize; 10] = [8, 8, 10, 10, 10, 10, 11, 8, 11, 8];
const EMPTY: [&str; 10] = [""; 10];

/// Returns the options of a run as a row of the table names them.
pub(super) fn label(run: &TrialRun) -> String {
    match run.options {
        [] => "without options".to_owned(),
        options => options.join(" "),
    }
}

/// Returns the command line of a run, in which words are quoted for a shell.
fn command(run: &TrialRun) -> String {
    let words = run.words.iter().map(|word| shell_words::quoted(word));
    words.collect::<Vec<_>>().join(" ")
}

/// Returns the table of the runs, the rule, and the command line of the best run.
pub(super) fn text(args: &TryArgs, tried: &[Tried<'_>], best: Option<Best>) -> String {
    let reports: Vec<&Report> =
        tried.iter().filter_map(|tried| tried.result.as_ref().ok()).collect();
    let Some(first) = reports.first() else { return String::new() };
    let name = |tried: &Tried<'_>| label(tried.run).len();
    let width = 2 + tried.iter().map(name).max().unwrap_or_default();
    let MeshReport { format, vertices, free, .. } = &first.mesh;
    let elements = elements(first.mesh.triangles, first.mesh.quadrilaterals);
    let mut text = format!(
        "{}: {format}, {vertices} vertices ({free} free), {elements}\n\n",
        args.mesh.display()
    );
    let profile = first.profile.as_ref();
    let skipped = if profile.is_some() { 0 } else { 2 };
    let mut line = |name: &str, fields: [&str; 10]| {
        text += &left(name, width);
        for (field, width) in fields.iter().zip(WIDTHS).skip(skipped) {
            text += &right(field, width);
        }
        text.truncate(text.trim_end().len());
        text.push('\n');
    };
    line("", COLUMNS);
    let [f, least, greatest, imr] = quality(&first.before);
    let [failed, warned] = beyond(profile.map(|profile| &profile.before));
    line("  before", [&failed, &warned, &f, &least, &greatest, &imr, "", "", "", ""]);
    for (row, tried) in tried.iter().enumerate() {
        let is_best = best.is_some_and(|best| best.row == row);
        let name = format!("{} {}", if is_best { "*" } else { " " }, label(tried.run));
        match &tried.result {
            Ok(report) => {
                let [f, least, greatest, imr] = quality(&report.after);
                let sizes = change_of(report.change.size.p95);
                let moved = format!("{:.2}", report.change.moved.p95);
                let spacing = spacing_change(&report.spacing).map(change_of).unwrap_or_default();
                let seconds = format!("{:.3}", report.seconds.total);
                let [failed, warned] =
                    beyond(report.profile.as_ref().map(|profile| &profile.after));
                let fields =
                    [failed, warned, f, least, greatest, imr, sizes, moved, spacing, seconds];
                line(&name, fields.each_ref().map(String::as_str));
            }
            Err(_) => line(&format!("{name} failed"), EMPTY),
        }
    }
    for tried in tried {
        if let Err(error) = &tried.result {
            let _ = writeln!(text, "{}: {error}", label(tried.run));
        }
    }
    let _ = write!(
        text,
        "\nworst imr: of the triangles with a free vertex. sizes, moved: 19 of 20 vertices change the size of the elements\n\
         around them, and move in lengths of an edge, by no more\n"
    );
    if let Some(profile) = profile {
        let name = profile.before.name();
        let _ = writeln!(text, "failed, warned: the parts of the mesh beyond the limits of {name}");
    }
    if spacing_change(&first.spacing).is_some() {
        text += "spacing: no vertex next to a wall with flat triangles changes its distance from the wall by more\n";
    }
    match best {
        Some(best) => {
            let _ = writeln!(text, "* the best row: {}\n", rule(best, profile.is_some()));
            let _ = write!(text, "{}", command(tried[best.row].run));
        }
        None => {
            let _ = write!(text, "{NO_BEST}");
        }
    }
    text.trim_end().to_owned()
}

/// Returns f by imr, the least and the largest angle, and the worst imr of the triangles with a free vertex.
fn quality(report: &QualityReport) -> [String; 4] {
    let [least, greatest] = [report.min_angle, report.max_angle].map(|a| format!("{a:.2}°"));
    [sig6(report.f["imr"]), least, greatest, sig6(report.worst_movable_imr)]
}

/// Returns the numbers of parts of the mesh beyond limits that fail and that warn; empty without a profile.
fn beyond(profile: Option<&ProfileReport>) -> [String; 2] {
    profile.map(|profile| profile.beyond().map(|count| count.to_string())).unwrap_or_default()
}

/// The sentence for runs none of which is the best.
const NO_BEST: &str =
    "no row helps: each makes the least angle or the worst imr worse, or leaves the mesh as it was";

/// Returns the rule by which a run is the best. `with_limits` says whether the runs have a profile.
fn rule(best: Best, with_limits: bool) -> String {
    let sizes = change_of(MAX_SIZE_CHANGE);
    let near = format!("{:.0} %", 100.0 * (ABOUT_LEAST - 1.0));
    let last = "the row with the least worst imr, and of rows within 1 % of that,\n  the row with the least f";
    let keeping = format!("with sizes up to {sizes} and moved up to {MAX_MOVE}");
    match (with_limits, best.keeps_mesh) {
        (true, true) => format!(
            "of the rows with the fewest failed and about the fewest warned (within {near}) that lower f,\n  {keeping}, {last}"
        ),
        (true, false) => format!(
            "no row with the fewest failed and about the fewest warned (within {near}) lowers f\n  {keeping}. \
             Of these rows with about the least moved (within {near}),\n  {last}"
        ),
        (false, true) => format!(
            "of the rows that lower f and make neither the least angle nor the worst imr worse,\n  {keeping}, {last}"
        ),
        (false, false) => format!(
            "no row lowers f and makes neither the least angle nor the worst imr worse\n  {keeping}. \
             Of the rows that make neither worse, with about the least moved (within {near}),\n  {last}"
        ),
    }
}

/// Returns the runs as JSON, with the rule and the command line of the best run.
pub(super) fn json(args: &TryArgs, tried: &[Tried<'_>], best: Option<Best>) -> Value {
    let (mut before, mut profile) = (Value::Null, None);
    let mut rows = Vec::new();
    for (row, tried) in tried.iter().enumerate() {
        let mut object = json!({
            "options": tried.run.options,
            "command": command(tried.run),
            "best": best.is_some_and(|best| best.row == row),
        });
        match &tried.result {
            Ok(report) => {
                before = json!(report.before);
                if let Some(change) = &report.profile {
                    profile = Some(json!(change.before));
                    object["profile"] = json!(change.after);
                }
                object["after"] = json!(report.after);
                object["change"] = json!(report.change);
                object["spacing"] = json!(report.spacing);
                object["keeps_mesh"] = Gains::from(report).keeps_mesh().into();
                object["engine"] = json!(report.engine);
                object["sweeps"] = report.sweeps.into();
                object["stop"] = report.stop.into();
                object["seconds"] = report.seconds.total.into();
            }
            Err(error) => object["error"] = error.to_string().into(),
        }
        rows.push(object);
    }
    let mut value = json!({
        "file": args.mesh.display().to_string(),
        "before": before,
        "runs": rows,
        "rule": best.map_or(NO_BEST.to_owned(), |best| {
            rule(best, profile.is_some()).replace("\n  ", " ")
        }),
        "command": best.map(|best| command(tried[best.row].run)),
    });
    if let Some(profile) = profile {
        value["profile"] = profile;
    }
    value
}
