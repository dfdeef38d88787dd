//! The reasons for which edges beyond the limits of a profile cannot be mended by moves of free vertices.

use gpu_smooth::measure::{InnerEdge, WhyLarge};
use serde_json::{Value, json};

use crate::limits::{Part, Threshold};
use crate::profiles::{Limit, Profile};
use crate::report::quantities::Quantities;

/// The edges beyond the limits of a profile that have one reason.
#[derive(Debug, PartialEq)]
pub(crate) struct Reason {
    /// The reason; `None` if nothing known prevents a better edge.
    pub(crate) why: Option<WhyLarge>,
    /// Number of edges beyond a limit for warnings alone.
    pub(crate) warned: usize,
    /// Number of edges beyond a limit for failures.
    pub(crate) failed: usize,
}

/// Counts the edges beyond the limits of edges by reason. Reasons without edges are left out.
pub(crate) fn reasons(profile: &Profile, quantities: &Quantities<'_>) -> Vec<Reason> {
    let limits: Vec<&Limit> =
        profile.limits.iter().filter(|limit| limit.quantity.part() == Part::Edge).collect();
    if limits.is_empty() {
        return Vec::new();
    }
    let all = WhyLarge::ALL.into_iter().map(Some).chain([None]);
    let mut reasons: Vec<Reason> = all.map(|why| Reason { why, warned: 0, failed: 0 }).collect();
    for edge in quantities.edges() {
        let is_in = |range: &Option<Threshold>| {
            let measured =
                range.as_ref().and_then(|range| Some((range, range.quantity.measure()?)));
            measured.is_some_and(|(range, measure)| range.is_met(edge.value(measure)))
        };
        let (is_failed, is_warned) = (
            limits.iter().any(|limit| is_in(&limit.fail)),
            limits.iter().any(|limit| is_in(&limit.warn)),
        );
        if !is_failed && !is_warned {
            continue;
        }
        let why = reason(quantities, edge);
        for reason in reasons.iter_mut().filter(|reason| reason.why == why) {
            match is_failed {
                true => reason.failed += 1,
                false => reason.warned += 1,
            }
        }
    }
    reasons.retain(|reason| reason.warned + reason.failed > 0);
    reasons
}

/// Returns the first reason, in the order of [`WhyLarge::ALL`], that holds for a triangle at an edge.
fn reason(quantities: &Quantities<'_>, edge: &InnerEdge) -> Option<WhyLarge> {
    let of_triangles = edge.elements.map(|index| quantities.why_large(index as usize));
    WhyLarge::ALL.into_iter().find(|why| of_triangles.contains(&Some(*why)))
}

impl Reason {
    /// Returns the description and the remedies of a reason. `is_by_acute` tells whether the mesh comes from a run by a metric
    /// that mends edges.
    pub(crate) fn words(why: Option<WhyLarge>, is_by_acute: bool) -> &'static str {
        match why {
            Some(WhyLarge::AllFixed) => {
                "a triangle of three fixed corners: slide, swap an edge or refine"
            }
            Some(WhyLarge::FewTriangles) => {
                "a vertex inside with three or four triangles: swap an edge or refine"
            }
            Some(WhyLarge::WideFan) => "a wide fan at a fixed vertex: slide or refine",
            _ if is_by_acute => "nothing known prevents it: slide, swap an edge or refine",
            _ => "nothing known prevents it: a run by acute mends most",
        }
    }

    pub(crate) fn json(&self) -> Value {
        let Self { why, warned, failed } = self;
        let (reason, remedies): (_, &[&str]) = match why {
            Some(WhyLarge::AllFixed) => (Some("all-fixed"), &["slide", "swap", "refine"]),
            Some(WhyLarge::FewTriangles) => (Some("few-triangles"), &["swap", "refine"]),
            Some(WhyLarge::WideFan) => (Some("wide-fan"), &["slide", "refine"]),
            _ => (None, &[]),
        };
        json!({ "reason": reason, "remedies": remedies, "warned": warned, "failed": failed })
    }
}
