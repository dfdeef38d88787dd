//! Charts in SVG, in the colors of the page.

use std::fmt::Write;

use crate::render::html::page::escape;
use crate::terminal::numbers::fit8;

/// Width and height of a chart in pixels, before the page scales the chart to the window.
const WIDTH: f64 = 420.0;
const HEIGHT: f64 = 250.0;
/// Space around the plot for numbers and names: left, right, top, bottom.
const MARGIN: [f64; 4] = [58.0, 14.0, 26.0, 36.0];

/// A scale of one axis.
struct Axis {
    low: f64,
    high: f64,
    log: bool,
    /// Pixel coordinates of `low` and `high`.
    from: f64,
    to: f64,
}

impl Axis {
    /// Makes an axis that covers the finite numbers. A logarithmic axis ignores numbers up to 0.
    fn new(numbers: impl Iterator<Item = f64>, log: bool, from: f64, to: f64) -> Self {
        let usable = numbers.filter(|x| x.is_finite() && (!log || *x > 0.0));
        let (mut low, mut high) = usable
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        if low > high {
            (low, high) = (1.0, 2.0);
        }
        if high - low <= 1e-9 * high.abs() {
            let half = if low == 0.0 { 1.0 } else { 0.05 * low.abs() };
            (low, high) = (low - half, high + half);
        }
        Self { low, high, log, from, to }
    }

    fn place(&self, x: f64) -> f64 {
        let scale = |x: f64| if self.log { x.ln() } else { x };
        let share = (scale(x) - scale(self.low)) / (scale(self.high) - scale(self.low));
        self.from + share * (self.to - self.from)
    }

    /// Returns round numbers on the axis. A linear or short logarithmic axis has even steps, a longer one multiples of
    /// powers of ten by 1, 2 and 5, and one over more than three decades powers of ten.
    fn ticks(&self) -> Vec<f64> {
        if self.log && (6.0..1500.0).contains(&(self.high / self.low)) {
            let (first, last) = (self.low.log10().floor() as i32, self.high.log10().ceil() as i32);
            let multiples = |power: i32| [1.0, 2.0, 5.0].map(|n| n * 10f64.powi(power));
            let on_axis = |x: &f64| (self.low..=self.high).contains(x);
            return (first..=last).flat_map(multiples).filter(on_axis).collect();
        }
        if self.log && self.high / self.low >= 1500.0 {
            let (first, last) = (self.low.log10().ceil() as i32, self.high.log10().floor() as i32);
            let step = ((last - first) / 5).max(1);
            let powers = (first..=last).filter(|power| (power - first) % step == 0);
            return powers.map(|power| 10f64.powi(power)).collect();
        }
        let rough = (self.high - self.low) / 4.0;
        let unit = 10f64.powf(rough.log10().floor());
        let step = [1.0, 2.0, 2.5, 5.0, 10.0].map(|n| n * unit).into_iter().find(|s| *s >= rough);
        let step = step.unwrap_or(rough);
        let first = (self.low / step - 1e-9).ceil() as i64;
        let ticks = (first..).map(|i| i as f64 * step);
        ticks.take_while(|x| *x <= self.high + 1e-9 * step).take(12).collect()
    }
}

fn open(title: &str) -> String {
    format!(
        "<figure><svg viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" aria-label=\"{0}\"><text class=\"title\" x=\"{1}\" y=\"15\">{0}</text>",
        escape(title),
        MARGIN[0]
    )
}

fn x_axis(from: f64, to: f64) -> [f64; 2] {
    [from + MARGIN[0], to - MARGIN[1]]
}

/// Draws a tick with a label below the plot.
fn below(text: &mut String, x: f64, name: &str) {
    let bottom = HEIGHT - MARGIN[3];
    let _ = write!(
        text,
        "<line class=\"tick\" x1=\"{x:.1}\" x2=\"{x:.1}\" y1=\"{bottom}\" y2=\"{:.1}\"/><text class=\"number\" text-anchor=\"middle\" x=\"{x:.1}\" y=\"{:.1}\">{}</text>",
        bottom + 4.0,
        bottom + 16.0,
        escape(name)
    );
}

