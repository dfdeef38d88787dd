//! The paper's claims, the measures for each claim, and the rules for verdicts.

use super::analysis::{Data, Reach, View, base, median, paper_name, published_range, range};
use super::document::Table;
use super::export::FRACTIONS;
use super::published::{SECONDS_PER_SWEEP, row};
use super::store::{BINS, DistributionRecord};
use super::study::{Place, Setting, Size};
use super::tables::{NONE, percent, setting_name, share};

/// Largest distance of a median outside of the published range that counts as reproduced, as a fraction of time.
const TOLERANCE: f64 = 0.05;

/// A claim of the paper, with a measure for each view.
pub(crate) struct Claim {
    pub(crate) statement: String,
    pub(crate) published: String,
    pub(crate) measures: Vec<(View, Measure)>,
}

/// A measurement in a view, and whether the measurement supports the claim.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Measure {
    pub(crate) text: String,
    pub(crate) holds: bool,
}

impl Claim {
    /// Returns whether the claim is reproduced always, never, or under which conditions. `size` is the mesh size of the
    /// tables; conditions mark views of another size.
    pub(crate) fn verdict(&self, size: Size) -> String {
        let at_paper = |setting| {
            let mut of =
                self.measures.iter().filter(|(v, _)| v.setting == setting && v.fraction == 0.95);
            of.clone().next().is_some() && of.all(|(_, measure)| measure.holds)
        };
        let holds: Vec<_> =
            self.measures.iter().filter(|(_, m)| m.holds).map(|(v, _)| *v).collect();
        if self.measures.is_empty() {
            "not measured".into()
        } else if holds.is_empty() {
            "**not reproduced**".into()
        } else if holds.len() == self.measures.len() {
            "**reproduced**".into()
        } else if at_paper(Setting::Published) && at_paper(Setting::Analytic) {
            let fails: Vec<_> =
                self.measures.iter().filter(|(_, m)| !m.holds).map(|(v, _)| *v).collect();
            format!("**reproduced** at the paper's 95 %; not under: {}", conditions(&fails, size))
        } else {
            format!("**reproduced only under**: {}", conditions(&holds, size))
        }
    }

    fn at(&self, setting: Setting, place: Place, fraction: f64) -> String {
        let found = self
            .measures
            .iter()
            .find(|(v, _)| (v.setting, v.place, v.fraction) == (setting, place, fraction));
        found.map_or(NONE.into(), |(_, measure)| measure.text.clone())
    }
}

/// Describes views in text, such as "as published (cpu 95.0 %, 99.0 %)".
fn conditions(views: &[View], size: Size) -> String {
    let mut parts: Vec<(String, Vec<String>)> = Vec::new();
    for view in views {
        let name = format!(
            "{} on the {}",
            setting_name(view.setting),
            view.place.to_string().to_uppercase()
        );
        let coarse = if view.size == size { "" } else { " on coarse meshes" };
        let share = share(view.fraction) + coarse;
        match parts.iter_mut().find(|(known, _)| *known == name) {
            Some((_, shares)) => shares.push(share),
            None => parts.push((name, vec![share])),
        }
    }
    let parts: Vec<_> =
        parts.iter().map(|(name, shares)| format!("{name} ({})", shares.join(", "))).collect();
    parts.join("; ")
}

/// Returns all views that have runs.
fn views(data: &Data) -> Vec<View> {
    let mut views = Vec::new();
    for place in data.places() {
        for setting in [Setting::Published, Setting::Plain, Setting::Analytic] {
            for fraction in FRACTIONS {
                let view = data.view_reaching(setting, place, fraction);
                let batch = data.header.study.batch(view.setting, view.size, view.start);
                let goes_there = batch.is_some_and(|b| b.fraction >= fraction);
                if goes_there && !data.domains(view).is_empty() {
                    views.push(view);
                }
            }
        }
    }
    views
}

