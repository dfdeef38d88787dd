//! The paper's figures, drawn from the records.

use std::fmt::Write;

use plotters::coord::Shift;
use plotters::prelude::*;

use super::Result;
use super::analysis::{Data, View, base, paper_name};
use super::domains::DOMAINS;
use super::store::{BINS, RunRecord, Sample};
use super::study::{Place, Setting, Size};
use super::tables::setting_name;

/// A figure with its file name in figures/, its caption and its SVG.
pub(crate) struct Figure {
    pub(crate) number: u32,
    pub(crate) caption: String,
    pub(crate) svg: String,
}

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Colors distinguishable to color-blind readers and in gray.
const COLORS: [RGBColor; 3] = [RGBColor(0, 90, 181), RGBColor(220, 50, 32), RGBColor(90, 90, 90)];

/// The meshes whose convergence histories the paper shows.
const SHOWN: [&str; 3] = ["airplane", "fish", "mechanic"];

pub(crate) fn draw_all(data: &Data) -> Result<Vec<Figure>> {
    let histories = [
        (2, ["edge", "imr", "edge+imr"], "EDGE+IMR against EDGE and IMR"),
        (3, ["area", "ar", "area+ar"], "AREA+AR against AREA and AR"),
        (
            6,
            ["edge+imr", "edge+imr+imr", "edge+imr+imr+imr"],
            "EDGE+IMR with more and more frequent IMR",
        ),
    ];
    let mut figures = vec![Figure {
        number: 1,
        caption: "Figure 1: the coarse meshes of the six domains, as triangulated.".into(),
        svg: meshes()?,
    }];
    for (number, schemes, what) in histories {
        let rows: Vec<_> = [Setting::Published, Setting::Analytic]
            .into_iter()
            .map(|setting| data.view(setting, Place::Cpu, 0.95))
            .filter(|&view| data.runs_of(view, SHOWN[1], schemes[0]).next().is_some())
            .collect();
        if !rows.is_empty() {
            let judge = base(schemes[0]).to_uppercase();
            let caption = format!(
                "Figure {number}: {what}: f by {judge} after each sweep against time, the median of \
                 repeated runs on the CPU from the random start. The dashed line is where 95 % of the way is gone."
            );
            figures.push(Figure { number, caption, svg: convergence(data, &rows, &schemes)? });
        }
    }
    let distributions = [
        (4, "mechanic", "edge", ["", "edge", "edge+imr"], "shortest over longest edge"),
        (5, "fish", "mean ratio", ["", "area", "area+ar"], "mean ratio (1 / IMR)"),
    ];
    for (number, domain, quality, schemes, axis) in distributions {
        if let Some(svg) = histograms(data, domain, quality, &schemes, axis)? {
            let caption = format!(
                "Figure {number}: distribution of element quality ({axis}, 0.4 to 1) of the {domain} mesh \
                 before smoothing and where 95 % of the way is gone, as published."
            );
            figures.push(Figure { number, caption, svg });
        }
    }
    figures.sort_by_key(|figure| figure.number);
    Ok(figures)
}

/// Draws Figure 1 without the plotting library, which would write each edge as a separate element.
fn meshes() -> Result<String> {
    const PANEL: f64 = 320.0;
    const MARGIN: f64 = 12.0;
    let step = [PANEL + 2.0 * MARGIN, PANEL + 2.0 * MARGIN + 20.0];
    let (width, height) = (3.0 * step[0], 2.0 * step[1]);
    let mut svg = format!(
        "<svg width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
         xmlns=\"http://www.w3.org/2000/svg\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
    );
    for (i, domain) in DOMAINS.iter().enumerate() {
        let mesh = domain.mesh(Size::Coarse)?;
        let [[left, right], [bottom, top]] = [0, 1]
            .map(|x| super::analysis::range(&mesh.points.iter().map(|p| p[x]).collect::<Vec<_>>()));
        let scale = PANEL / (right - left).max(top - bottom);
        let corner = [(i % 3) as f64 * step[0] + MARGIN, (i / 3) as f64 * step[1] + MARGIN];
        let shift = [PANEL - scale * (right - left), PANEL - scale * (top - bottom)];
        let at = |v: u32| {
            let [x, y] = mesh.points[v as usize];
            [
                corner[0] + shift[0] / 2.0 + scale * (x - left),
                corner[1] + shift[1] / 2.0 + scale * (top - y),
            ]
        };
        svg += "<path fill=\"none\" stroke=\"#24507a\" stroke-width=\"0.6\" d=\"";
        for [a, b] in support::edge_uses(&mesh).into_keys() {
            let ([ax, ay], [bx, by]) = (at(a), at(b));
            let _ = write!(svg, "M{ax:.1} {ay:.1}L{bx:.1} {by:.1}");
        }
        let _ = writeln!(
            svg,
            "\"/>\n<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\" font-family=\"sans-serif\" \
             font-size=\"15\">{} ({} vertices)</text>",
            corner[0] + PANEL / 2.0,
            corner[1] + PANEL + 22.0,
            domain.name,
            mesh.points.len()
        );
    }
    Ok(svg + "</svg>\n")
}

