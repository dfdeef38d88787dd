//! Tables of numbers on the page.

use std::fmt::Write;

use gpu_smooth::measure::{Measure, Measured, Statistics};

use crate::render::html::page::escape;
use crate::report::{DistinctMeasures, Report, Seconds};
use crate::terminal::numbers::{fit8, sig6};

/// Returns the start tag of a block that scrolls sideways if the window is narrower than its content. Keys scroll a block
/// that can have the focus. `name` names the block for screen readers.
pub(crate) fn wide(name: &str) -> String {
    format!("<div class=\"wide\" tabindex=\"0\" role=\"group\" aria-label=\"{}\">", escape(name))
}

/// Writes the summary of the terminal as HTML: subject, table of values before and after, and sentences.
pub(crate) fn summary(report: &Report) -> String {
    let mut text = format!(
        "{}{}<table><thead><tr><th>quantity</th><th>before</th><th>after</th></tr></thead><tbody>",
        report.subject().lines().map(|line| format!("<p>{}</p>", escape(line))).collect::<String>(),
        wide("summary")
    );
    for [name, before, after] in report.rows() {
        // The terminal indents rows that belong to the row above.
        let class = if name.starts_with(' ') { " class=\"under\"" } else { "" };
        let _ = write!(
            text,
            "<tr><th{class}>{}</th><td>{}</td><td>{}</td></tr>",
            escape(name.trim()),
            escape(&before),
            escape(&after)
        );
    }
    text += "</tbody></table></div>";
    for sentence in report.sentences() {
        let _ = write!(text, "<p>{}</p>", escape(&sentence));
    }
    text
}

/// Writes a table with the statistics of all measures, in pairs of rows before and after a run, and the notes on it.
pub(crate) fn statistics(states: [&Measured<'_>; 2]) -> String {
    let [before, after] = states.map(|state| state.statistics(Measure::ALL));
    let has_quadrilaterals = states[0].topology().quadrilaterals().len() > 0;
    statistics_table(&[("before", &before), ("after", &after)], has_quadrilaterals)
        + &notes(Measure::ALL, has_quadrilaterals)
}

/// Writes a table of statistics. Each state has a name and statistics by the same measures, and a row for each measure. A
/// single state has no column of names.
pub(crate) fn statistics_table(
    states: &[(&str, &[Statistics])],
    has_quadrilaterals: bool,
) -> String {
    let is_alone = states.len() == 1;
    let class = if is_alone { "one" } else { "pairs" };
    let mut text =
        format!("{}<table class=\"{class}\"><thead><tr><th>measure</th>", wide("statistics"));
    text += if is_alone { "" } else { "<th>mesh</th>" };
    for column in ["min", "5 %", "median", "mean", "95 %", "max", "sd"] {
        let _ = write!(text, "<th>{column}</th>");
    }
    text += "</tr></thead><tbody>";
    let measures = measures(states.first().map_or(&[][..], |(_, statistics)| statistics));
    let shown = DistinctMeasures::of(&measures, has_quadrilaterals).shown;
    let has_value =
        |i: usize| states.iter().any(|(_, own)| own.get(i).is_some_and(|s| s.count > 0));
    let is_shown = |&(i, measure): &(usize, &Measure)| shown.contains(measure) && has_value(i);
    for (i, measure) in measures.iter().enumerate().filter(is_shown) {
        let (name, source) =
            (escape(&measure_name(*measure)), escape(measure.definition().formula));
        let rows = states.len();
        let _ = write!(text, "<tr><th rowspan=\"{rows}\" title=\"{source}\">{name}</th>");
        for (number, (name, statistics)) in states.iter().enumerate() {
            text += if number == 0 { "" } else { "<tr class=\"more\">" };
            if !is_alone {
                let _ = write!(text, "<td class=\"state\">{}</td>", escape(name));
            }
            statistics.get(i).inspect(|statistics| row(&mut text, statistics));
        }
    }
    text + "</tbody></table></div>"
}

/// Returns the noun of what has a value by a measure.
pub(crate) fn noun_of(measure: Measure) -> &'static str {
    if measure.is_of_edges() { "edge" } else { "element" }
}

/// Returns the measures of statistics.
pub(crate) fn measures(statistics: &[Statistics]) -> Vec<Measure> {
    statistics.iter().map(|statistics| statistics.measure).collect()
}

/// Writes which of the measures are equal to others, and where measures are defined.
pub(crate) fn notes(measures: &[Measure], has_quadrilaterals: bool) -> String {
    let equal = DistinctMeasures::of(measures, has_quadrilaterals).equal;
    let equal = if equal.is_empty() { String::new() } else { format!("{}. ", equal.join(", ")) };
    format!("<p>{equal}docs/quality.md of the program defines each measure.</p>")
}

/// Writes the numbers of a row of statistics, and ends the row.
fn row(text: &mut String, statistics: &Statistics) {
    let Statistics { count, min, mean, max, deviation, quantiles: [low, median, high], .. } =
        statistics;
    for number in [min, low, median, mean, high, max, deviation] {
        let shown = if *count > 0 { fit8(*number) } else { String::new() };
        let _ = write!(text, "<td>{}</td>", escape(&shown));
    }
    *text += "</tr>";
}

/// Writes the duration of the run's stages as a bar with percentages. The time of the page itself is known up to this
/// table.
pub(crate) fn time(seconds: &Seconds) -> String {
    let Seconds { read, prepare, smooth, write, pictures, total } = *seconds;
    let parts = [
        ("read", read),
        ("prepare", prepare),
        ("smooth", smooth),
        ("write", write),
        ("pictures", pictures),
    ];
    let (mut bar, mut names) = (String::new(), String::new());
    for (name, seconds) in parts {
        let share = 100.0 * seconds / total.max(f64::MIN_POSITIVE);
        let _ = write!(bar, "<span class=\"{name}\" style=\"width:{share:.3}%\"></span>");
        let _ = write!(
            names,
            "<li><span class=\"{name} key\"></span>{name} {} s ({share:.1} %)</li>",
            sig6(seconds)
        );
    }
    format!(
        "<div class=\"parts\">{bar}</div><ul class=\"keys\">{names}<li>total {} s</li></ul>",
        sig6(total)
    )
}

/// Returns the name of a measure with its unit.
pub(crate) fn measure_name(measure: Measure) -> String {
    match measure.definition().unit {
        "" => measure.name().to_owned(),
        unit => format!("{measure}, {unit}"),
    }
}
