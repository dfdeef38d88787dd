//! Repeats Park and Shontz's experiments on few meshes: the report must agree with its data files.

#[allow(dead_code)]
#[path = "../examples/park_shontz_2011/main.rs"]
mod park_shontz;

use std::collections::HashMap;
use std::fs;
use std::path::Path;

use gpu_smooth::Gpu;

use park_shontz::study::{Place, Study};
use park_shontz::{Request, gather, report};

/// Returns the rows of a CSV file by column name.
fn csv(path: &Path) -> Vec<HashMap<String, String>> {
    let text = fs::read_to_string(path).unwrap();
    let mut lines = text.lines();
    let head: Vec<_> = lines.next().unwrap().split(',').map(String::from).collect();
    lines
        .map(|line| {
            head.iter().cloned().zip(line.splitn(head.len(), ',').map(String::from)).collect()
        })
        .collect()
}

/// Returns the cells of the Markdown table below a caption, beginning with its head.
fn table(markdown: &str, caption: &str) -> Vec<Vec<String>> {
    let start = markdown.find(caption).unwrap_or_else(|| panic!("no table '{caption}'"));
    let rows = markdown[start..].lines().skip_while(|line| !line.starts_with('|'));
    rows.take_while(|line| line.starts_with('|'))
        .filter(|line| !line.starts_with("| ---"))
        .map(|line| {
            line.trim_matches('|').split(" | ").map(|cell| cell.trim().to_owned()).collect()
        })
        .collect()
}

/// Sweeps and median seconds to 95 %, computed from histories and desired values in the data files.
struct Times {
    history: Vec<HashMap<String, String>>,
    desired: Vec<HashMap<String, String>>,
}

impl Times {
    fn of(&self, setting: &str, engine: &str, domain: &str, scheme: &str) -> (usize, f64) {
        let base = scheme.split('+').next().unwrap().replace("ar", "imr").replace("imrea", "area");
        let desired = self
            .desired
            .iter()
            .find(|row| row["domain"] == domain && row["metric"] == base)
            .map(|row| row["f"].parse::<f64>().unwrap())
            .unwrap();
        let mut passed = Vec::new();
        for repeat in 0.. {
            let wanted = [setting, engine, domain, scheme, &repeat.to_string()];
            let columns = ["setting", "engine", "domain", "scheme", "repeat"];
            let samples: Vec<(f64, f64)> = self
                .history
                .iter()
                .filter(|row| columns.iter().zip(wanted).all(|(&c, w)| row[c] == w))
                .map(|row| (row["seconds"].parse().unwrap(), row["f"].parse().unwrap()))
                .collect();
            let Some(&(_, first)) = samples.first() else { break };
            let gone = |f: f64| first - f > 0.95 * (first - desired);
            let sweep = samples.iter().position(|(_, f)| gone(*f)).expect("it converges");
            passed.push((sweep, samples[sweep].0));
        }
        let mut seconds: Vec<_> = passed.iter().map(|(_, seconds)| *seconds).collect();
        seconds.sort_by(f64::total_cmp);
        let middle = (seconds[(seconds.len() - 1) / 2] + seconds[seconds.len() / 2]) / 2.0;
        (passed[0].0, middle)
    }
}

/// Returns whether a cell shows a number, rounded to the digits of the cell.
fn shows(cell: &str, number: f64) -> bool {
    let cell = cell.trim_end_matches(" %");
    let digits = cell.split('.').nth(1).map_or(0, str::len);
    cell == format!("{number:.digits$}")
}

