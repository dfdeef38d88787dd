//! The quality of meshes as text.

use std::fmt::Write;

use gpu_smooth::{
    Metric,
    measure::{Measure, Statistics},
};

use crate::commands::quality::bars::{self, Style};
use crate::commands::quality::mesh_quality::{MeshQuality, Region, Worst};
use crate::load::explain;
use crate::render::columns::{left, right, shortened};
use crate::terminal::numbers::{fit8, sig6};

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

/// Writes the measurements of one or more meshes.
pub(crate) fn text(qualities: &[MeshQuality], style: &Style) -> String {
    let mut text = String::new();
    for quality in qualities {
        let MeshQuality { path, format, vertices, free, triangles, remarks, .. } = quality;
        let _ = writeln!(text, "{}: {format}", path.display());
        remarks.iter().for_each(|remark| text.push_str(&format!("{remark}\n")));
        let _ = writeln!(text, "{vertices} vertices ({free} free), {triangles} triangles\n");
    }
    text.push_str(&table(qualities, style));
    for quality in qualities {
        text.push('\n');
        if qualities.len() > 1 {
            let _ = writeln!(text, "== {}", quality.path.display());
        }
        text.push_str(&details(quality, style));
    }
    text.trim_end().to_owned()
}

/// Writes a table with the statistics of all measures: one row per measure, or one row per measure
/// and file.
fn table(qualities: &[MeshQuality], style: &Style) -> String {
    let mut text = head(style);
    for (i, measure) in Measure::ALL.iter().enumerate() {
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
    text
}

fn head(style: &Style) -> String {
    line("", COLUMNS.map(str::to_owned), style)
}

fn row(name: &str, statistics: &Statistics, style: &Style) -> String {
    let Statistics { min, mean, max, deviation, quantiles: [low, median, high], .. } = statistics;
    line(name, [min, low, median, mean, high, max, deviation].map(|number| fit8(*number)), style)
}

fn line(name: &str, fields: [String; COLUMNS.len()], style: &Style) -> String {
    let mut text = left(name, NAME);
    for (field, is_shown) in fields.iter().zip(shown(style)) {
        if is_shown {
            text += &right(field, COLUMN);
        }
    }
    text + "\n"
}

/// Returns the name of a measure with its unit.
fn named(measure: Measure, style: &Style) -> String {
    match (measure.definition().unit, style.plain) {
        ("", _) => measure.name().to_owned(),
        ("°", true) => format!("{measure} (deg)"),
        (unit, _) => format!("{measure} {unit}"),
    }
}

/// Writes histograms, regions, worst triangles, objectives and counts of one mesh.
fn details(quality: &MeshQuality, style: &Style) -> String {
    let mut text = String::new();
    for histogram in &quality.histograms {
        text.push_str(&bars::text(histogram, &named(histogram.measure, style), style));
        text.push('\n');
    }
    text.push_str(&by_region(quality, style));
    if let Some(first) = quality.worst.first() {
        let by = first.values.first().map_or("", |value| value.0.name());
        let _ = writeln!(text, "worst triangles by {by}");
        quality.worst.iter().for_each(|worst| text.push_str(&worst_line(worst, style)));
        text.push('\n');
    }
    let report = &quality.report;
    for metric in Metric::ALL {
        let _ =
            writeln!(text, "{:<22}{:>12}", format!("f {metric}"), sig6(report.f[metric.name()]));
    }
    let (worst, place) = (sig6(report.worst_imr), &quality.worst_place);
    let at = format!("  triangle {} ({place})", place.id);
    let _ = writeln!(text, "{:<22}{worst:>12}{at}", "worst imr");
    if quality.free > 0 && report.worst_movable_imr < report.worst_imr {
        let movable = sig6(report.worst_movable_imr);
        let among = "among triangles with a free vertex";
        let _ = writeln!(text, "{:<22}{movable:>12}  {among}", "worst imr movable");
    }
    for (name, count) in [
        ("duplicate vertices", quality.duplicate_vertices),
        ("unused vertices", quality.unused_vertices),
        ("flat", quality.flat),
    ] {
        let _ = writeln!(text, "{name:<22}{count:>12}");
    }
    let _ = writeln!(text, "{:<22}{:>12}", "inverted or flat", report.inverted);
    for line in explain::list(&quality.bad, report.inverted, "--json") {
        let _ = writeln!(text, "  {line}");
    }
    text
}

/// Writes a table by region for each measure of `--measure`, then the list of regions.
fn by_region(quality: &MeshQuality, style: &Style) -> String {
    let mut text = String::new();
    for histogram in quality.histograms.iter().filter(|_| !quality.regions.is_empty()) {
        let measure = histogram.measure;
        let at = Measure::ALL.iter().position(|&other| other == measure).unwrap_or_default();
        let _ = writeln!(text, "{} by region", named(measure, style));
        text.push_str(&head(style));
        for (number, region) in (1..).zip(&quality.regions) {
            let name = match region.groups.first() {
                Some(group) => format!("{number} {}", group.short),
                None => format!("region {number}"),
            };
            text.push_str(&row(&shortened(&name, NAME - 1), &region.statistics[at], style));
        }
        text.push('\n');
    }
    for (number, region) in (1..).zip(&quality.regions) {
        let Region { first, groups, statistics } = region;
        let groups: Vec<&str> = groups.iter().map(|group| &*group.full).collect();
        let named = if groups.is_empty() { String::new() } else { groups.join(", ") + "; " };
        let count = statistics[0].count;
        let _ = writeln!(text, "region {number}: {named}{count} triangles, the first at {first}");
    }
    if !quality.regions.is_empty() {
        text.push('\n');
    }
    text
}

/// Writes the location of a triangle, its values, and whether smoothing can improve the triangle.
fn worst_line(worst: &Worst, style: &Style) -> String {
    let Worst { place, at: [x, y], values, can_move, .. } = worst;
    let values: Vec<String> =
        values.iter().map(|&(measure, value)| valued(measure, value, style)).collect();
    let movable = if *can_move { "can move" } else { "all its vertices are fixed" };
    let (label, values) = (place.id, values.join(", "));
    format!("  triangle {label} ({place}): {values}; at {} {}; {movable}\n", sig6(*x), sig6(*y))
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
