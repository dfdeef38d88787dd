//! The report on the improvement of the worst triangles.

use gpu_smooth::outcome::Improved;
use gpu_smooth_job::{WorstEffect, cost_in_percent};
use serde::Serialize;

use crate::terminal::numbers::sig6;

/// The result of improving the worst triangles.
#[derive(Serialize)]
pub(crate) struct ImprovedReport {
    /// `imr`, `min-angle` (in degrees) or `altitude` (in the unit of the mesh).
    measure: &'static str,
    /// Number of moved vertices.
    vertices: usize,
    /// Worst value of the triangles with a free vertex, before and after.
    worst: [f64; 2],
    /// Number of triangles without a free vertex that are worse than the worst triangle with a free
    /// vertex.
    stuck: usize,
    /// The base metric's objective, before and after.
    f: [f64; 2],
}

impl From<Improved> for ImprovedReport {
    fn from(Improved { by, vertices, worst, stuck, f }: Improved) -> Self {
        Self { measure: by.name(), vertices, worst, stuck, f }
    }
}

impl ImprovedReport {
    /// Describes the improvement and its cost in f, in one sentence. `is_canceled` tells whether the run was interrupted.
    pub(crate) fn sentence(&self, is_canceled: bool) -> String {
        let Self { measure, vertices, worst: [before, after], stuck, f } = self;
        let worst = match *measure {
            "imr" => "worst imr".to_owned(),
            name => format!("least {}", name.trim_start_matches("min-")),
        };
        let shown = |x: f64| match *measure {
            "min-angle" => format!("{x:.2}°"),
            _ => sig6(x),
        };
        let (cost, n) = (cost(*f), *vertices);
        let vertices = if n == 1 { "vertex" } else { "vertices" };
        let mut text = match WorstEffect::of(n, self.worst) {
            WorstEffect::Nothing => format!(
                "the {worst} of movable triangles, {}, {}",
                shown(*after),
                if is_canceled {
                    "was not improved before the end"
                } else {
                    "could not be improved"
                }
            ),
            WorstEffect::Worst => format!(
                "the {worst} of movable triangles was improved from {} to {} by {n} {vertices}, which {cost}",
                shown(*before),
                shown(*after)
            ),
            WorstEffect::Others => format!(
                "the {worst} of movable triangles stays {}; others were improved by {n} {vertices}, which {cost}",
                shown(*after)
            ),
        };
        text += &match stuck {
            0 => String::new(),
            1 => "; 1 element is worse, and all its vertices are fixed".to_owned(),
            n => format!("; {n} elements are worse, and all their vertices are fixed"),
        };
        text
    }
}

/// Describes the change of f, as the end of a sentence.
pub(super) fn cost(f: [f64; 2]) -> String {
    match cost_in_percent(f) {
        None => "changed f by less than 0.01 %".to_owned(),
        Some(change) => format!("changed f by {change:+.2} %"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cost_of_an_improvement_is_printed_also_where_it_is_next_to_nothing() {
        let report = |f| ImprovedReport {
            measure: "imr",
            vertices: 2,
            worst: [2.0, 1.5],
            stuck: 0,
            f: [1.0, f],
        };
        for (f, expected) in
            [(1.02, "changed f by +2.00 %"), (1.0 - 1e-9, "changed f by less than 0.01 %")]
        {
            let sentence = report(f).sentence(false);
            assert!(sentence.ends_with(expected), "{sentence}");
        }
        let none = ImprovedReport { vertices: 0, worst: [2.0; 2], ..report(1.0) };
        for (is_canceled, end) in
            [(true, ", was not improved before the end"), (false, ", could not be improved")]
        {
            let sentence = none.sentence(is_canceled);
            assert!(sentence.contains(end), "{sentence}");
        }
    }
}
