//! Tables of numbers on the page.

use std::fmt::Write;

use gpu_smooth::measure::{Measure, Measured, Statistics};

use crate::render::html::page::escape;
use crate::report::{Report, Seconds};
use crate::terminal::numbers::{fit8, sig6};

/// Writes the summary of the terminal as HTML: subject, and table of values before and after.
pub(crate) fn summary(report: &Report) -> String {
    let mut text = format!(
        "{}<div class=\"wide\"><table><thead><tr><th></th><th>before</th><th>after</th></tr></thead><tbody>",
        report.subject().lines().map(|line| format!("<p>{}</p>", escape(line))).collect::<String>()
    );
    for [name, before, after] in report.rows() {
        let _ = write!(
            text,
            "<tr><th>{}</th><td>{}</td><td>{}</td></tr>",
            escape(name.trim()),
            escape(&before),
            escape(&after)
        );
    }
    text + "</tbody></table></div>"
}

/// Writes a table with the statistics of all measures, in pairs of rows before and after a run.
pub(crate) fn statistics(states: [&Measured<'_>; 2]) -> String {
    let [before, after] = states.map(|state| state.statistics(Measure::ALL));
    let mut text = String::from(
        "<div class=\"wide\"><table class=\"pairs\"><thead><tr><th>measure</th><th></th>",
    );
    for column in ["min", "5 %", "median", "mean", "95 %", "max", "sd"] {
        let _ = write!(text, "<th>{column}</th>");
    }
    text += "</tr></thead><tbody>";
    for (before, after) in before.iter().zip(&after) {
        let name = escape(&measure_name(before.measure));
        let source = escape(before.measure.definition().formula);
        let _ = write!(text, "<tr><th rowspan=\"2\" title=\"{source}\">{name}</th>");
        row(&mut text, "before", before);
        text += "<tr>";
        row(&mut text, "after", after);
    }
    text + "</tbody></table></div><p>docs/quality.md of the program defines each measure.</p>"
}

fn row(text: &mut String, state: &str, statistics: &Statistics) {
    let Statistics { min, mean, max, deviation, quantiles: [low, median, high], .. } = statistics;
    let _ = write!(text, "<td class=\"state\">{state}</td>");
    for number in [min, low, median, mean, high, max, deviation] {
        let _ = write!(text, "<td>{}</td>", escape(&fit8(*number)));
    }
    *text += "</tr>";
}

/// Writes the duration of the run's stages as a bar with percentages.
pub(crate) fn time(seconds: &Seconds) -> String {
    let Seconds { read, prepare, smooth, write, total } = *seconds;
    let parts = [("read", read), ("prepare", prepare), ("smooth", smooth), ("write", write)];
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