pub(crate) fn claims(data: &Data) -> Vec<Claim> {
    let mut claims = Vec::new();
    let mut add = |statement: String, published: String, measure: &dyn Fn(View) -> Measure| {
        let measures = views(data).into_iter().map(|view| (view, measure(view))).collect();
        claims.push(Claim { statement, published, measures });
    };
    for scheme in ["edge+imr", "edge+ar", "rms+imr", "rms+ar"] {
        let statement =
            format!("{} saves 40–55 % of {}'s time", paper_name(scheme), paper_name(base(scheme)));
        let published = spread_of(published_range(scheme, base(scheme)));
        add(statement, published, &|view| saving(data, view, scheme, base(scheme), [0.40, 0.55]));
    }
    for (scheme, against, words) in [
        ("area+imr", "area", "AREA+IMR saves little, as AREA is nearly as fast"),
        ("area+ar", "area", "AREA+AR saves 12–13 % of AREA's time"),
        ("edge+imr+imr", "edge", "EDGE+IMR+IMR saves 67 % of EDGE's time"),
        ("edge+imr+imr+imr", "edge", "EDGE+IMR+IMR+IMR saves 77 % of EDGE's time"),
        ("edge+imr+imr", "edge+imr", "EDGE+IMR+IMR saves 28 % and more of EDGE+IMR's time"),
        (
            "edge+imr+imr+imr",
            "edge+imr+imr",
            "EDGE+IMR+IMR+IMR saves slightly less again, against EDGE+IMR+IMR",
        ),
    ] {
        let Some(published) = published_range(scheme, against) else { continue };
        add(words.into(), spread_of(Some(published)), &|view| {
            saving(data, view, scheme, against, published)
        });
    }
    for scheme in ["edge+imr", "rms+imr"] {
        let (name, alone) = (paper_name(scheme), paper_name(base(scheme)));
        let statement =
            format!("A sweep of {name} takes half the time of one of {alone}, on average");
        let per_sweep = |scheme| row(SECONDS_PER_SWEEP, scheme).unwrap_or([f64::NAN; 6]);
        let (both, one) = (per_sweep(scheme), per_sweep(base(scheme)));
        let paper: [f64; 6] = std::array::from_fn(|i| both[i] / one[i]);
        add(statement, times(&paper), &|view| {
            let of = |domain: &&str| {
                Some(data.pace(view, domain, scheme)? / data.pace(view, domain, base(scheme))?)
            };
            let ratios: Vec<_> = data.domains(view).iter().filter_map(of).collect();
            let holds = median(ratios.clone()).is_some_and(|m| (m - 0.5).abs() <= TOLERANCE);
            Measure { text: times(&ratios), holds }
        });
    }
    let alternations = ["edge+imr", "edge+ar", "rms+imr", "rms+ar"];
    add("A+B takes as many sweeps as A (EDGE, RMS)".into(), "equal (Table 5)".into(), &|view| {
        let ratios = alternations.iter().flat_map(|scheme| sweep_ratios(data, view, scheme));
        let ratios: Vec<_> = ratios.collect();
        let holds = median(ratios.clone()).is_some_and(|m| (m - 1.0).abs() <= TOLERANCE);
        Measure { text: times(&ratios), holds }
    });
    for metric in ["edge", "rms"] {
        let statement = format!("{} takes about 200 times as long as IMR", paper_name(metric));
        let published = "about 200 × (here the cap on Newton steps sets it)".to_owned();
        add(statement, published, &|view| {
            let ratios: Vec<_> = data.ratios(view, metric, "imr").into_iter().flatten().collect();
            let holds = median(ratios.clone()).is_some_and(|m| (100.0..=400.0).contains(&m));
            Measure { text: times(&ratios), holds }
        });
    }
    add("AREA and AR take the same time but for 1 %".into(), "1 %".into(), &|view| {
        let ratios: Vec<_> = data.ratios(view, "ar", "area").into_iter().flatten().collect();
        let holds = median(ratios.clone()).is_some_and(|m| (m - 1.0).abs() <= TOLERANCE);
        Measure { text: times(&ratios), holds }
    });
    add("EDGE and RMS alternations reach the desired quality".into(), "always".into(), &|view| {
        passed(
            data,
            view,
            &["edge+imr", "edge+ar", "edge+imr+imr", "edge+imr+imr+imr", "rms+imr", "rms+ar"],
        )
    });
    add("AREA alternations reach the desired quality".into(), "always".into(), &|view| {
        passed(data, view, &["area+imr", "area+ar"])
    });
    claims
}

/// Measures the time that `scheme` saves against `against`. The claim holds if all meshes reach the goal and the median
/// is in the range, within [`TOLERANCE`].
fn saving(data: &Data, view: View, scheme: &str, against: &str, [low, high]: [f64; 2]) -> Measure {
    let all = data.saved(view, scheme, against);
    let values: Vec<_> = all.iter().flatten().copied().collect();
    let mut text = spread_median(&values);
    if values.len() < all.len() {
        text = match values.len() {
            0 => format!("not reached on any of {}", all.len()),
            n => format!("{text}, reached on {n} of {}", all.len()),
        };
    }
    let within = |m: f64| (low - TOLERANCE..=high + TOLERANCE).contains(&m);
    let holds = values.len() == all.len() && median(values).is_some_and(within);
    Measure { text, holds }
}

fn sweep_ratios(data: &Data, view: View, scheme: &str) -> Vec<f64> {
    let of = |domain: &&str| {
        let sweeps = |scheme| data.reach(view, domain, scheme).and_then(Reach::sweeps);
        Some(f64::from(sweeps(scheme)?) / f64::from(sweeps(base(scheme))?))
    };
    data.domains(view).iter().filter_map(of).collect()
}

fn passed(data: &Data, view: View, schemes: &[&str]) -> Measure {
    let domains = data.domains(view);
    let reaches: Vec<_> = schemes
        .iter()
        .flat_map(|scheme| domains.iter().filter_map(|domain| data.reach(view, domain, scheme)))
        .collect();
    let passed = reaches.iter().filter(|reach| reach.seconds().is_some()).count();
    Measure { text: format!("{passed} of {} runs", reaches.len()), holds: passed == reaches.len() }
}

