//! The quality of meshes as text.

use std::fmt::Write;

use unicode_width::UnicodeWidthStr;

use gpu_smooth::{
    Metric,
    measure::{Measure, Statistics},
};

use crate::commands::quality::bars::{self, Style};
use crate::commands::quality::mesh_quality::{GroupNames, MeshQuality, Region};
use crate::commands::quality::worst::WorstPart;
use crate::load::Place;
use crate::load::explain;
use crate::render::columns::{left, right, shortened};
use crate::report::DistinctMeasures;
use crate::terminal::numbers::elements;
use crate::terminal::numbers::{coordinate, fit8, sig6};

/// Width of a table's first column, in characters.
const NAME: usize = 17;

/// Columns of numbers. A terminal of 80 columns shows all seven.
const COLUMNS: [&str; 7] = ["min", "5 %", "median", "mean", "95 %", "max", "sd"];
const COLUMN: usize = 9;

/// Selects the columns that fit the terminal, the most important first.
fn shown(style: &Style) -> [bool; COLUMNS.len()] {
    let fit = style.width.saturating_sub(NAME) / COLUMN;
    let mut shown = [false; COLUMNS.len()];
    [0, 5, 3, 2, 6, 1, 4].into_iter().take(fit).for_each(|column| shown[column] = true);
    shown
}

/// Writes the measurements of one or more meshes. If `is_usual` is true, the metrics of runs are left out, except for f by
/// imr.
pub(crate) fn text(qualities: &[MeshQuality], is_usual: bool, style: &Style) -> String {
    let mut text = String::new();
    for quality in qualities {
        let MeshQuality { path, format, vertices, free, remarks, .. } = quality;
        let elements = elements(quality.triangles, quality.quadrilaterals);
        let _ = writeln!(text, "{}: {format}", path.display());
        remarks.iter().for_each(|remark| text.push_str(&format!("{remark}\n")));
        let _ = writeln!(text, "{vertices} vertices ({free} free), {elements}\n");
    }
    text.push_str(&table(qualities, is_usual, style));
    for quality in qualities {
        text.push('\n');
        if qualities.len() > 1 {
            let _ = writeln!(text, "== {}", quality.path.display());
        }
        text.push_str(&details(quality, is_usual, style));
    }
    text.trim_end().to_owned()
}

/// Describes a mesh in one line, for logs.
pub(crate) fn in_short(quality: &MeshQuality, style: &Style) -> String {
    let report = &quality.report;
    let elements = elements(quality.triangles, quality.quadrilaterals);
    let angle = valued(Measure::MinAngle, report.min_angle, style);
    let (worst, inverted) = (sig6(report.worst_imr), report.inverted);
    format!("{elements}, {angle}, worst imr {worst}, {inverted} inverted or flat")
}

/// Writes a table of statistics: one row per measure, or one row per measure and file. Measures with equal values share
/// a row, and a sentence below the table names them. If `is_usual` is true, a sentence names the metrics of runs instead.
fn table(qualities: &[MeshQuality], is_usual: bool, style: &Style) -> String {
    let mut text = head(style);
    let Some(first) = qualities.first() else { return text };
    let measures: Vec<Measure> = first.statistics.iter().map(|row| row.measure).collect();
    let has_quadrilaterals = qualities.iter().any(|quality| quality.quadrilaterals > 0);
    let DistinctMeasures { mut shown, equal } = DistinctMeasures::of(&measures, has_quadrilaterals);
    if is_usual {
        shown.retain(|measure| !matches!(measure, Measure::Metric(_)));
    }
    let has_value = |i: usize| qualities.iter().any(|quality| quality.statistics[i].count > 0);
    let is_shown = |&(i, measure): &(usize, &Measure)| shown.contains(measure) && has_value(i);
    let shown = measures.iter().enumerate().filter(is_shown);
    for (i, measure) in shown {
        match qualities {
            [only] => text.push_str(&row(&named(*measure, style), &only.statistics[i], style)),
            several => {
                let _ = writeln!(text, "{}", named(*measure, style));
                for quality in several {
                    let name = shortened(&quality.path.display().to_string(), NAME - 2);
                    text.push_str(&row(&format!("  {name}"), &quality.statistics[i], style));
                }
            }
        }
    }
    if is_usual {
        let metrics: Vec<&str> = Metric::ALL.iter().map(|metric| metric.name()).collect();
        let _ = writeln!(text, "Not listed: the metrics of runs (-m {})", metrics.join(","));
    } else if !equal.is_empty() {
        let _ = writeln!(text, "Not listed: {}", equal.join(", "));
    }
    text
}

