//! A mesh beside the limits of a profile.

use std::fmt::Write;

use gpu_smooth::Metric;
use serde::{Serialize, Serializer};
use serde_json::{Value, json};

use crate::limits::{Part, Quantity, Threshold};
use crate::profiles::{Elements, Limit, Profile};
use crate::report::quantities::{Finding, Quantities, Worst, written};
use crate::report::reasons::{Reason, reasons};

/// The judgment of a mesh by a limit, or by all limits of a profile; the worst of them is the largest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Verdict {
    Good,
    Warn,
    Fail,
}

impl Verdict {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Warn => "warn",
            Self::Fail => "fail",
        }
    }
}

/// A mesh beside the limits of a profile.
pub(crate) struct ProfileReport {
    name: String,
    title: String,
    /// The metric by which runs for the solver smooth meshes.
    scheme: Option<Metric>,
    pub(crate) limits: Vec<LimitReport>,
    /// Number of quadrilaterals that limits leave out, if all limits of elements and of vertices concern triangles.
    quadrilaterals: usize,
    /// The edges beyond limits of edges, by the reason that no move of free vertices mends them.
    reasons: Vec<Reason>,
}

/// A mesh beside a limit.
pub(crate) struct LimitReport {
    limit: Limit,
    /// The parts of the mesh in the range of `warn`, which includes the range of `fail`; `None` without such a range.
    warn: Option<Finding>,
    fail: Option<Finding>,
    /// The worst part by a listed quantity, which has neither range.
    listed: Option<Finding>,
}

/// Widths of the columns in front of the numbers, in characters. Long names widen the first.
const QUANTITY: usize = 18;
const RANGE: usize = 10;

impl ProfileReport {
    /// Compares a mesh with the limits of a profile.
    pub(crate) fn new(profile: &Profile, quantities: &Quantities<'_>) -> Self {
        let compared = |limit: &Limit| {
            let found = |range: &Threshold| quantities.finding_among(range, limit.elements);
            LimitReport {
                limit: limit.clone(),
                warn: limit.warn.as_ref().map(found),
                fail: limit.fail.as_ref().map(found),
                listed: limit
                    .is_listed()
                    .then(|| quantities.finding(&Threshold::none(limit.quantity))),
            }
        };
        let is_of_elements = |limit: &Limit| limit.quantity.part() == Part::Triangle;
        let judges = |limit: &Limit| limit.elements == Elements::Quadrilaterals;
        let judges_quadrilaterals = profile.limits.iter().any(judges);
        // A mesh of one kind of elements needs no limits of the other kind.
        let concerns = |limit: &&Limit| {
            limit.is_listed()
                || !(judges_quadrilaterals && is_of_elements(limit))
                || quantities.count(limit.elements) > 0
        };
        // A listed quantity that no part has, such as the time step without depths, has no line.
        let is_shown =
            |limit: &LimitReport| limit.listed.as_ref().is_none_or(|listed| listed.total > 0);
        // Vertices of quadrilaterals have no verdict, and perhaps all vertices are of quadrilaterals.
        let has_vertices = |limit: &LimitReport| {
            let found = limit.fail.as_ref().or(limit.warn.as_ref());
            limit.limit.quantity.part() != Part::Vertex || found.is_none_or(|found| found.total > 0)
        };
        let is_shown = |limit: &LimitReport| is_shown(limit) && has_vertices(limit);
        let leaves_out =
            |limit: &Limit| matches!(limit.quantity.part(), Part::Triangle | Part::Vertex);
        let is_complete = judges_quadrilaterals || !profile.limits.iter().any(leaves_out);
        Self {
            name: profile.name.clone(),
            title: profile.title.clone(),
            scheme: profile.scheme,
            limits: profile.limits.iter().filter(concerns).map(compared).filter(is_shown).collect(),
            quadrilaterals: match is_complete {
                true => 0,
                false => quantities.count(Elements::Quadrilaterals),
            },
            reasons: reasons(profile, quantities),
        }
    }

    /// Returns the name of the profile.
    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    /// Returns the numbers of parts of the mesh beyond limits that fail, and beyond limits that warn alone, summed over all
    /// limits.
    pub(crate) fn beyond(&self) -> [usize; 2] {
        let sum = |count: fn(&LimitReport) -> usize| self.limits.iter().map(count).sum();
        [sum(LimitReport::failed), sum(LimitReport::warned)]
    }