fn spread_of(bounds: Option<[f64; 2]>) -> String {
    bounds.map_or(NONE.into(), |[low, high]| format!("{} to {}", percent(low), percent(high)))
}

/// Formats the median of values, with their range in parentheses.
fn spread_median(values: &[f64]) -> String {
    let Some(middle) = median(values.to_vec()) else { return NONE.into() };
    let [low, high] = range(values);
    format!("{} ({} to {})", percent(middle), percent(low), percent(high))
}

fn times(values: &[f64]) -> String {
    let Some(middle) = median(values.to_vec()) else { return "not reached".into() };
    let [low, high] = range(values).map(super::tables::three);
    format!("{} × ({low} to {high})", super::tables::three(middle))
}

/// Returns the table of verdicts, with a selection of columns.
pub(crate) fn table(data: &Data, claims: &[Claim]) -> Table {
    let place = data.places().first().copied().unwrap_or(Place::Cpu);
    let mut rows: Vec<_> = claims
        .iter()
        .map(|claim| {
            vec![
                claim.statement.clone(),
                claim.published.clone(),
                claim.at(Setting::Published, place, 0.95),
                claim.at(Setting::Analytic, place, 0.95),
                claim.at(Setting::Analytic, place, 0.999),
                claim.verdict(data.header.study.size),
            ]
        })
        .collect();
    rows.extend(distribution_rows(data));
    Table {
        caption: format!(
            "Median over the meshes (least to largest) on the {}. A claim holds in a setting if every mesh \
             passed and the median is within {} points of the published range",
            place.to_string().to_uppercase(),
            100.0 * TOLERANCE
        ),
        head: [
            "claim",
            "paper",
            "as published, 95 %",
            "analytic, 95 %",
            "analytic, 99.9 %",
            "verdict",
        ]
        .map(String::from)
        .to_vec(),
        rows,
        prose: true,
    }
}

/// Returns the table of all measures for all claims.
pub(crate) fn all(claims: &[Claim]) -> Table {
    let rows = claims.iter().flat_map(|claim| {
        claim.measures.iter().map(|(view, measure)| {
            vec![
                claim.statement.clone(),
                setting_name(view.setting).to_owned(),
                view.size.to_string(),
                view.place.to_string().to_uppercase(),
                share(view.fraction),
                measure.text.clone(),
                if measure.holds { "yes" } else { "no" }.to_owned(),
            ]
        })
    });
    Table {
        caption: "Every measure behind the verdicts".into(),
        head: ["claim", "setting", "meshes", "engine", "share of the way", "measured", "holds"]
            .map(String::from)
            .to_vec(),
        rows: rows.collect(),
        prose: true,
    }
}

/// Returns the table rows on the distributions in Figures 4 and 5.
fn distribution_rows(data: &Data) -> Vec<Vec<String>> {
    let find = |domain: &str, quality: &str, scheme: &str| {
        data.distributions
            .iter()
            .find(|d| (&*d.domain, &*d.quality, &*d.scheme) == (domain, quality, scheme))
    };
    let mut rows = Vec::new();
    let line = |statement: &str, published: &str, measured: String, holds: bool| {
        let verdict = if holds { "**reproduced**" } else { "**not reproduced**" };
        let blank = || NONE.to_owned();
        vec![statement.into(), published.into(), measured, blank(), blank(), verdict.into()]
    };
    if let (Some(alone), Some(both)) =
        (find("mechanic", "edge", "edge"), find("mechanic", "edge", "edge+imr"))
    {
        let [a, b] = [alone, both].map(|d| above(d, 0.8));
        rows.push(line(
            "Mechanic: EDGE+IMR leaves more elements of better quality than EDGE, at a similar mean (Figure 4)",
            "by eye",
            format!(
                "elements above 0.8: {} after EDGE+IMR, {} after EDGE; means {:.3} and {:.3}",
                percent(b),
                percent(a),
                both.mean,
                alone.mean
            ),
            b > a && (both.mean / alone.mean - 1.0).abs() < TOLERANCE,
        ));
    }
    if let (Some(alone), Some(both)) =
        (find("fish", "mean ratio", "area"), find("fish", "mean ratio", "area+ar"))
    {
        let total = alone.counts.iter().sum::<usize>() as f64;
        let moved: f64 =
            alone.counts.iter().zip(&both.counts).map(|(&a, &b)| a.abs_diff(b) as f64).sum();
        let apart = moved / (2.0 * total);
        rows.push(line(
            "Fish: AREA and AREA+AR leave similar distributions (Figure 5)",
            "by eye",
            format!(
                "{} of the elements would have to change their bin; means {:.3} and {:.3}",
                percent(apart),
                alone.mean,
                both.mean
            ),
            apart < 2.0 * TOLERANCE,
        ));
    }
    rows
}

fn above(distribution: &DistributionRecord, quality: f64) -> f64 {
    let from = (quality * BINS as f64).round() as usize;
    let total: usize = distribution.counts.iter().sum();
    distribution.counts[from..].iter().sum::<usize>() as f64 / total as f64
}
