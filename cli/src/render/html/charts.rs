//! Charts in SVG, in the colors of the page.

use std::fmt::Write;

use crate::render::html::page::escape;
use crate::terminal::numbers::{counted, fit8, sig6};

/// Width and height of a chart in pixels, before the page scales the chart to the window.
const WIDTH: f64 = 420.0;
const HEIGHT: f64 = 250.0;
/// Space around the plot for numbers and names: left, right, top, bottom.
const MARGIN: [f64; 4] = [58.0, 14.0, 26.0, 36.0];

/// Width of a letter of a label in pixels, estimated from above.
const LETTER: f64 = 7.5;
/// Least width of the part of a chart in which the pointer shows the values of one point, in pixels.
const LEAST_HIT: f64 = 2.0;
/// Largest number of points with dots.
const MOST_DOTS: usize = 60;

/// The quantity along the x axis of a chart of points.
#[derive(Clone, Copy)]
pub(crate) enum Unit {
    /// A number of sweeps or the like; the name is singular.
    Count(&'static str),
    /// A quantity in a unit.
    Measured(&'static str),
}

impl Unit {
    fn name(self) -> &'static str {
        match self {
            Self::Count(name) | Self::Measured(name) => name,
        }
    }

    fn described(self, x: f64) -> String {
        match self {
            Self::Count(name) => format!("{name} {x}"),
            Self::Measured(unit) => format!("{} {unit}", tick(x)),
        }
    }
}

/// A scale of one axis.
struct Axis {
    low: f64,
    high: f64,
    log: bool,
    /// Whether ticks are at integers only.
    counts: bool,
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
        Self { low, high, log, counts: false, from, to }
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
        let is_usable = |step: &f64| *step >= rough && (!self.counts || step.fract() == 0.0);
        let step = [1.0, 2.0, 2.5, 5.0, 10.0].map(|n| n * unit).into_iter().find(is_usable);
        let step = step.unwrap_or(if self.counts { 1.0 } else { rough });
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

/// Draws a tick with a label below the plot. The label of a tick near the end of the chart is moved inside.
fn below(text: &mut String, x: f64, name: &str) {
    let bottom = HEIGHT - MARGIN[3];
    let middle = x.min(WIDTH - 0.5 * LETTER * name.chars().count() as f64);
    let _ = write!(
        text,
        "<line class=\"tick\" x1=\"{x:.1}\" x2=\"{x:.1}\" y1=\"{bottom}\" y2=\"{:.1}\"/><text class=\"number\" text-anchor=\"middle\" x=\"{middle:.1}\" y=\"{:.1}\">{}</text>",
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

/// Draws a part of a chart, over its whole height, in which the pointer shows a text.
fn hit(text: &mut String, [from, to]: [f64; 2], about: &str) {
    let _ = write!(
        text,
        "<rect class=\"hit\" x=\"{from:.1}\" y=\"{}\" width=\"{:.1}\" height=\"{}\"><title>{}</title></rect>",
        MARGIN[2],
        to - from,
        HEIGHT - MARGIN[2] - MARGIN[3],
        escape(about)
    );
}

/// Draws a polyline through points in ascending order of x, with a logarithmic y axis, and a dot at each point if there are
/// few. The pointer shows the values of the nearest point.
pub(crate) fn lines(title: &str, unit: Unit, points: &[[f64; 2]]) -> String {
    let mut text = open(title);
    let [left, right] = x_axis(0.0, WIDTH);
    let (top, bottom) = (MARGIN[2], HEIGHT - MARGIN[3]);
    let is_shown = |[x, y]: &[f64; 2]| x.is_finite() && y.is_finite() && *y > 0.0;
    let points: Vec<[f64; 2]> = points.iter().copied().filter(is_shown).collect();
    if points.len() < 2 {
        let _ = write!(
            text,
            "<text class=\"number\" text-anchor=\"middle\" x=\"{}\" y=\"{}\">too few sweeps to draw</text></svg></figure>",
            (left + right) / 2.0,
            (top + bottom) / 2.0
        );
        return text;
    }
    let mut x = Axis::new(points.iter().map(|point| point[0]), false, left, right);
    x.counts = matches!(unit, Unit::Count(_));
    let y = Axis::new(points.iter().map(|point| point[1]), true, bottom, top);
    y.ticks().into_iter().for_each(|value| across(&mut text, y.place(value), &tick(value)));
    x.ticks().into_iter().for_each(|value| below(&mut text, x.place(value), &tick(value)));
    let _ = write!(
        text,
        "<line class=\"axis\" x1=\"{left}\" x2=\"{right}\" y1=\"{bottom}\" y2=\"{bottom}\"/><text class=\"number\" text-anchor=\"end\" x=\"{right}\" y=\"{:.1}\">{}</text><polyline class=\"line\" points=\"",
        HEIGHT - 4.0,
        escape(unit.name())
    );
    let places: Vec<[f64; 2]> = points.iter().map(|[a, b]| [x.place(*a), y.place(*b)]).collect();
    for [a, b] in &places {
        let _ = write!(text, "{a:.1},{b:.1} ");
    }
    text += "\"/>";
    if points.len() <= MOST_DOTS {
        for [a, b] in &places {
            let _ = write!(text, "<circle class=\"dot\" cx=\"{a:.1}\" cy=\"{b:.1}\" r=\"3\"/>");
        }
    }
    // A span of several points has the values of its first point, and the last span those of the last point.
    let (mut from, mut first) = (left, 0);
    for i in 0..points.len() {
        let to = places.get(i + 1).map_or(right, |next| (places[i][0] + next[0]) / 2.0);
        let is_last = i + 1 == points.len();
        if to - from >= LEAST_HIT || is_last {
            let [a, b] = points[if is_last { i } else { first }];
            hit(&mut text, [from, to], &format!("{}: {}", unit.described(a), sig6(b)));
            (from, first) = (to, i + 1);
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
pub(crate) fn bars(title: &str, noun: &str, edges: &[f64], series: &[Series<'_>]) -> String {
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
        let end = if edges[i + 1].is_finite() { tick(edges[i + 1]) } else { "any".into() };
        let mut about = format!("{} to {end}", tick(edges[i]));
        for (place, Series { class, name, counts }) in series.iter().enumerate() {
            let count = counts.get(i).copied().unwrap_or(0);
            let top = y.place(percent(count));
            let start = left + (i as f64 + 0.08 + bar * place as f64) * width;
            // A nonempty bin is at least 1 pixel high, to remain visible.
            let height = (bottom - top).max(if count > 0 { 1.0 } else { 0.0 });
            let _ = write!(
                text,
                "<rect class=\"{class}\" x=\"{start:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{height:.1}\"/>",
                bottom - height,
                bar * width,
            );
            let name = name.map(|name| format!("{name}: ")).unwrap_or_default();
            let _ = write!(about, "\n{name}{} ({:.1} %)", counted(count, noun), percent(count));
        }
        hit(&mut text, [left + i as f64 * width, left + (i + 1) as f64 * width], &about);
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
        assert!(lines("f", Unit::Measured("s"), &[[0.0, 1.0]]).contains("too few sweeps"));
    }

    /// Sweeps are counted from 0, evenly, at integers.
    #[test]
    fn the_first_of_many_sweeps_is_as_wide_as_the_last() {
        for last in [2.0, 3.0, 12.0, 35.0, 1000.0] {
            let points: Vec<[f64; 2]> = (0..=last as u32).map(|i| [f64::from(i), 2.0]).collect();
            let mut axis = Axis::new(points.iter().map(|p| p[0]), false, 0.0, last);
            axis.counts = true;
            let ticks = axis.ticks();
            assert!(ticks.len() > 2 && ticks[0] == 0.0, "{ticks:?}");
            assert!(ticks.iter().all(|tick| tick.fract() == 0.0), "{ticks:?}");
            assert!((axis.place(1.0) - 1.0).abs() < 1e-9);
            // The values of each of a few points, and of one point for each two pixels.
            let chart = lines("f", Unit::Count("sweep"), &points);
            let hits = chart.matches("class=\"hit\"").count();
            assert!(hits == points.len() || (100..200).contains(&hits), "{hits} of {last}");
            for sweep in [0.0, last] {
                assert!(
                    chart.contains(&format!("<title>sweep {sweep}: 2.000000</title>")),
                    "{last}"
                );
            }
        }
    }
}