/// Draws a grid line across the plot, with a label on the left.
fn across(text: &mut String, y: f64, name: &str) {
    let [left, right] = x_axis(0.0, WIDTH);
    let _ = write!(
        text,
        "<line class=\"grid\" x1=\"{left}\" x2=\"{right}\" y1=\"{y:.1}\" y2=\"{y:.1}\"/><text class=\"number\" text-anchor=\"end\" x=\"{:.1}\" y=\"{:.1}\">{}</text>",
        left - 6.0,
        y + 4.0,
        escape(name)
    );
}

/// Formats the number at a tick.
fn tick(x: f64) -> String {
    let text = match x.abs() {
        a if a != 0.0 && !(1e-3..1e5).contains(&a) => return format!("{x:e}"),
        _ => fit8(x),
    };
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

/// Draws a polyline through points, with a mark at each point if there are at most 60. `log` selects a logarithmic x
/// and y axis.
///
/// A logarithmic axis cannot show `x` = 0, so that point is drawn at half the smallest positive `x`.
pub(crate) fn lines(title: &str, unit: &str, points: &[[f64; 2]], log: [bool; 2]) -> String {
    let least =
        points.iter().map(|point| point[0]).filter(|x| *x > 0.0).fold(f64::INFINITY, f64::min);
    let zero = if log[0] { least / 2.0 } else { 0.0 };
    let points: Vec<[f64; 2]> =
        points.iter().map(|&[x, y]| [if x == 0.0 { zero } else { x }, y]).collect();
    let mut text = open(title);
    let [left, right] = x_axis(0.0, WIDTH);
    let (top, bottom) = (MARGIN[2], HEIGHT - MARGIN[3]);
    let shown = || points.iter().filter(|[x, y]| x.is_finite() && y.is_finite());
    if shown().count() < 2 {
        let _ = write!(
            text,
            "<text class=\"number\" text-anchor=\"middle\" x=\"{}\" y=\"{}\">too few sweeps to draw</text></svg></figure>",
            (left + right) / 2.0,
            (top + bottom) / 2.0
        );
        return text;
    }
    let x = Axis::new(shown().map(|point| point[0]), log[0], left, right);
    let y = Axis::new(shown().map(|point| point[1]), log[1], bottom, top);
    y.ticks().into_iter().for_each(|value| across(&mut text, y.place(value), &tick(value)));
    // The state before the first sweep has `x` = 0.
    let has_zero = log[0] && x.low == zero;
    if has_zero {
        below(&mut text, x.place(zero), "0");
    }
    let is_apart = |&value: &f64| !has_zero || value >= 0.9 * least;
    let ticks = x.ticks().into_iter().filter(is_apart);
    ticks.for_each(|value| below(&mut text, x.place(value), &tick(value)));
    let _ = write!(
        text,
        "<line class=\"axis\" x1=\"{left}\" x2=\"{right}\" y1=\"{bottom}\" y2=\"{bottom}\"/><text class=\"number\" text-anchor=\"end\" x=\"{right}\" y=\"{:.1}\">{}</text><polyline class=\"line\" points=\"",
        HEIGHT - 4.0,
        escape(unit)
    );
    for [a, b] in shown() {
        let _ = write!(text, "{:.1},{:.1} ", x.place(*a), y.place(*b));
    }
    text += "\"/>";
    if points.len() <= 60 {
        for [a, b] in shown() {
            let _ = write!(
                text,
                "<circle class=\"dot\" cx=\"{:.1}\" cy=\"{:.1}\" r=\"3\"><title>{unit} {}: {b}</title></circle>",
                x.place(*a),
                y.place(*b),
                tick(if *a == zero { 0.0 } else { *a })
            );
        }
    }
    text + "</svg></figure>"
}

/// Numbers of triangles by bins, drawn as bars of one color.
pub(crate) struct Series<'a> {
    /// Class of the bars in the style of the page.
    pub(crate) class: &'static str,
    /// Name in the legend; `None` for a chart without a legend.
    pub(crate) name: Option<&'static str>,
    pub(crate) counts: &'a [usize],
}