    /// Returns the worst verdict of all limits.
    pub(crate) fn verdict(&self) -> Verdict {
        self.limits.iter().map(LimitReport::verdict).max().unwrap_or(Verdict::Good)
    }

    /// Returns a table with a line for each limit, and the reasons of edges beyond limits.
    pub(crate) fn table(&self) -> String {
        let width = self.width();
        let mut text = format!("limits of {}", self.heading());
        let _ = write!(text, "\n{}", ranges("quantity", width, ["warn", "fail"]));
        let _ = write!(text, "{}  worst", LimitReport::HEAD);
        for limit in &self.limits {
            let _ = write!(text, "\n{}{}", limit.ranges(width), limit.numbers());
            if let Some(worst) = limit.worst() {
                let quantity = limit.limit.quantity;
                let value = written(quantity, worst.value);
                let unit = if quantity == Quantity::TimeStep { quantity.unit() } else { "" };
                let _ = write!(text, "  {value}{unit}, {}", worst.place);
            }
        }
        self.explained(&text, false)
    }

    /// Returns a table of the mesh before and after a run, where `self` is the mesh after.
    fn table_after(&self, before: &Self, is_by_acute: bool) -> String {
        let quantity = self.width();
        let width = LimitReport::HEAD.len() + 2 + VALUE;
        let name = format!("limits of {}", self.name);
        let start = quantity + 2 * RANGE;
        let mut text = format!("{name:<start$}{:>width$}{:>width$}", "before", "after");
        let _ = write!(text, "\n{}", ranges("quantity", quantity, ["warn", "fail"]));
        for _ in 0..2 {
            let _ = write!(text, "  {:>VALUE$}{}", "worst", LimitReport::HEAD);
        }
        for (before, after) in before.limits.iter().zip(&self.limits) {
            let _ = write!(text, "\n{}", after.ranges(quantity));
            for limit in [before, after] {
                let worst = limit.worst();
                let worst = worst.map(|worst| written(limit.limit.quantity, worst.value));
                let _ = write!(text, "  {:>VALUE$}{}", worst.unwrap_or_default(), limit.numbers());
            }
        }
        self.explained(&text, is_by_acute)
    }

    /// Returns the width of the column of quantities, in characters.
    fn width(&self) -> usize {
        let names = self.limits.iter().map(|limit| limit.name().len() + 2);
        names.fold(QUANTITY, usize::max)
    }

    fn heading(&self) -> String {
        match &*self.title {
            "" => self.name.clone(),
            title => format!("{}: {title}", self.name),
        }
    }

    /// Returns a table without blanks at the ends of its lines, a line on quadrilaterals, and a line for each reason of edges
    /// beyond limits. `is_by_acute` tells whether the mesh comes from a run by a metric that mends edges.
    fn explained(&self, table: &str, is_by_acute: bool) -> String {
        let mut lines: Vec<String> = table.lines().map(|line| line.trim_end().to_owned()).collect();
        if self.quadrilaterals > 0 {
            let (count, have) = match self.quadrilaterals {
                1 => ("1 quadrilateral".to_owned(), "has"),
                count => (format!("{count} quadrilaterals"), "have"),
            };
            lines.push(format!(
                "the limits of elements are of triangles: {count} {have} no verdict"
            ));
        }
        if !self.reasons.is_empty() {
            lines.push("edges beyond the limits, by reason".to_owned());
        }
        lines.extend(self.reasons.iter().map(|Reason { why, warned, failed }| {
            format!("{failed:>9} fail{warned:>9} warn  {}", Reason::words(*why, is_by_acute))
        }));
        lines.join("\n")
    }
}

/// Width of a value of a quantity, in characters.
const VALUE: usize = 9;

fn range(threshold: &Option<Threshold>) -> Option<String> {
    threshold.as_ref().map(Threshold::range)
}

/// Returns the columns of a quantity, in a column of a width, and its ranges.
fn ranges(quantity: &str, width: usize, [warn, fail]: [&str; 2]) -> String {
    format!("{quantity:<width$}{warn:<RANGE$}{fail:<RANGE$}")
}

impl LimitReport {
    /// The headings of [`Self::numbers`].
    const HEAD: &str = "   warned   failed  verdict";

    /// Returns the number of parts beyond `warn` but not beyond `fail`.
    fn warned(&self) -> usize {
        self.warn.as_ref().map_or(0, |warn| warn.count - self.failed())
    }

    /// Returns the number of parts beyond `fail`.
    fn failed(&self) -> usize {
        self.fail.as_ref().map_or(0, |fail| fail.count)
    }