/// Returns f by the metric `judge` at each time of a run. If the base metric is another one, f comes from the
/// additional evaluation in the record.
fn judged(run: &RunRecord, judge: &str) -> Vec<(f64, f64)> {
    let f = |sample: &Sample| match judge {
        _ if base(&run.case.scheme) == judge => Some(sample.f),
        "edge" => sample.edge,
        "area" => sample.area,
        _ => None,
    };
    run.history.iter().filter_map(|sample| Some((sample.seconds, f(sample)?))).collect()
}

/// Draws Figure 2, 3 or 6, with a row of panels for each view and a panel for each mesh.
fn convergence(data: &Data, rows: &[View], schemes: &[&str; 3]) -> Result<String> {
    let mut svg = String::new();
    {
        let size = (1260, 400 * rows.len() as u32);
        let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        root.fill(&WHITE)?;
        let panels = root.split_evenly((rows.len(), SHOWN.len()));
        for (i, panel) in panels.iter().enumerate() {
            let (view, domain) = (rows[i / SHOWN.len()], SHOWN[i % SHOWN.len()]);
            panel_of_histories(data, view, domain, schemes, panel)?;
        }
        root.present()?;
    }
    Ok(svg)
}

fn panel_of_histories(
    data: &Data,
    view: View,
    domain: &str,
    schemes: &[&str; 3],
    panel: &Area<'_>,
) -> Result<()> {
    let judge = base(schemes[0]);
    let curves: Vec<_> = schemes
        .iter()
        .filter_map(|scheme| Some((scheme, data.typical(view, domain, scheme)?)))
        .collect();
    let Some((_, first)) = curves.first() else { return Ok(()) };
    let target = first.history[0].f - view.fraction * (first.history[0].f - first.desired);
    let points: Vec<_> = curves.iter().flat_map(|(_, run)| judged(run, judge)).collect();
    // As in the paper's enlarged plots, the time axis ends shortly after the slowest scheme has passed.
    let end = |run: &RunRecord| {
        let passed = run.reach(view.fraction).seconds();
        passed.map_or(run.history.last().map_or(0.0, |s| s.seconds), |seconds| 1.25 * seconds)
    };
    let slowest = curves.iter().filter(|(s, _)| base(s) == judge);
    let end = slowest.map(|(_, run)| end(run)).fold(1e-6, f64::max);
    let values: Vec<_> = points.iter().filter(|(t, _)| *t <= end).map(|(_, f)| *f).collect();
    let [low, high] = super::analysis::range(&values);
    let low = low.min(target);
    let room = 0.05 * (high - low);
    let title = format!("{domain}, {}", setting_name(view.setting));
    let mut chart = ChartBuilder::on(panel)
        .caption(title, ("sans-serif", 17))
        .margin(12)
        .x_label_area_size(42)
        .y_label_area_size(66)
        .build_cartesian_2d(0.0..end, low - room..high + room)?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .x_desc("time (s)")
        .y_desc(format!("f by {}", judge.to_uppercase()))
        .x_labels(6)
        .y_labels(8)
        .x_label_formatter(&|x| short(*x))
        .y_label_formatter(&|y| short(*y))
        .label_style(("sans-serif", 14))
        .axis_desc_style(("sans-serif", 15))
        .draw()?;
    let dashes = DashedLineSeries::new([(0.0, target), (end, target)], 6, 5, BLACK.into());
    chart.draw_series(dashes)?;
    for ((scheme, run), color) in curves.iter().zip(COLORS) {
        let points: Vec<_> =
            judged(run, judge).into_iter().filter(|(seconds, _)| *seconds <= end).collect();
        chart
            .draw_series(LineSeries::new(points.iter().copied(), color.stroke_width(2)))?
            // The library underestimates the width of text in most fonts; blanks compensate.
            .label(paper_name(scheme) + "\u{a0}\u{a0}\u{a0}\u{a0}")
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], color.stroke_width(2)));
        chart.draw_series(points.iter().map(|&at| Circle::new(at, 3, color.filled())))?;
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperRight)
        .background_style(WHITE.mix(0.85))
        .border_style(RGBColor(180, 180, 180))
        .label_font(("sans-serif", 14))
        .draw()?;
    Ok(())
}

