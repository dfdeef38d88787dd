//! The report: settings of the study, verdicts, tables and figures.

use std::fs;
use std::path::Path;

use super::Result;
use super::analysis::{Data, View};
use super::document::{Block, html, markdown};
use super::export::FRACTIONS;
use super::figures::Figure;
use super::progress::clock;
use super::store::Header;
use super::study::{Place, SCHEMES, Setting, Size, Start};
use super::tables::{seconds, setting_name, share, sizes, stricter, sweeps};
use super::{claims, doubts};

const TITLE: &str = "Park and Shontz (2011), run again";

/// Schemes of Tables 3 and 5 by base metric; `FREQUENT` contains the schemes from the text.
const EDGE: [&str; 3] = ["edge", "edge+imr", "edge+ar"];
const RMS: [&str; 3] = ["rms", "rms+imr", "rms+ar"];
const AREA: [&str; 3] = ["area", "area+imr", "area+ar"];
const FREQUENT: [&str; 4] = ["edge", "edge+imr", "edge+imr+imr", "edge+imr+imr+imr"];

/// Writes report.md, report.html and the figures.
pub(crate) fn write(data: &Data, figures: &[Figure], folder: &Path) -> Result<()> {
    let pictures = folder.join("figures");
    fs::create_dir_all(&pictures)?;
    for figure in figures {
        fs::write(pictures.join(file(figure)), &figure.svg)?;
    }
    let blocks = blocks(data, figures);
    fs::write(folder.join("report.md"), markdown(&blocks))?;
    fs::write(folder.join("report.html"), html(TITLE, &blocks))?;
    Ok(())
}

fn file(figure: &Figure) -> String {
    format!("figure-{}.svg", figure.number)
}

fn blocks(data: &Data, figures: &[Figure]) -> Vec<Block> {
    let claims = claims::claims(data);
    let figure = |number| {
        figures.iter().filter(move |f| f.number == number).map(|f| Block::Figure {
            file: file(f),
            svg: f.svg.clone(),
            caption: f.caption.clone(),
        })
    };
    let heading = |text: &str| Block::Heading(2, text.into());
    let mut blocks = vec![Block::Heading(1, TITLE.into())];
    blocks.extend(introduction(data));

    blocks.push(heading("Verdicts"));
    blocks.push(Block::Table(claims::table(data, &claims)));

    blocks.push(heading("How it was run"));
    blocks.push(Block::List(readings(data)));

    blocks.push(heading("Meshes"));
    blocks.push(Block::Table(sizes(data, data.header.study.size)));
    blocks.extend(figure(1));

    blocks.push(heading("Time to convergence"));
    for place in data.places() {
        for setting in [Setting::Published, Setting::Analytic] {
            let view = data.view(setting, place, FRACTIONS[0]);
            if !data.domains(view).is_empty() {
                blocks.extend(times(data, view));
            }
        }
        if place == Place::Cpu {
            for number in [2, 3, 6] {
                blocks.extend(figure(number));
            }
        }
    }

    blocks.push(heading("Stricter than 95 %"));
    blocks.push(Block::Text(
        "Strongly perturbed, a mesh is still poor where 95 % of the way is gone: that is where most of the \
         way is the unmaking of a few slivers. Medians over the meshes; a time \"of base\" below 100 % is what \
         alternating saves."
            .into(),
    ));
    for place in data.places() {
        for setting in [Setting::Published, Setting::Plain, Setting::Analytic] {
            blocks.extend(strict_table(data, setting, place, Start::Random));
        }
    }
    blocks.push(heading("From a smooth distortion"));
    blocks.push(Block::Text(
        "Where no element is bad but the whole interior is shifted, many sweeps are needed.".into(),
    ));
    for place in data.places() {
        blocks.extend(strict_table(data, Setting::Analytic, place, Start::Smooth));
    }

    blocks.push(heading("Distribution of quality"));
    blocks.extend(figure(4));
    blocks.extend(figure(5));

    blocks.push(heading("Where the paper does not agree with itself"));
    blocks.push(Block::List(doubts::doubts()));

    blocks.push(heading("Every measure"));
    blocks.push(Block::Table(claims::all(&claims)));
    blocks.push(Block::Text(
        "Data: `data/runs.csv` (a row a run), `data/history.csv` (a row a sweep), `data/desired.csv`, \
         `data/meshes.csv`, `data/distribution.csv`, and all of it in `data/study.json`."
            .into(),
    ));
    blocks
}

fn introduction(data: &Data) -> Vec<Block> {
    let Header { study, version, cores, processor, adapter } = &data.header;
    let wall: f64 = data.runs.iter().map(|run| run.wall_seconds).sum();
    let adapter = adapter.as_deref().unwrap_or("none");
    let mut blocks = vec![Block::Text(format!(
        "The experiments of J. Park and S. M. Shontz, *An Alternating Mesh Quality Metric Scheme for Efficient \
         Mesh Quality Improvement* (Procedia Computer Science 4, 2011, 292–301), run by gpu-smooth {version}: {} \
         runs in {}. CPU: {processor}, {cores} cores. GPU: {adapter}.",
        data.runs.len(),
        clock(wall)
    ))];
    if study.size == Size::Coarse {
        blocks.push(Block::Text(format!(
            "**This is the {} study, on coarse meshes.** Its times are short and part of them is overhead; the \
             full study has the paper's sizes.",
            study.mode
        )));
    }
    blocks
}