/// Draws a bar for each bin of each series: the percentage of triangles. The series have equal numbers of bins and of
/// triangles.
pub(crate) fn bars(title: &str, edges: &[f64], series: &[Series<'_>]) -> String {
    let mut text = open(title);
    let [left, right] = x_axis(0.0, WIDTH);
    let bottom = HEIGHT - MARGIN[3];
    let bins = edges.len().saturating_sub(1);
    let total =
        series.first().map_or(0, |series| series.counts.iter().sum::<usize>()).max(1) as f64;
    let percent = |count: usize| 100.0 * count as f64 / total;
    let most = series.iter().flat_map(|series| series.counts).copied().max().unwrap_or(0);
    let y = Axis::new([0.0, percent(most).max(1.0)].into_iter(), false, bottom, MARGIN[2] + 8.0);
    for value in y.ticks() {
        across(&mut text, y.place(value), &format!("{} %", tick(value)));
    }
    let width = (right - left) / bins.max(1) as f64;
    // The bars of a bin fill 84 % of its width.
    let bar = 0.84 / series.len().max(1) as f64;
    for i in 0..bins {
        for (place, Series { class, name, counts }) in series.iter().enumerate() {
            let count = counts.get(i).copied().unwrap_or(0);
            let top = y.place(percent(count));
            let start = left + (i as f64 + 0.08 + bar * place as f64) * width;
            // A nonempty bin is at least 1 pixel high, to remain visible.
            let height = (bottom - top).max(if count > 0 { 1.0 } else { 0.0 });
            let name = name.map(|name| format!(" {name}")).unwrap_or_default();
            let _ = write!(
                text,
                "<rect class=\"{class}\" x=\"{start:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{height:.1}\"><title>{} to {}: {count} triangles{name}</title></rect>",
                bottom - height,
                bar * width,
                tick(edges[i]),
                if edges[i + 1].is_finite() { tick(edges[i + 1]) } else { "any".into() }
            );
        }
    }
    let _ = write!(
        text,
        "<line class=\"axis\" x1=\"{left}\" x2=\"{right}\" y1=\"{bottom}\" y2=\"{bottom}\"/>"
    );
    let every = edges.len().div_ceil(8);
    for (i, edge) in edges.iter().enumerate().filter(|(i, edge)| i % every == 0 && edge.is_finite())
    {
        below(&mut text, left + i as f64 * width, &tick(*edge));
    }
    text += &legend(series, right);
    text + "</svg></figure>"
}

/// Draws the legend of the named series, which ends at `right`.
fn legend(series: &[Series<'_>], right: f64) -> String {
    let mut text = String::from("<g class=\"legend\">");
    for (place, Series { class, name, .. }) in series.iter().rev().enumerate() {
        let Some(name) = name else { continue };
        let left = right - 48.0 - 64.0 * place as f64;
        let _ = write!(
            text,
            "<rect class=\"{class}\" x=\"{left}\" y=\"6\" width=\"10\" height=\"10\"/><text class=\"number\" x=\"{}\" y=\"15\">{name}</text>",
            left + 14.0
        );
    }
    text + "</g>"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_have_a_few_round_numbers() {
        let cases: [(f64, f64, bool, &[&str]); 6] = [
            (1.0, 10000.0, true, &["1", "10", "100", "1000", "10000"]),
            (1.08, 217.0, true, &["2", "5", "10", "20", "50", "100", "200"]),
            (1.0, 12.0, true, &["1", "2", "5", "10"]),
            (1.0862, 1.4, true, &["1.1", "1.2", "1.3", "1.4"]),
            (0.0, 100.0, false, &["0", "25", "50", "75", "100"]),
            (1e-9, 1e2, true, &["1e-9", "1e-7", "1e-5", "0.001", "0.1", "10"]),
        ];
        for (low, high, log, expected) in cases {
            let axis = Axis::new([low, high].into_iter(), log, 0.0, 100.0);
            let ticks: Vec<String> = axis.ticks().into_iter().map(tick).collect();
            assert_eq!(ticks, expected, "{low} to {high}");
            assert_eq!((axis.place(low), axis.place(high)), (0.0, 100.0));
        }
        // An axis for a single value has ticks too.
        let axis = Axis::new([3.0].into_iter(), true, 0.0, 100.0);
        assert!((40.0..60.0).contains(&axis.place(3.0)) && !axis.ticks().is_empty());
    }

    #[test]
    fn a_run_without_sweeps_has_a_chart() {
        assert!(lines("f", "s", &[[0.0, 1.0]], [true; 2]).contains("too few sweeps"));
    }
}