/// Formats a number with the fewest digits that distinguish the labels of an axis.
fn short(x: f64) -> String {
    match x.abs() {
        0.0 => "0".into(),
        size => {
            let digits = (1 - size.log10().floor() as i32).clamp(0, 6) as usize;
            let text = format!("{x:.digits$}");
            if text.contains('.') {
                text.trim_end_matches('0').trim_end_matches('.').into()
            } else {
                text
            }
        }
    }
}

/// Draws Figure 4 or 5, with a histogram for each scheme. An empty scheme denotes the mesh before smoothing.
fn histograms(
    data: &Data,
    domain: &str,
    quality: &str,
    schemes: &[&str; 3],
    axis: &str,
) -> Result<Option<String>> {
    let find = |scheme: &&str| {
        data.distributions
            .iter()
            .find(|d| d.domain == domain && d.quality == quality && d.scheme == **scheme)
    };
    let found: Vec<_> = schemes.iter().filter_map(find).collect();
    if found.len() < schemes.len() {
        return Ok(None);
    }
    // Each bar covers two bins. Bars start at 0.4.
    let bars = |counts: &[usize]| -> Vec<(f64, f64)> {
        let total: usize = counts.iter().sum();
        (BINS * 2 / 5..BINS)
            .step_by(2)
            .map(|i| {
                let share = 100.0 * (counts[i] + counts[i + 1]) as f64 / total as f64;
                (i as f64 / BINS as f64, share)
            })
            .collect()
    };
    let all: Vec<_> = found.iter().map(|d| bars(&d.counts)).collect();
    let highest = all.iter().flatten().map(|(_, share)| *share).fold(0.0, f64::max);
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, (1260, 380)).into_drawing_area();
        root.fill(&WHITE)?;
        for ((panel, bars), record) in root.split_evenly((1, 3)).iter().zip(&all).zip(&found) {
            let name = match record.scheme.as_str() {
                "" => "before".to_owned(),
                scheme => paper_name(scheme),
            };
            let below = record.counts[..BINS * 2 / 5].iter().sum::<usize>() as f64;
            let below = 100.0 * below / record.counts.iter().sum::<usize>() as f64;
            let mut chart = ChartBuilder::on(panel)
                .caption(format!("{name} ({below:.1} % below 0.4)"), ("sans-serif", 17))
                .margin(12)
                .x_label_area_size(42)
                .y_label_area_size(56)
                .build_cartesian_2d(0.4..1.0, 0.0..1.05 * highest)?;
            chart
                .configure_mesh()
                .light_line_style(TRANSPARENT)
                .disable_x_mesh()
                .x_desc(axis)
                .y_desc("elements (%)")
                .x_labels(7)
                .y_labels(6)
                .x_label_formatter(&|x| format!("{x:.1}"))
                .y_label_formatter(&|y| short(*y))
                .label_style(("sans-serif", 14))
                .axis_desc_style(("sans-serif", 15))
                .draw()?;
            chart.draw_series(bars.iter().map(|&(x, share)| {
                Rectangle::new([(x + 0.001, 0.0), (x + 0.019, share)], COLORS[0].filled())
            }))?;
        }
        root.present()?;
    }
    Ok(Some(svg))
}
