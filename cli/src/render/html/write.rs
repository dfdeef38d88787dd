//! `--html`: a run as one page in a single file.

use std::path::Path;
use std::time::Instant;

use gpu_smooth::measure::{Measure, Measured};
use mesh_io::atomic;

use crate::error::CliError;
use crate::render::html::page::{Page, View, escape};
use crate::render::html::tables::{measure_name, noun_of};
use crate::render::html::{charts, mesh, run, tables, worst};
use crate::report::{Done, SmoothJob};
use crate::report::{Histogram, histogram};

/// The measures with a histogram.
const HISTOGRAMS: [Measure; 3] = [Measure::Shape, Measure::MinAngle, Measure::MaxAngle];

/// Writes the page of a run to `path`; does nothing if `path` is `None`. `began` is the time at which the drawing of the
/// run's picture and page began.
pub(crate) fn write(
    path: Option<&Path>,
    task: &SmoothJob<'_>,
    done: &Done<'_>,
    began: Instant,
) -> Result<(), CliError> {
    let Some(path) = path else { return Ok(()) };
    let failed = |error: CliError| error.within("the page was not written");
    let text = page(task, done, began).map_err(failed)?;
    atomic::write(path, text.as_bytes()).map_err(|error| failed(error.into()))
}

fn page(task: &SmoothJob<'_>, done: &Done<'_>, began: Instant) -> Result<String, CliError> {
    let topology = done.smoother.topology();
    let (surface, colors) = (task.request.surface, task.request.outputs.colors);
    let before = Measured::on(surface, &done.file.mesh().points, topology)?;
    let after = Measured::on(surface, &done.outcome.points, topology)?;
    let states = [&before, &after];
    let spots = worst::spots(done.file, states);

    let mut page = Page::new(&task.input.file_name().unwrap_or_default().to_string_lossy());
    page.lead(&done.report.ending());
    if let Some(warning) = done.report.warning() {
        page.lead(&warning);
    }
    let measures = mesh::measures(colors, &[], task.request.profile.as_ref());
    let bounds = &mesh::BOUNDS;
    let viewed = mesh::viewer_mesh(done.file, &states, &spots, &measures, colors, bounds)?;
    page.mesh(&viewed, View::Run);
    page.columns(&[
        &[("Summary", tables::summary(&done.report))],
        &[(&*worst::title(&spots), worst::lists(&spots, done.file.axes()))],
    ]);
    page.section("Distribution", &histograms(states));
    page.section("Convergence", &convergence(done));
    let statistics = tables::statistics(states);
    let seconds = done.report.seconds.with_pictures(began.elapsed());
    page.columns(&[
        &[("Statistics", statistics)],
        &[("Where time went", tables::time(&seconds)), ("The run", run::run(task, done)?)],
    ]);
    Ok(page.finish())
}

/// Draws a histogram for each measure in `HISTOGRAMS`, with paired bars before and after a run.
fn histograms(states: [&Measured<'_>; 2]) -> String {
    let mut text = String::from("<div class=\"charts\">");
    for measure in HISTOGRAMS {
        let [before, after] = states.map(|state| histogram(state, measure));
        let Histogram { edges, counts, .. } = before;
        let series = |name, counts| charts::Series { class: name, name: Some(name), counts };
        let series = [series("before", &counts), series("after", &after.counts)];
        text += &charts::bars(&measure_name(measure), noun_of(measure), &edges, &series);
    }
    text + "</div>"
}

/// Draws f by sweep, f by time, and the distance of f from its smallest value by sweep.
fn convergence(done: &Done<'_>) -> String {
    let f: Vec<f64> = done.report.history.iter().map(|sweep| sweep.f).collect();
    let by_sweep: Vec<[f64; 2]> = f.iter().enumerate().map(|(i, &f)| [i as f64, f]).collect();
    let known = |&(sweep, seconds): &(u32, f64)| Some([seconds, *f.get(sweep as usize)?]);
    let by_time: Vec<[f64; 2]> = [(0, 0.0)].iter().chain(&done.times).filter_map(known).collect();
    let last = f.iter().copied().fold(f64::INFINITY, f64::min);
    let excess = f.iter().enumerate().map(|(i, &f)| [i as f64, f - last]);
    let excess: Vec<[f64; 2]> = excess.filter(|point| point[1] > 0.0).collect();
    let base = escape(done.report.base());
    format!(
        "<div class=\"charts\">{}{}{}</div><p>f is the mean of q² by {base} over all elements. Times are known after \
         batches of sweeps.</p>",
        charts::lines("f against sweep", charts::Unit::Count("sweep"), &by_sweep),
        charts::lines("f against time", charts::Unit::Measured("s"), &by_time),
        charts::lines("f above its least value", charts::Unit::Count("sweep"), &excess),
    )
}
