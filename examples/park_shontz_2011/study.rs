//! The runs of a study, in batches for a full, a quick and a tiny study.

use serde::{Deserialize, Serialize};

use super::domains::DOMAINS;

macro_rules! words {
    ($(#[$doc:meta])* $name:ident { $($(#[$each:meta])* $variant:ident = $word:literal)* }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
        #[serde(rename_all = "kebab-case")]
        pub(crate) enum $name { $($(#[$each])* $variant),* }

        impl std::fmt::Display for $name {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str(match self { $(Self::$variant => $word),* })
            }
        }
    };
}

words! {
    /// The size of the meshes.
    Size {
        /// 1,500 vertices.
        Coarse = "coarse"
        /// As many vertices as in the paper.
        Full = "full"
    }
}

words! {
    /// Displacement of the interior vertices before the runs.
    Start {
        /// Strong random displacements of individual vertices.
        Random = "random"
        /// Displacements by long waves.
        Smooth = "smooth"
    }
}

words! {
    /// Numerical method of the sweeps.
    Setting {
        /// EDGE, RMS and AREA by finite differences, many Newton steps a visit, no over-relaxation.
        Published = "published"
        /// Analytic derivatives, one Newton step a visit, no over-relaxation.
        Plain = "plain"
        /// This program's defaults: analytic derivatives, one step a visit. Over-relaxed if one metric runs alone.
        Analytic = "analytic"
    }
}

words! {
    /// The engine that does the sweeps.
    Place {
        Cpu = "cpu"
        Gpu = "gpu"
    }
}

/// The paper's schemes and the metrics compared with them, ordered by base metric.
pub(crate) const SCHEMES: [&str; 13] = [
    "edge",
    "edge+imr",
    "edge+ar",
    "edge+imr+imr",
    "edge+imr+imr+imr",
    "rms",
    "rms+imr",
    "rms+ar",
    "area",
    "area+imr",
    "area+ar",
    "imr",
    "ar",
];

/// Runs of all schemes on several meshes with common settings.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Batch {
    pub(crate) setting: Setting,
    pub(crate) size: Size,
    pub(crate) start: Start,
    pub(crate) domains: Vec<String>,
    pub(crate) schemes: Vec<String>,
    /// Fraction of the way to the desired f at which a run ends.
    pub(crate) fraction: f64,
    /// Largest number of Newton steps per visit of a vertex.
    pub(crate) inner: u32,
    pub(crate) max_sweeps: u32,
    /// Repetitions per run on the CPU.
    pub(crate) cpu_repeats: u32,
    /// Repetitions per run on the GPU.
    pub(crate) gpu_repeats: u32,
}

/// A study with all of its batches.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Study {
    pub(crate) mode: String,
    /// Size of the meshes in the tables.
    pub(crate) size: Size,
    /// Number of sweeps from each start in the search for a desired f.
    pub(crate) reference_sweeps: u32,
    pub(crate) batches: Vec<Batch>,
}

/// A run, identified by one row of the data.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Case {
    pub(crate) setting: Setting,
    pub(crate) size: Size,
    pub(crate) start: Start,
    pub(crate) place: Place,
    pub(crate) domain: String,
    pub(crate) scheme: String,
    pub(crate) repeat: u32,
}

impl Study {
    /// Returns the study of all schemes and settings at the paper's sizes. The published setting is slow, so its runs
    /// pass the paper's 95 % on coarse meshes only.
    pub(crate) fn full() -> Self {
        let full = |batch| Batch { size: Size::Full, ..batch };
        Self {
            mode: "full".into(),
            size: Size::Full,
            reference_sweeps: 100,
            batches: vec![
                published(0.999, 20, 20, [1, 1]),
                full(published(0.95, 20, 20, [1, 1])),
                full(analytic(Setting::Analytic, 60, [3, 2])),
                full(analytic(Setting::Plain, 60, [2, 0])),
                full(Batch {
                    start: Start::Smooth,
                    domains: ["airplane", "fish", "mechanic"].map(String::from).to_vec(),
                    ..analytic(Setting::Analytic, 250, [2, 1])
                }),
            ],
        }
    }

    /// Returns the study of all schemes and settings on coarse meshes, which takes less than two minutes.
    pub(crate) fn quick() -> Self {
        Self {
            mode: "quick".into(),
            size: Size::Coarse,
            reference_sweeps: 150,
            batches: vec![
                published(0.999, 10, 20, [2, 1]),
                analytic(Setting::Analytic, 200, [3, 2]),
                analytic(Setting::Plain, 200, [3, 0]),
                Batch { start: Start::Smooth, ..analytic(Setting::Analytic, 400, [2, 1]) },
            ],
        }
    }

    /// Returns a study with few runs of each kind on two meshes, for a test.
    #[allow(dead_code)]
    pub(crate) fn tiny() -> Self {
        let domains = ["fish", "mechanic"].map(String::from).to_vec();
        let few = |batch| Batch { domains: domains.clone(), ..batch };
        Self {
            mode: "tiny".into(),
            size: Size::Coarse,
            reference_sweeps: 40,
            batches: vec![
                few(published(0.95, 3, 8, [1, 1])),
                few(analytic(Setting::Analytic, 20, [2, 1])),
            ],
        }
    }

    /// Lists all runs, with repetitions in the outermost loop, so that a disturbance of the machine affects all schemes
    /// alike.
    pub(crate) fn cases(&self, places: &[Place]) -> Vec<(&Batch, Case)> {
        let mut cases = Vec::new();
        for batch in &self.batches {
            for repeat in 0..batch.cpu_repeats.max(batch.gpu_repeats) {
                for &place in places.iter().filter(|&&place| repeat < batch.repeats(place)) {
                    for domain in &batch.domains {
                        cases.extend(batch.schemes.iter().map(|scheme| {
                            let Batch { setting, size, start, .. } = *batch;
                            let (domain, scheme) = (domain.clone(), scheme.clone());
                            let case = Case { setting, size, start, place, domain, scheme, repeat };
                            (batch, case)
                        }));
                    }
                }
            }
        }
        cases
    }

    /// Returns the batch with this setting, size and start; `None` if the study has no such batch.
    pub(crate) fn batch(&self, setting: Setting, size: Size, start: Start) -> Option<&Batch> {
        self.batches.iter().find(|b| (b.setting, b.size, b.start) == (setting, size, start))
    }
}

impl Batch {
    pub(crate) fn repeats(&self, place: Place) -> u32 {
        match place {
            Place::Cpu => self.cpu_repeats,
            Place::Gpu => self.gpu_repeats,
        }
    }
}

fn published(fraction: f64, inner: u32, max_sweeps: u32, repeats: [u32; 2]) -> Batch {
    Batch { fraction, inner, ..analytic(Setting::Published, max_sweeps, repeats) }
}

fn analytic(setting: Setting, max_sweeps: u32, [cpu_repeats, gpu_repeats]: [u32; 2]) -> Batch {
    Batch {
        setting,
        size: Size::Coarse,
        start: Start::Random,
        domains: DOMAINS.iter().map(|domain| domain.name.to_owned()).collect(),
        schemes: SCHEMES.map(String::from).to_vec(),
        fraction: 0.999,
        inner: 1,
        max_sweeps,
        cpu_repeats,
        gpu_repeats,
    }
}