fn head(style: &Style) -> String {
    line("", COLUMNS.map(str::to_owned), style)
}

fn row(name: &str, statistics: &Statistics, style: &Style) -> String {
    let Statistics { count, min, mean, max, deviation, quantiles, .. } = statistics;
    let [low, median, high] = quantiles;
    // Quadrilaterals lack some measures.
    let field = |number: &f64| if *count == 0 { "-".to_owned() } else { fit8(*number) };
    line(name, [min, low, median, mean, high, max, deviation].map(field), style)
}

fn line(name: &str, fields: [String; COLUMNS.len()], style: &Style) -> String {
    let numbers = fields.iter().zip(shown(style)).filter(|(_, is_shown)| *is_shown);
    let mut numbers: String = numbers.map(|(field, _)| right(field, COLUMN)).collect();
    // A long name takes blanks of the first column. If the blanks do not suffice, the numbers stand on a line of their own.
    let excess = name.width().saturating_sub(NAME);
    let blanks = numbers.len() - numbers.trim_start().len();
    if excess < blanks.max(1) {
        numbers.drain(..excess);
        return format!("{}{numbers}\n", left(name, NAME));
    }
    format!("{name}\n{}{numbers}\n", left("", NAME))
}

/// Returns the name of a measure with its unit.
fn named(measure: Measure, style: &Style) -> String {
    match (measure.definition().unit, style.plain) {
        ("", _) => measure.name().to_owned(),
        ("°", true) => format!("{measure} (deg)"),
        (unit, _) => format!("{measure} {unit}"),
    }
}

/// Writes histograms, regions, worst triangles or edges, objectives and counts of one mesh.
fn details(quality: &MeshQuality, is_usual: bool, style: &Style) -> String {
    let mut text = String::new();
    for histogram in &quality.histograms {
        text.push_str(&bars::text(histogram, &named(histogram.measure, style), style));
        text.push('\n');
    }
    text.push_str(&by_region(quality, style));
    if let Some(first) = quality.worst.first() {
        let by = first.values.first().map_or("", |value| value.0.name());
        let parts = match (&first.place, quality.quadrilaterals) {
            (Place::Edge(_), _) => "edges",
            (_, 0) => "triangles",
            _ => "elements",
        };
        let _ = writeln!(text, "worst {parts} by {by}");
        quality.worst.iter().for_each(|worst| text.push_str(&worst_line(worst, style)));
        text.push('\n');
    }
    let report = &quality.report;
    let objectives = match is_usual {
        true => vec![("f imr".to_owned(), Metric::Imr)],
        false => objectives(quality.quadrilaterals > 0),
    };
    for (name, metric) in objectives {
        let _ = writeln!(text, "{name:<22}{:>12}", sig6(report.f[metric.name()]));
    }
    let (worst, place) = (sig6(report.worst_imr), &quality.worst_place);
    let _ = writeln!(text, "{:<22}{worst:>12}  {place}", "worst imr");
    if quality.free > 0 && report.worst_movable_imr < report.worst_imr {
        let movable = sig6(report.worst_movable_imr);
        let kind = if quality.quadrilaterals > 0 { "elements" } else { "triangles" };
        let among = format!("among {kind} with a free vertex");
        let _ = writeln!(text, "{:<22}{movable:>12}  {among}", "worst imr movable");
    }
    for (name, count) in [
        ("duplicate vertices", quality.duplicate_vertices),
        ("unused vertices", quality.unused_vertices),
        ("flat", quality.flat),
    ] {
        let _ = writeln!(text, "{name:<22}{count:>12}");
    }
    let bad = match quality.quadrilaterals {
        0 => "inverted or flat",
        _ => "inverted or concave",
    };
    let _ = writeln!(text, "{bad:<22}{:>12}", report.inverted);
    let [triangles, corners] = quality.bad_counts;
    let mut lines = explain::list(&quality.bad, triangles, "--json");
    lines.extend(explain::list_corners(&quality.bad_corners, corners, "--json"));
    for line in lines {
        let _ = writeln!(text, "  {line}");
    }
    text
}

