//! The first table of a page of several meshes: a row for each mesh, which the script of the page sorts.

use std::cmp::Ordering;
use std::fmt::Write;

use gpu_smooth::measure::{Better, Statistics};

use crate::render::html::page::escape;
use crate::render::html::tables::{measure_name, measures, wide};
use crate::report::DistinctMeasures;
use crate::terminal::numbers::fit8;

/// Name of the table, to which links lead.
pub(crate) const TOP: &str = "overview";

/// A row of the table.
pub(crate) struct MeshNumbers<'a> {
    /// Name of the mesh.
    pub(crate) name: String,
    /// Number of triangles, and of quadrilaterals if they are measured.
    pub(crate) elements: usize,
    pub(crate) has_quadrilaterals: bool,
    /// Number of inverted, flat or concave elements.
    pub(crate) bad: usize,
    /// Statistics of each measure; all rows of a table have the same measures.
    pub(crate) statistics: &'a [Statistics],
}

/// Returns the name of the section of a mesh, to which the link of its row leads.
pub(crate) fn anchor(index: usize) -> String {
    format!("mesh-{}", index + 1)
}

/// Writes the table: the numbers of triangles and of bad triangles, and the worst value of each measure. Rows are sorted by
/// the worst value of the first measure, worst first.
pub(crate) fn table(meshes: &[&MeshNumbers<'_>]) -> String {
    let first = meshes.first().map_or(&[][..], |mesh| mesh.statistics);
    let all = measures(first);
    let has_quadrilaterals = meshes.iter().any(|mesh| mesh.has_quadrilaterals);
    let (name, bad) = match has_quadrilaterals {
        true => ("elements", "inverted, flat or concave"),
        false => ("triangles", "inverted or flat"),
    };
    let shown = DistinctMeasures::of(&all, has_quadrilaterals).shown;
    let has_value =
        |i: usize| meshes.iter().any(|mesh| mesh.statistics.get(i).is_some_and(|s| s.count > 0));
    let is_shown = |&i: &usize| shown.contains(&all[i]) && has_value(i);
    let columns: Vec<usize> = (0..all.len()).filter(is_shown).collect();
    let mut text = format!(
        "<p>The worst value of each measure. A click on a heading sorts the table, worst first; a second click reverses the \
         order.</p>{}<table class=\"overview\" id=\"{TOP}\"><thead><tr>",
        wide("overview")
    );
    let mut header = |kind: &str, name: &str, about: &str, is_sorted: bool| {
        let sorted = if is_sorted { " aria-sort=\"ascending\"" } else { "" };
        let (name, about) = (escape(name), escape(about));
        let _ = write!(
            text,
            "<th data-sort=\"{kind}\" title=\"{about}\"{sorted}><button>{name}</button></th>"
        );
    };
    header("text", "mesh", "the file", columns.is_empty());
    header("number", name, &format!("the number of {name}"), false);
    header("number", bad, &format!("the number of {bad} {name}"), false);
    for (place, &i) in columns.iter().enumerate() {
        header("number", &measure_name(all[i]), all[i].definition().formula, place == 0);
    }
    text += "</tr></thead><tbody>";
    for (index, mesh) in sorted(meshes, columns.first().copied()) {
        let MeshNumbers { name, elements, bad, statistics, .. } = mesh;
        let _ = write!(
            text,
            "<tr><td><a href=\"#{}\">{}</a></td><td data-key=\"-{elements}\">{elements}</td><td data-key=\"-{bad}\">{bad}</td>",
            anchor(index),
            escape(name)
        );
        for statistics in columns.iter().filter_map(|&i| statistics.get(i)) {
            let key = script_number(rank(statistics));
            let value = match statistics.count {
                0 => String::new(),
                _ => escape(&fit8(worst(statistics))),
            };
            let _ = write!(text, "<td data-key=\"{key}\">{value}</td>");
        }
        text += "</tr>";
    }
    text + "</tbody></table></div>"
}

/// Returns the meshes with their indices, worst first by the statistics at `column`.
fn sorted<'a, 'b>(
    meshes: &[&'a MeshNumbers<'b>],
    column: Option<usize>,
) -> Vec<(usize, &'a MeshNumbers<'b>)> {
    let mut rows: Vec<_> = meshes.iter().copied().enumerate().collect();
    let rank = |mesh: &MeshNumbers<'_>| Some(rank(mesh.statistics.get(column?)?));
    rows.sort_by(|(_, a), (_, b)| rank(a).partial_cmp(&rank(b)).unwrap_or(Ordering::Equal));
    rows
}

fn worst(statistics: &Statistics) -> f64 {
    match statistics.measure.definition().better {
        Better::Higher => statistics.min,
        Better::Lower => statistics.max,
    }
}

/// Returns the key by which meshes are sorted, which is smaller for a worse mesh.
fn rank(statistics: &Statistics) -> f64 {
    // A mesh without a value comes last.
    if statistics.count == 0 {
        return f64::INFINITY;
    }
    match statistics.measure.definition().better {
        Better::Higher => statistics.min,
        Better::Lower => -statistics.max,
    }
}

/// Formats a number as scripts read it.
fn script_number(x: f64) -> String {
    match x {
        x if x == f64::INFINITY => "Infinity".to_owned(),
        x if x == f64::NEG_INFINITY => "-Infinity".to_owned(),
        x => x.to_string(),
    }
}