/// Lists points that the paper leaves open, with the choices made here.
fn readings(data: &Data) -> Vec<String> {
    let mut list = vec![
        "Objective: f = (1/n) Σ q²; a run has passed a share s of the way once f_initial − f > s (f_initial − \
         f_desired), f by the first metric of its scheme, and 95 % is the paper's s. A sweep visits every \
         interior vertex once; the paper calls it an iteration."
            .to_owned(),
        "f_desired: the best f of over-relaxed sweeps by the metric alone, from the mesh as triangulated and \
         from the randomly perturbed one; each is in `data/desired.csv` with how it was found. EDGE's is that of \
         the p-norm all its sweeps use; with an exponent that doubles up to 512 it would be lower, out of these \
         runs' reach."
            .to_owned(),
        "Time: of the sweeps and the evaluations of f after each, nothing else; the median of the repeated runs. \
         Sweeps are the same in each."
            .to_owned(),
        "**As published**: EDGE, RMS and AREA by forward differences with 16 evaluations an element, the cost of \
         Mesquite's, IMR and AR with analytic derivatives; several Newton steps a visit; no over-relaxation. \
         Visits with analytic derivatives end once a step is shorter than 10⁻⁴ of an edge. By differences they \
         go on to the cap, as a later Mesquite was seen to do with a cap near 100: **the ratio of EDGE's and \
         IMR's times is in that sense put in, not found**. EDGE's Newton steps are on a smooth p-norm (exponent \
         16), as raw EDGE jams."
            .to_owned(),
        "**Analytic, plain**: analytic derivatives, one Newton step a visit, no over-relaxation. **Analytic**: this \
         program's defaults: the same, but over-relaxed after four sweeps where one metric runs alone."
            .to_owned(),
        "Random start: each interior vertex moved toward a random place of its star, nothing inverted (seed 1). \
         Smooth start: a few long waves, up to 95 % of what flattens the first triangle."
            .to_owned(),
        "On a GPU each sweep is submitted and read back by itself, to be timed; this program otherwise submits \
         many at once. Kernels are compiled before."
            .to_owned(),
    ];
    for batch in &data.header.study.batches {
        list.push(format!(
            "Runs {}, {} meshes of {} size, {} start: to {} of the way or {} sweeps, at most {} Newton \
             step{} a visit; repeated {} × on the CPU, {} × on the GPU.",
            setting_name(batch.setting),
            batch.domains.len(),
            batch.size,
            batch.start,
            share(batch.fraction),
            batch.max_sweeps,
            batch.inner,
            if batch.inner == 1 { "" } else { "s" },
            batch.cpu_repeats,
            batch.gpu_repeats
        ));
    }
    list
}

/// Returns the blocks for a view: Tables 3, 4 and 5, and the schemes from the text.
fn times(data: &Data, view: View) -> Vec<Block> {
    let place = view.place.to_string().to_uppercase();
    let what = format!("{}, {place}, {}", setting_name(view.setting), share(view.fraction));
    let caption = |table: &str| format!("{table} ({what})");
    let table =
        |name: &str, schemes: &[&str]| Block::Table(seconds(data, view, &caption(name), schemes));
    let counts =
        |name: &str, schemes: &[&str]| Block::Table(sweeps(data, view, &caption(name), schemes));
    let mut title = what.clone();
    title[..1].make_ascii_uppercase();
    vec![
        Block::Heading(3, title),
        table("Table 3, EDGE: time to convergence", &EDGE),
        table("Table 3, RMS: time to convergence", &RMS),
        table("Table 4, AREA: time to convergence", &AREA),
        table("Section 3: more frequent IMR", &FREQUENT),
        counts("Table 5 (a), EDGE: sweeps and time per sweep", &EDGE),
        counts("Table 5 (b), RMS: sweeps and time per sweep", &RMS),
        counts("Table 5 (c), AREA: sweeps and time per sweep", &AREA),
    ]
}

fn strict_table(data: &Data, setting: Setting, place: Place, start: Start) -> Option<Block> {
    let views: Vec<_> = FRACTIONS
        .iter()
        .map(|&fraction| View { start, ..data.view_reaching(setting, place, fraction) })
        .filter(|&view| !data.domains(view).is_empty())
        .collect();
    let sizes: Vec<_> = views.iter().map(|v| v.size.to_string()).collect();
    let (first, last) = (sizes.first()?, sizes.last()?);
    let size = if first == last { first.clone() } else { format!("{first}; from 99 % on {last}") };
    let caption = format!(
        "{}, {start} start, {}, {size} meshes",
        setting_name(setting),
        place.to_string().to_uppercase()
    );
    Some(Block::Table(stricter(data, &views, &caption, &SCHEMES)))
}
