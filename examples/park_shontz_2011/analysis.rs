//! Analysis of the records: times and sweeps to a fraction of the way to the desired f, and medians over repeated runs.

use gpu_smooth::Scheme;

use super::published;
use super::store::{DesiredRecord, DistributionRecord, Header, MeshRecord, Record, RunRecord};
use super::study::{Place, Setting, Size, Start};

/// The records of a study, grouped by type.
pub(crate) struct Data {
    pub(crate) header: Header,
    pub(crate) meshes: Vec<MeshRecord>,
    pub(crate) desired: Vec<DesiredRecord>,
    pub(crate) runs: Vec<RunRecord>,
    pub(crate) distributions: Vec<DistributionRecord>,
}

/// Properties that select the runs of a comparison.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct View {
    pub(crate) setting: Setting,
    pub(crate) size: Size,
    pub(crate) start: Start,
    pub(crate) place: Place,
    /// The fraction of the way to the desired f that runs must pass.
    pub(crate) fraction: f64,
}

/// Whether a run passed a given fraction of the way to the desired f.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Reach {
    /// The run passed the fraction.
    Passed { sweeps: u32, seconds: f64 },
    /// The run did not pass the fraction. `best` is the largest fraction reached.
    Missed { best: f64 },
}

impl Reach {
    pub(crate) fn seconds(self) -> Option<f64> {
        match self {
            Self::Passed { seconds, .. } => Some(seconds),
            Self::Missed { .. } => None,
        }
    }

    pub(crate) fn sweeps(self) -> Option<u32> {
        match self {
            Self::Passed { sweeps, .. } => Some(sweeps),
            Self::Missed { .. } => None,
        }
    }
}

impl RunRecord {
    fn share(&self, f: f64) -> f64 {
        (self.history[0].f - f) / (self.history[0].f - self.desired)
    }

    /// Finds the first sweep past a fraction of the way, by the paper's test (2).
    pub(crate) fn reach(&self, fraction: f64) -> Reach {
        match (0..).zip(&self.history).find(|(_, sample)| self.share(sample.f) > fraction) {
            Some((sweeps, sample)) => Reach::Passed { sweeps, seconds: sample.seconds },
            None => {
                let shares = self.history.iter().map(|sample| self.share(sample.f));
                Reach::Missed { best: shares.fold(0.0, f64::max) }
            }
        }
    }

    /// Returns the smallest f in the run's history.
    pub(crate) fn best(&self) -> f64 {
        self.history.iter().map(|sample| sample.f).fold(f64::INFINITY, f64::min)
    }
}

impl Data {
    pub(crate) fn new(records: Vec<Record>) -> Result<Self, String> {
        let mut records = records.into_iter();
        let Some(Record::Header(header)) = records.next() else {
            return Err("there are no data".into());
        };
        let mut data = Self {
            header,
            meshes: Vec::new(),
            desired: Vec::new(),
            runs: Vec::new(),
            distributions: Vec::new(),
        };
        for record in records {
            match record {
                Record::Header(_) => return Err("the data have two headers".into()),
                Record::Mesh(mesh) => data.meshes.push(mesh),
                Record::Desired(desired) => data.desired.push(desired),
                Record::Run(mut run) => {
                    data.distributions.append(&mut run.distributions);
                    data.runs.push(run);
                }
            }
        }
        Ok(data)
    }

    /// Returns the view of the runs in the paper's tables.
    pub(crate) fn view(&self, setting: Setting, place: Place, fraction: f64) -> View {
        let size = self.header.study.size;
        View { setting, size, start: Start::Random, place, fraction }
    }

    /// Returns the view in which a setting has runs to a fraction of the way. Runs of the published setting pass the
    /// paper's 95 % on coarse meshes only.
    pub(crate) fn view_reaching(&self, setting: Setting, place: Place, fraction: f64) -> View {
        let view = self.view(setting, place, fraction);
        let batch = self.header.study.batch(setting, view.size, view.start);
        match batch {
            Some(batch) if batch.fraction >= fraction => view,
            _ => View { size: Size::Coarse, ..view },
        }
    }

