//! Cost of a sweep by mesh size: measures with `gpu-smooth bench`, prints nanoseconds per free vertex, and draws a
//! figure.
//!
//! ```text
//! cargo bench -p gpu-smooth-cli --bench growth -- docs/performance-growth.svg 10000,100000,1000000,10000000
//! ```

#![allow(clippy::print_stdout)]

use std::collections::BTreeMap;
use std::error::Error;
use std::process::{Command, Stdio};

use plotters::prelude::*;
use serde_json::Value;

/// Width and height of the figure, in pixels.
const SIZE: (u32, u32) = (720, 400);
const COLORS: [RGBColor; 4] =
    [RGBColor(0, 90, 181), RGBColor(220, 50, 32), RGBColor(90, 90, 90), RGBColor(230, 159, 0)];

/// Points of a curve: number of vertices, and nanoseconds per free vertex and sweep.
type Curve = Vec<(f64, f64)>;

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).filter(|arg| arg != "--bench").collect();
    let svg = args.iter().find(|arg| arg.ends_with(".svg"));
    let sizes = args.iter().find(|arg| !arg.ends_with(".svg"));
    let sizes = sizes.map_or("10000,100000,1000000", String::as_str);
    let output = Command::new(env!("CARGO_BIN_EXE_gpu-smooth"))
        .args(["bench", "--json", "--vertices", sizes])
        .stderr(Stdio::inherit())
        .output()?;
    let rows: Vec<Value> = serde_json::from_slice(&output.stdout)?;
    let mut curves: BTreeMap<String, Curve> = BTreeMap::new();
    for row in &rows {
        let number = |key: &str| row[key].as_f64().ok_or(format!("no {key} in the measurements"));
        let cost = number("seconds_per_sweep")? / number("free")? * 1e9;
        let engine = row["engine"].as_str().unwrap_or_default().to_owned();
        curves.entry(engine).or_default().push((number("vertices")?, cost));
    }
    for (engine, curve) in &curves {
        println!("{engine}");
        let least = curve.iter().map(|point| point.1).fold(f64::INFINITY, f64::min);
        for (vertices, cost) in curve {
            let ratio = cost / least;
            println!(
                "  {vertices:>9} vertices {cost:>8.2} ns a vertex and sweep, {ratio:.2} of the least"
            );
        }
    }
    if let Some(path) = svg {
        draw(path, &curves)?;
    }
    Ok(())
}

fn draw(path: &str, curves: &BTreeMap<String, Curve>) -> Result<(), Box<dyn Error>> {
    let points = || curves.values().flatten();
    let (least, most) = points().fold((f64::MAX, 0f64), |(l, m), p| (l.min(p.0), m.max(p.0)));
    let highest = points().map(|point| point.1).fold(0.0, f64::max);
    let area = SVGBackend::new(path, SIZE).into_drawing_area();
    area.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&area)
        .margin(16)
        .x_label_area_size(44)
        .y_label_area_size(56)
        .build_cartesian_2d((least * 0.8..most * 1.25).log_scale(), 0.0..highest * 1.15)?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .x_desc("vertices")
        .y_desc("ns a free vertex and sweep")
        .x_label_formatter(&|x| format!("{x:.0}"))
        .label_style(("sans-serif", 14))
        .draw()?;
    for ((engine, curve), color) in curves.iter().zip(COLORS.iter().cycle()) {
        chart
            .draw_series(
                LineSeries::new(curve.iter().copied(), color.stroke_width(2)).point_size(4),
            )?
            .label(engine)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], color.stroke_width(2)));
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::MiddleMiddle)
        .background_style(WHITE)
        .border_style(RGBColor(180, 180, 180))
        .label_font(("sans-serif", 14))
        .draw()?;
    area.present()?;
    Ok(())
}