#[test]
fn the_papers_report_says_what_its_data_say() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let places = [Place::Cpu, Place::Gpu];
    gather(&Study::tiny(), &places, Some(Gpu::open(None).block().unwrap()), folder).unwrap();
    report(folder).unwrap();

    let data = folder.join("data");
    let times =
        Times { history: csv(&data.join("history.csv")), desired: csv(&data.join("desired.csv")) };
    let markdown = fs::read_to_string(folder.join("report.md")).unwrap();
    let mut compared = 0;
    for (setting, name) in [("published", "as published"), ("analytic", "analytic")] {
        for (engine, place) in [("cpu", "CPU"), ("gpu", "GPU")] {
            let seconds = table(
                &markdown,
                &format!("Table 3, EDGE: time to convergence ({name}, {place}, 95 %)"),
            );
            let sweeps = table(
                &markdown,
                &format!("Table 5 (b), RMS: sweeps and time per sweep ({name}, {place}, 95 %)"),
            );
            assert_eq!((seconds.len(), sweeps.len()), (3, 3), "a head and two meshes");
            for (row, counts) in seconds[1..].iter().zip(&sweeps[1..]) {
                let domain = &row[0];
                let [edge, with_imr] =
                    ["edge", "edge+imr"].map(|scheme| times.of(setting, engine, domain, scheme));
                assert!(shows(&row[2], edge.1), "{row:?} for {edge:?}");
                assert!(shows(&row[4], with_imr.1), "{row:?} for {with_imr:?}");
                assert!(shows(&row[6], 100.0 * (1.0 - with_imr.1 / edge.1)), "{row:?}");
                let (count, seconds) = times.of(setting, engine, domain, "rms+imr");
                assert_eq!(counts[6], count.to_string(), "{counts:?}");
                assert!(shows(&counts[8], seconds / count as f64), "{counts:?}");
                compared += 1;
            }
        }
    }
    assert_eq!(compared, 8);

    // The first verdict concerns two meshes, so the median is their mean.
    let verdicts = table(&markdown, "Median over the meshes");
    let saved = ["fish", "mechanic"].map(|domain| {
        let [edge, with_imr] =
            ["edge", "edge+imr"].map(|scheme| times.of("analytic", "cpu", domain, scheme).1);
        100.0 * (1.0 - with_imr / edge)
    });
    let first = &verdicts[1];
    assert!(first[0].starts_with("EDGE+IMR saves"), "{first:?}");
    assert!(shows(first[3].split(" (").next().unwrap(), (saved[0] + saved[1]) / 2.0), "{first:?}");

    // The HTML is a single file that loads no other, with equal numbers.
    let html = fs::read_to_string(folder.join("report.html")).unwrap();
    assert_eq!(html.matches("<svg").count(), 6);
    assert!(!html.contains("src=") && !html.contains("href="));
    for row in &verdicts[1..] {
        assert!(row[2..5].iter().all(|cell| html.contains(cell.as_str())), "{row:?}");
    }
}

#[test]
fn a_stopped_study_goes_on_where_it_was() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let mut study = Study::tiny();
    study.batches.truncate(1);
    study.batches[0].domains.truncate(1);
    study.batches[0].schemes.truncate(3);
    let path = folder.join("data/records.jsonl");
    gather(&study, &[Place::Cpu], None, folder).unwrap();
    let whole = fs::read_to_string(&path).unwrap();

    // Simulates a stop of the study during the last record.
    fs::write(&path, &whole[..whole.len() - 20]).unwrap();
    gather(&study, &[Place::Cpu], None, folder).unwrap();
    let again = fs::read_to_string(&path).unwrap();
    let [before, after]: [Vec<&str>; 2] = [&whole, &again].map(|text| text.lines().collect());
    assert_eq!(before.len(), after.len());
    let kept = before.len() - 1;
    assert_eq!(before[..kept], after[..kept], "what was there is kept");
    assert_ne!(before[kept], after[kept], "the last run is done again");

    gather(&study, &[Place::Cpu], None, folder).unwrap();
    assert_eq!(fs::read_to_string(&path).unwrap(), again, "nothing is left to do");

    study.mode = "another".into();
    let problem = gather(&study, &[Place::Cpu], None, folder).unwrap_err().to_string();
    assert!(problem.contains("another study"), "{problem}");
}

#[test]
fn the_study_explains_what_it_refuses() {
    for (args, expected) in [
        (&["--fast"][..], "unknown option --fast"),
        (&["--engine"], "--engine needs a value"),
        (&["--engine", "fpga"], "no engine 'fpga'"),
    ] {
        let args: Vec<_> = args.iter().map(|arg| (*arg).to_owned()).collect();
        let problem = Request::parse(&args).err().expect("it is refused");
        assert!(problem.contains(expected) && problem.contains("usage"), "{problem}");
    }
}
