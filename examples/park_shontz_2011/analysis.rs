//! Analyzes the records: times and sweeps to a share of the way, and medians over repeated runs.

use gpu_smooth::Scheme;

use super::published;
use super::store::{DesiredRecord, DistributionRecord, Header, MeshRecord, Record, RunRecord};
use super::study::{Place, Setting, Size, Start};

/// The records, grouped by kind.
pub(crate) struct Data {
    pub(crate) header: Header,
    pub(crate) meshes: Vec<MeshRecord>,
    pub(crate) desired: Vec<DesiredRecord>,
    pub(crate) runs: Vec<RunRecord>,
    pub(crate) distributions: Vec<DistributionRecord>,
}

/// Which runs are compared: those with these properties.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct View {
    pub(crate) setting: Setting,
    pub(crate) size: Size,
    pub(crate) start: Start,
    pub(crate) place: Place,
    /// The share of the way to the desired f that runs must pass.
    pub(crate) fraction: f64,
}

/// Whether a scheme passed the share of the way on a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Reach {
    /// It passed the share of the way.
    Passed { sweeps: u32, seconds: f64 },
    /// It did not pass it. `best` is the largest share that it went.
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

    /// Finds the first sweep past a share of the way, by the paper's test (2).
    pub(crate) fn reach(&self, fraction: f64) -> Reach {
        match (0..).zip(&self.history).find(|(_, sample)| self.share(sample.f) > fraction) {
            Some((sweeps, sample)) => Reach::Passed { sweeps, seconds: sample.seconds },
            None => {
                let shares = self.history.iter().map(|sample| self.share(sample.f));
                Reach::Missed { best: shares.fold(0.0, f64::max) }
            }
        }
    }

    /// The least f of the run.
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

    /// The view of the runs in the paper's tables.
    pub(crate) fn view(&self, setting: Setting, place: Place, fraction: f64) -> View {
        let size = self.header.study.size;
        View { setting, size, start: Start::Random, place, fraction }
    }

    /// The view in which a setting has runs to a share of the way. The published setting goes past the paper's 95 % on coarse
    /// meshes only.
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

    /// Whether a scheme passed the share, with the median time of its repeated runs. All of these have the same sweeps.
    pub(crate) fn reach(&self, view: View, domain: &str, scheme: &str) -> Option<Reach> {
        let all: Vec<_> =
            self.runs_of(view, domain, scheme).map(|run| run.reach(view.fraction)).collect();
        let seconds = median(all.iter().filter_map(|reach| reach.seconds()).collect());
        Some(match (*all.first()?, seconds) {
            (Reach::Passed { sweeps, .. }, Some(seconds)) => Reach::Passed { sweeps, seconds },
            (missed, _) => missed,
        })
    }

    /// The first of the repeated runs, with the median times of all. Their states are the same.
    pub(crate) fn typical(&self, view: View, domain: &str, scheme: &str) -> Option<RunRecord> {
        let all: Vec<_> = self.runs_of(view, domain, scheme).collect();
        let mut run = (*all.first()?).clone();
        for (sweep, sample) in run.history.iter_mut().enumerate() {
            let seconds = all.iter().filter_map(|run| Some(run.history.get(sweep)?.seconds));
            sample.seconds = median(seconds.collect()).unwrap_or(sample.seconds);
        }
        Some(run)
    }

    /// The domains with runs in a view, in the paper's order.
    pub(crate) fn domains(&self, view: View) -> Vec<&'static str> {
        let has = |name: &&str| self.runs_of(view, name, "edge").next().is_some();
        super::domains::DOMAINS.iter().map(|d| d.name).filter(has).collect()
    }

    /// The share of time that a scheme saves against `base`, for each domain; `None` if either missed its goal.
    pub(crate) fn saved(&self, view: View, scheme: &str, base: &str) -> Vec<Option<f64>> {
        self.ratios(view, scheme, base).into_iter().map(|ratio| ratio.map(|r| 1.0 - r)).collect()
    }

    /// The time of a scheme over that of `base`, for each domain.
    pub(crate) fn ratios(&self, view: View, scheme: &str, base: &str) -> Vec<Option<f64>> {
        let of = |domain: &&str| {
            let seconds = |scheme| self.reach(view, domain, scheme)?.seconds();
            Some(seconds(scheme)? / seconds(base)?)
        };
        self.domains(view).iter().map(of).collect()
    }

    /// Seconds per sweep, up to the share of the way.
    pub(crate) fn per_sweep(&self, view: View, domain: &str, scheme: &str) -> Option<f64> {
        match self.reach(view, domain, scheme)? {
            Reach::Passed { sweeps, seconds } => Some(seconds / f64::from(sweeps.max(1))),
            Reach::Missed { .. } => None,
        }
    }

    /// Seconds per sweep, over all whole rounds of a scheme, also those past the share of the way.
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

/// The scheme's base metric, by name.
pub(crate) fn base(scheme: &str) -> &str {
    scheme.split('+').next().unwrap_or(scheme)
}

/// The name of a scheme as the paper writes it.
pub(crate) fn paper_name(scheme: &str) -> String {
    debug_assert!(scheme.parse::<Scheme>().is_ok());
    scheme.to_uppercase()
}

/// The median. For an even number of values it is the mean of the middle two.
pub(crate) fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let n = values.len();
    (n > 0).then(|| (values[(n - 1) / 2] + values[n / 2]) / 2.0)
}

/// The least and the largest value.
pub(crate) fn range(values: &[f64]) -> [f64; 2] {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    [low, values.iter().copied().fold(f64::NEG_INFINITY, f64::max)]
}

/// The least and the largest published saving of the six meshes.
pub(crate) fn published_range(scheme: &str, base: &str) -> Option<[f64; 2]> {
    published::saved(scheme, base).map(|saved| range(&saved))
}
