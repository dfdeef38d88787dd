//! Histograms in the terminal.

use std::fmt::Write;
use std::io::IsTerminal;

use crate::render::columns;
use crate::report::Histogram;
use crate::terminal::numbers::fit8;

/// Drawing style for the terminal.
pub(crate) struct Style {
    /// Whether output is restricted to ASCII, including signs such as the degree sign.
    pub(crate) plain: bool,
    /// Whether bars consist of block characters instead of `#`.
    blocks: bool,
    /// Width of the output in columns.
    pub(crate) width: usize,
}

impl Style {
    /// Chooses the style from the type of standard output and the environment. `ascii` requests ASCII only.
    pub(crate) fn of_terminal(ascii: bool) -> Self {
        let is_terminal = std::io::stdout().is_terminal();
        let plain = ascii || is_terminal && !shows_unicode();
        let width = columns::of_terminal().unwrap_or(80);
        Self { plain, blocks: is_terminal && !plain, width: width.clamp(40, 160) }
    }
}

/// Returns whether the terminal probably displays Unicode: its type is not `dumb`, and the locale is UTF-8
/// or unset.
fn shows_unicode() -> bool {
    let set = |name| std::env::var(name).ok().filter(|value| !value.is_empty());
    if set("TERM").is_some_and(|term| term == "dumb") {
        return false;
    }
    let locale = ["LC_ALL", "LC_CTYPE", "LANG"].into_iter().find_map(set);
    locale.is_none_or(|locale| locale.to_lowercase().contains("utf"))
}

/// Draws a histogram with one line per bin, from the first to the last nonempty bin.
pub(crate) fn text(histogram: &Histogram, name: &str, style: &Style) -> String {
    let Histogram { edges, counts, .. } = histogram;
    let total: usize = counts.iter().sum();
    let most = counts.iter().copied().max().unwrap_or(0).max(1);
    let mut text = format!("{name}\n");
    let (Some(first), Some(last)) =
        (counts.iter().position(|&n| n > 0), counts.iter().rposition(|&n| n > 0))
    else {
        return text;
    };
    let digits = most.to_string().len().max(5);
    let room = style.width.saturating_sub(2 + 7 + 1 + 10 + 2 + digits + 2 + 6 + 2);
    for (i, &count) in counts.iter().enumerate().take(last + 1).skip(first) {
        let to = match edges[i + 1] {
            to if to.is_finite() => format!("to {:<7}", edge(to)),
            _ => format!("{:<10}", "and above"),
        };
        let share = percent(count as f64 / total as f64);
        let bar = bar(count as f64 / most as f64 * room as f64, style.blocks);
        let from = edge(edges[i]);
        let line = format!("  {from:>7} {to}  {count:>digits$}  {share:>6}  {bar}");
        let _ = writeln!(text, "{}", line.trim_end());
    }
    text
}

/// Formats an edge of a bin without trailing zeros.
fn edge(x: f64) -> String {
    let text = fit8(x);
    match text.contains('.') && !text.contains('e') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

fn percent(share: f64) -> String {
    match 100.0 * share {
        p if p > 0.0 && p < 0.05 => "<0.1 %".into(),
        p if p > 99.95 && p < 100.0 => ">99.9%".into(),
        p => format!("{p:.1} %"),
    }
}

/// Draws a bar with a length of `columns` columns. Block characters resolve an eighth of a column. A
/// positive length always draws a mark.
fn bar(columns: f64, blocks: bool) -> String {
    if !blocks {
        let whole = "#".repeat(columns.round() as usize);
        return if whole.is_empty() && columns > 0.0 { ".".into() } else { whole };
    }
    const EIGHTHS: [&str; 8] = ["", "▏", "▎", "▍", "▌", "▋", "▊", "▉"];
    let eighths = (8.0 * columns).round().max(if columns > 0.0 { 1.0 } else { 0.0 }) as usize;
    format!("{}{}", "█".repeat(eighths / 8), EIGHTHS[eighths % 8])
}

#[cfg(test)]
mod tests {
    use super::*;
    use gpu_smooth::measure::Measure;

    fn drawn(counts: &[usize], style: &Style) -> String {
        let edges = vec![1.0, 1.05, 2.0, 100.0, f64::INFINITY];
        let histogram = Histogram { measure: Measure::Condition, edges, counts: counts.to_vec() };
        text(&histogram, "condition", style)
    }

    #[test]
    fn bars_fill_the_width_and_show_every_triangle() {
        for (blocks, width) in [(true, 80), (false, 80), (true, 47), (false, 160)] {
            let text = drawn(&[0, 2000, 1, 0], &Style { plain: !blocks, blocks, width });
            let lines: Vec<&str> = text.lines().collect();
            assert_eq!(lines.len(), 3, "{text}");
            assert_eq!(lines[1].chars().count(), width, "{text}");
            assert!(lines[1].ends_with(if blocks { '█' } else { '#' }), "{text}");
            assert!(lines[2].ends_with(if blocks { '▏' } else { '.' }), "{text}");
            assert_eq!(text.is_ascii(), !blocks);
        }
    }

    #[test]
    fn the_last_bin_has_no_end() {
        let text = drawn(&[1, 1, 1, 1], &Style { plain: true, blocks: false, width: 80 });
        assert!(text.contains("\n        1 to 1.05 "), "{text}");
        assert!(text.contains("\n      100 and above "), "{text}");
        assert!(text.contains("  25.0 %  ###"), "{text}");
        assert_eq!(drawn(&[0; 4], &Style { plain: true, blocks: false, width: 80 }), "condition\n");
    }
}
