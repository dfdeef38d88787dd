//! Export of the data for other programs: a CSV file for each type of record, and one JSON file with
//! all records.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use super::analysis::{Data, Reach};
use super::store::{BINS, Record};
use super::{Result, store};

/// Fractions of the way to the desired f that tables show: the paper's 95 %, and two stricter
/// fractions.
pub(crate) const FRACTIONS: [f64; 3] = [0.95, 0.99, 0.999];

pub(crate) fn write(data: &Data, folder: &Path) -> Result<()> {
    let put = |name: &str, text: String| fs::write(folder.join(name), text);
    put("runs.csv", runs(data))?;
    put("history.csv", history(data))?;

    let mut text = "domain,size,vertices,elements,boundary,min_angle_degrees\n".to_owned();
    for m in &data.meshes {
        let facts = (m.vertices, m.elements, m.boundary);
        let _ = writeln!(
            text,
            "{},{},{},{},{},{}",
            m.domain, m.size, facts.0, facts.1, facts.2, m.min_angle
        );
    }
    put("meshes.csv", text)?;

    let mut text = "domain,size,metric,f,origin\n".to_owned();
    for d in &data.desired {
        let _ = writeln!(text, "{},{},{},{},\"{}\"", d.domain, d.size, d.metric, d.f, d.origin);
    }
    put("desired.csv", text)?;

    let mut text = "domain,scheme,quality,from,to,elements\n".to_owned();
    for d in &data.distributions {
        for (i, count) in d.counts.iter().enumerate() {
            let [from, to] = [i, i + 1].map(|i| i as f64 / BINS as f64);
            let scheme = if d.scheme.is_empty() { "before" } else { &d.scheme };
            let _ = writeln!(text, "{},{scheme},{},{from},{to},{count}", d.domain, d.quality);
        }
    }
    put("distribution.csv", text)?;

    let parent = folder.parent().unwrap_or(folder);
    let records: Vec<Record> = store::read(parent)?;
    put("study.json", serde_json::to_string(&records)? + "\n")?;
    Ok(())
}

fn runs(data: &Data) -> String {
    let mut text =
        "setting,size,start,engine,domain,scheme,repeat,f_initial,f_desired,f_best,stop".to_owned();
    for fraction in FRACTIONS {
        let _ = write!(text, ",sweeps_{fraction},seconds_{fraction}");
    }
    text += ",best_share\n";
    for run in &data.runs {
        let c = &run.case;
        let _ = write!(
            text,
            "{},{},{},{},{},{},{},{},{},{},{}",
            c.setting,
            c.size,
            c.start,
            c.place,
            c.domain,
            c.scheme,
            c.repeat,
            run.history[0].f,
            run.desired,
            run.best(),
            run.stop
        );
        for fraction in FRACTIONS {
            match run.reach(fraction) {
                Reach::Passed { sweeps, seconds } => {
                    let _ = write!(text, ",{sweeps},{seconds}");
                }
                Reach::Missed { .. } => text += ",,",
            }
        }
        let best = (run.history[0].f - run.best()) / (run.history[0].f - run.desired);
        let _ = writeln!(text, ",{best}");
    }
    text
}

fn history(data: &Data) -> String {
    let mut text =
        "setting,size,start,engine,domain,scheme,repeat,sweep,seconds,f,f_edge,f_area\n".to_owned();
    let some = |f: Option<f64>| f.map(|f| f.to_string()).unwrap_or_default();
    for run in &data.runs {
        let c = &run.case;
        for (sweep, sample) in run.history.iter().enumerate() {
            let _ = writeln!(
                text,
                "{},{},{},{},{},{},{},{sweep},{},{},{},{}",
                c.setting,
                c.size,
                c.start,
                c.place,
                c.domain,
                c.scheme,
                c.repeat,
                sample.seconds,
                sample.f,
                some(sample.edge),
                some(sample.area)
            );
        }
    }
    text
}