    pub(crate) fn runs_of<'a>(
        &'a self,
        view: View,
        domain: &'a str,
        scheme: &'a str,
    ) -> impl Iterator<Item = &'a RunRecord> {
        self.runs.iter().filter(move |run| {
            let case = &run.case;
            (case.setting, case.size, case.start, case.place)
                == (view.setting, view.size, view.start, view.place)
                && case.domain == domain
                && case.scheme == scheme
        })
    }

    /// Returns the result of a scheme with the median time of its repeated runs, all of which have equal sweeps. `None`
    /// without runs.
    pub(crate) fn reach(&self, view: View, domain: &str, scheme: &str) -> Option<Reach> {
        let all: Vec<_> =
            self.runs_of(view, domain, scheme).map(|run| run.reach(view.fraction)).collect();
        let seconds = median(all.iter().filter_map(|reach| reach.seconds()).collect());
        Some(match (*all.first()?, seconds) {
            (Reach::Passed { sweeps, .. }, Some(seconds)) => Reach::Passed { sweeps, seconds },
            (missed, _) => missed,
        })
    }

    /// Returns the first of the repeated runs, with the median times of all. Repeated runs have identical states.
    pub(crate) fn typical(&self, view: View, domain: &str, scheme: &str) -> Option<RunRecord> {
        let all: Vec<_> = self.runs_of(view, domain, scheme).collect();
        let mut run = (*all.first()?).clone();
        for (sweep, sample) in run.history.iter_mut().enumerate() {
            let seconds = all.iter().filter_map(|run| Some(run.history.get(sweep)?.seconds));
            sample.seconds = median(seconds.collect()).unwrap_or(sample.seconds);
        }
        Some(run)
    }

    /// Returns the names of the domains with runs in a view, in the paper's order.
    pub(crate) fn domains(&self, view: View) -> Vec<&'static str> {
        let has = |name: &&str| self.runs_of(view, name, "edge").next().is_some();
        super::domains::DOMAINS.iter().map(|d| d.name).filter(has).collect()
    }

    /// Returns for each domain the fraction of time that a scheme saves against `base`; `None` if either missed its
    /// goal.
    pub(crate) fn saved(&self, view: View, scheme: &str, base: &str) -> Vec<Option<f64>> {
        self.ratios(view, scheme, base).into_iter().map(|ratio| ratio.map(|r| 1.0 - r)).collect()
    }

    /// Returns for each domain the time of a scheme divided by that of `base`; `None` if either missed its goal.
    pub(crate) fn ratios(&self, view: View, scheme: &str, base: &str) -> Vec<Option<f64>> {
        let of = |domain: &&str| {
            let seconds = |scheme| self.reach(view, domain, scheme)?.seconds();
            Some(seconds(scheme)? / seconds(base)?)
        };
        self.domains(view).iter().map(of).collect()
    }

    /// Returns the seconds per sweep until the run passes the fraction; `None` for missed goals.
    pub(crate) fn per_sweep(&self, view: View, domain: &str, scheme: &str) -> Option<f64> {
        match self.reach(view, domain, scheme)? {
            Reach::Passed { sweeps, seconds } => Some(seconds / f64::from(sweeps.max(1))),
            Reach::Missed { .. } => None,
        }
    }

    /// Returns the seconds per sweep over all complete rounds of a scheme, including rounds after the goal.
    pub(crate) fn pace(&self, view: View, domain: &str, scheme: &str) -> Option<f64> {
        let period = scheme.split('+').count();
        let of = |run: &RunRecord| {
            let sweeps = (run.history.len() - 1) / period * period;
            (sweeps > 0).then(|| run.history[sweeps].seconds / sweeps as f64)
        };
        median(self.runs_of(view, domain, scheme).filter_map(of).collect())
    }

    pub(crate) fn places(&self) -> Vec<Place> {
        let has = |place: &Place| self.runs.iter().any(|run| run.case.place == *place);
        [Place::Cpu, Place::Gpu].into_iter().filter(has).collect()
    }
}

/// Returns the name of the scheme's base metric.
pub(crate) fn base(scheme: &str) -> &str {
    scheme.split('+').next().unwrap_or(scheme)
}

/// Returns the name of a scheme in the paper's notation.
pub(crate) fn paper_name(scheme: &str) -> String {
    debug_assert!(scheme.parse::<Scheme>().is_ok());
    scheme.to_uppercase()
}

/// Returns the median, which is the mean of the two middle values for an even count. `None` without values.
pub(crate) fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let n = values.len();
    (n > 0).then(|| (values[(n - 1) / 2] + values[n / 2]) / 2.0)
}

/// Returns the smallest and the largest value.
pub(crate) fn range(values: &[f64]) -> [f64; 2] {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    [low, values.iter().copied().fold(f64::NEG_INFINITY, f64::max)]
}

/// Returns the smallest and the largest published saving of the six meshes.
pub(crate) fn published_range(scheme: &str, base: &str) -> Option<[f64; 2]> {
    published::saved(scheme, base).map(|saved| range(&saved))
}