/// Returns the metrics whose objectives are listed, each with the names of all metrics with equal objectives, which only
/// meshes of triangles have.
fn objectives(has_quadrilaterals: bool) -> Vec<(String, Metric)> {
    let mut rows: Vec<(String, Metric)> = Vec::new();
    for &metric in Metric::ALL {
        let twin = |metric| Measure::Metric(metric).equal_to();
        let is_twin = |row: &&mut (String, Metric)| {
            !has_quadrilaterals && twin(metric).is_some() && twin(row.1) == twin(metric)
        };
        match rows.iter_mut().find(is_twin) {
            Some((name, _)) => *name += &format!(", {metric}"),
            None => rows.push((format!("f {metric}"), metric)),
        }
    }
    rows
}

/// Writes a table by region for each measure with a histogram, then the list of regions. Regions have the names that
/// `--only` accepts.
fn by_region(quality: &MeshQuality, style: &Style) -> String {
    let mut text = String::new();
    for histogram in quality.histograms.iter().filter(|_| !quality.regions.is_empty()) {
        let _ = writeln!(text, "{} by region", named(histogram.measure, style));
        text.push_str(&head(style));
        for (number, region) in (1..).zip(&quality.regions) {
            // A group of several regions does not name any of them.
            let name = match region.groups.iter().find(|group| group.is_of_one_region) {
                Some(group) => shortened(&group.spelling, NAME - 1),
                None => format!("region {number}"),
            };
            let of_measure = |row: &&Statistics| row.measure == histogram.measure;
            if let Some(statistics) = region.statistics.iter().find(of_measure) {
                text.push_str(&row(&name, statistics, style));
            }
        }
        text.push('\n');
    }
    for (number, region) in (1..).zip(&quality.regions) {
        let Region { first, groups, .. } = region;
        let elements = elements(region.triangles, region.quadrilaterals);
        let full = |group: &GroupNames| format!("{} ({})", group.spelling, group.kind);
        let groups: Vec<String> = groups.iter().map(full).collect();
        let named = if groups.is_empty() { String::new() } else { groups.join(", ") + "; " };
        let _ =
            writeln!(text, "region {number}: {named}{elements}, the first at {}", first.location());
    }
    if quality.regions.len() > 1 && quality.regions.iter().all(|region| region.groups.is_empty()) {
        text.push_str("The file has no groups, so --only accepts no name of a region\n");
    }
    if !quality.regions.is_empty() {
        text.push('\n');
    }
    text
}

/// Writes the location of an element or edge, its values, and whether smoothing can improve them.
fn worst_line(worst: &WorstPart, style: &Style) -> String {
    let WorstPart { place, at, values, can_move, .. } = worst;
    let [x, y] = at.map(|x| coordinate(x, worst.length));
    let values: Vec<String> =
        values.iter().map(|&(measure, value)| valued(measure, value, style)).collect();
    let movable = match (can_move, place) {
        (true, _) => "can move",
        (false, Place::Edge(_)) => "all vertices of its triangles are fixed",
        (false, _) => "all its vertices are fixed",
    };
    format!("  {place}: {}; at {x} {y}; {movable}\n", values.join(", "))
}

/// Formats a value with the name and unit of its measure.
pub(crate) fn valued(measure: Measure, value: f64, style: &Style) -> String {
    match (measure.definition().unit, style.plain) {
        ("°", true) => format!("{measure} {} deg", fit8(value)),
        (unit, _) => format!("{measure} {}{unit}", fit8(value)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_narrow_terminal_has_the_most_important_columns() {
        let names = |width| {
            let mut style = Style::of_terminal(true);
            style.width = width;
            let line = line("shape", COLUMNS.map(str::to_owned), &style);
            assert!(line.trim_end().len() <= width, "{line}");
            line[NAME..].trim().split("  ").map(|n| n.trim().to_owned()).collect::<Vec<_>>()
        };
        let full = |width| names(width).into_iter().filter(|n| !n.is_empty()).collect::<Vec<_>>();
        assert_eq!(full(80), COLUMNS);
        assert_eq!(full(71), ["min", "5 %", "median", "mean", "max", "sd"]);
        assert_eq!(full(50), ["min", "mean", "max"]);
        assert_eq!(full(40), ["min", "max"]);
    }
}