    /// Returns the verdict in a word, `listed` for a quantity without a limit.
    pub(crate) fn judged(&self) -> &'static str {
        if self.listed.is_some() { "listed" } else { self.verdict().name() }
    }

    pub(crate) fn verdict(&self) -> Verdict {
        match (self.failed(), self.warned()) {
            (0, 0) => Verdict::Good,
            (0, _) => Verdict::Warn,
            _ => Verdict::Fail,
        }
    }

    fn finding(&self) -> Option<&Finding> {
        self.fail.as_ref().or(self.warn.as_ref()).or(self.listed.as_ref())
    }

    fn worst(&self) -> Option<&Worst> {
        self.finding()?.worst.as_ref()
    }

    /// Returns the name of the quantity, with the elements if they are quadrilaterals.
    fn name(&self) -> String {
        let Limit { quantity, elements, .. } = &self.limit;
        match elements {
            Elements::Triangles => quantity.name().to_owned(),
            Elements::Quadrilaterals => format!("{quantity} of {}", elements.name()),
        }
    }

    fn ranges(&self, width: usize) -> String {
        let [warn, fail] = [&self.limit.warn, &self.limit.fail].map(range);
        let [warn, fail] = [&warn, &fail].map(|range| range.as_deref().unwrap_or_default());
        ranges(&self.name(), width, [warn, fail])
    }

    fn numbers(&self) -> String {
        if self.listed.is_some() {
            return " ".repeat(Self::HEAD.len());
        }
        format!("{:>9}{:>9}  {:<7}", self.warned(), self.failed(), self.verdict().name())
    }

    /// Describes how many parts are beyond the limit, with the worst part. Values have no sign for degrees if `is_plain` is
    /// true.
    pub(crate) fn sentence(&self, is_plain: bool) -> String {
        match (&self.warn, &self.fail) {
            (Some(warn), Some(fail)) => match self.verdict() {
                Verdict::Fail => {
                    let have = if self.warned() == 1 { "has" } else { "have" };
                    let more = format!("{} more {have} {}", self.warned(), warn.threshold);
                    format!("{}; {more}", fail.sentence(is_plain))
                }
                Verdict::Warn | Verdict::Good => warn.sentence(is_plain),
            },
            (None, None) => {
                self.listed.as_ref().map(|listed| listed.worst_of_all(is_plain)).unwrap_or_default()
            }
            (only, None) | (None, only) => {
                only.as_ref().map(|finding| finding.sentence(is_plain)).unwrap_or_default()
            }
        }
    }

    fn json(&self) -> Value {
        let Limit { quantity, warn, fail, source, .. } = &self.limit;
        let worst = self.worst().map(|Worst { place, value }| {
            let mut object = place.json();
            object.insert("value".into(), json!(value));
            object
        });
        let mut object = json!({
            "quantity": quantity.name(), "warn": range(warn), "fail": range(fail), "source": source,
            "warned": self.warned(), "failed": self.failed(), "verdict": self.judged(), "worst": worst,
        });
        if let Some(Finding { parts, total, .. }) = self.finding() {
            object[*parts] = json!(total);
        }
        object
    }
}

/// A mesh beside the limits of a profile before and after a run.
#[derive(Serialize)]
pub(crate) struct ProfileChange {
    pub(crate) before: ProfileReport,
    pub(crate) after: ProfileReport,
    /// Whether the run had a metric that mends edges.
    #[serde(skip)]
    pub(crate) is_by_acute: bool,
}

impl ProfileChange {
    /// Returns a table with a line for each limit, and the reasons of edges that are beyond limits after the run.
    pub(crate) fn table(&self) -> String {
        self.after.table_after(&self.before, self.is_by_acute)
    }
}

impl Serialize for ProfileReport {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let limits: Vec<Value> = self.limits.iter().map(LimitReport::json).collect();
        let mut value = json!({
            "name": self.name, "title": self.title, "scheme": self.scheme.map(Metric::name),
            "verdict": self.verdict().name(), "limits": limits,
        });
        if self.quadrilaterals > 0 {
            value["without_verdict"] = json!({ "quadrilaterals": self.quadrilaterals });
        }
        if self.limits.iter().any(|limit| limit.limit.quantity.part() == Part::Edge) {
            value["reasons"] = self.reasons.iter().map(Reason::json).collect();
        }
        value.serialize(serializer)
    }
}
