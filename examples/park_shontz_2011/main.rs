//! Repeats the experiments of Park and Shontz on six meshes, with the paper's tables and figures beside the published
//! numbers, and a verdict on each claim.
//!
//! ```text
//! cargo run --release --example park-shontz-2011 -- [FOLDER] [--quick] [--engine both|cpu|gpu] [--adapter NAME]
//! ```
//!
//! Writes report.html, report.md, figures/ and data/ into FOLDER. If the study was stopped, the same command continues
//! it. `--quick` uses coarse meshes. docs/paper.md describes method and findings.
#![allow(clippy::print_stdout, clippy::print_stderr)]

mod analysis;
mod claims;
mod document;
mod domains;
mod doubts;
mod export;
mod figures;
mod progress;
mod published;
mod report;
mod runs;
mod store;
pub(crate) mod study;
mod tables;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use gpu_smooth::{Gpu, Metric};

use analysis::Data;
use domains::Domain;
use progress::Progress;
use runs::Runner;
use store::{Header, Record, Store};
use study::{Place, Study};

type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

const USAGE: &str =
    "usage: park-shontz-2011 [FOLDER] [--quick] [--engine both|cpu|gpu] [--adapter NAME]
  FOLDER           where the report goes (default park-shontz-2011); a stopped study there goes on
  --quick          coarse meshes: under two minutes
  --engine ENGINE  both (default), cpu or gpu
  --adapter NAME   take the first GPU adapter with NAME in its name";

fn main() -> ExitCode {
    let args: Vec<_> = std::env::args().skip(1).collect();
    match Request::parse(&args).map_err(Into::into).and_then(|request| request.run()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(problem) => {
            eprintln!("park-shontz-2011: {problem}");
            ExitCode::FAILURE
        }
    }
}

/// The request of the command line.
pub(crate) struct Request {
    folder: PathBuf,
    study: Study,
    places: Vec<Place>,
    adapter: Option<String>,
}

impl Request {
    pub(crate) fn parse(args: &[String]) -> std::result::Result<Self, String> {
        let mut request = Self {
            folder: "park-shontz-2011".into(),
            study: Study::full(),
            places: vec![Place::Cpu, Place::Gpu],
            adapter: None,
        };
        let mut args = args.iter();
        while let Some(arg) = args.next() {
            let mut value = || args.next().ok_or_else(|| format!("{arg} needs a value\n{USAGE}"));
            match arg.as_str() {
                "--quick" => request.study = Study::quick(),
                "--adapter" => request.adapter = Some(value()?.clone()),
                "--engine" => {
                    request.places = match value()?.as_str() {
                        "both" => vec![Place::Cpu, Place::Gpu],
                        "cpu" => vec![Place::Cpu],
                        "gpu" => vec![Place::Gpu],
                        other => return Err(format!("no engine '{other}'\n{USAGE}")),
                    }
                }
                _ if arg.starts_with('-') => return Err(format!("unknown option {arg}\n{USAGE}")),
                _ => request.folder = arg.into(),
            }
        }
        Ok(request)
    }

    fn run(self) -> Result<()> {
        let gpu = if self.places.contains(&Place::Gpu) {
            match Gpu::open(self.adapter.as_deref()).block() {
                Ok(gpu) => Some(gpu),
                Err(problem) if self.places.len() == 1 || self.adapter.is_some() => {
                    return Err(problem.into());
                }
                Err(problem) => {
                    eprintln!("{problem}: on the CPU alone");
                    None
                }
            }
        } else {
            None
        };
        let places: Vec<_> =
            self.places.into_iter().filter(|&p| p == Place::Cpu || gpu.is_some()).collect();
        gather(&self.study, &places, gpu, &self.folder)?;
        report(&self.folder)?;
        println!("{}", self.folder.join("report.html").display());
        Ok(())
    }
}

/// Executes the runs of a study that have no records in the folder.
pub(crate) fn gather(
    study: &Study,
    places: &[Place],
    gpu: Option<Gpu>,
    folder: &Path,
) -> Result<()> {
    let header = Header {
        study: study.clone(),
        version: env!("CARGO_PKG_VERSION").into(),
        cores: std::thread::available_parallelism().map_or(1, usize::from),
        processor: processor(),
        adapter: gpu.as_ref().map(|gpu| {
            let adapter = gpu.adapter();
            format!("{}, {} ({}, {})", adapter.name, adapter.driver, adapter.backend, adapter.kind)
        }),
    };
    let mut store = Store::open(folder, &header)?;
    let cases = study.cases(places);
    let mut progress = Progress::new(&cases, &store);
    let mut runner = Runner::new(gpu, study);
    for (batch, case) in &cases {
        if store.runs().any(|run| run.case == *case) {
            continue;
        }
        let domain = Domain::named(&case.domain)?;
        if store.mesh(&case.domain, case.size).is_none() {
            store.add(Record::Mesh(runner.mesh(domain, case.size)?))?;
        }
        let metric = match case.scheme.parse::<gpu_smooth::Scheme>()?.base() {
            Metric::Ar => Metric::Imr,
            metric => metric,
        };
        let desired = match store.desired(&case.domain, case.size, metric.name()) {
            Some(record) => record.f,
            None => {
                let record = runner.desired(domain, case.size, metric)?;
                let f = record.f;
                store.add(Record::Desired(record))?;
                f
            }
        };
        let run = runner.run(batch, case, desired)?;
        progress.done(&run);
        store.add(Record::Run(run))?;
    }
    progress.end();
    Ok(())
}

/// Writes the report from the records in a folder.
pub(crate) fn report(folder: &Path) -> Result<()> {
    let data = Data::new(store::read(folder)?)?;
    export::write(&data, &folder.join("data"))?;
    let figures = figures::draw_all(&data)?;
    report::write(&data, &figures, folder)
}

/// Returns the name of the processor, or the architecture on systems without `/proc/cpuinfo`.
fn processor() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = info.lines().find(|line| line.starts_with("model name"));
    let name = name.and_then(|line| line.split(':').nth(1)).unwrap_or(std::env::consts::ARCH);
    name.trim().to_owned()
}
