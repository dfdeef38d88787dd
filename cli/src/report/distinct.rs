//! Measures for tables, in which measures with equal values share a row.

use gpu_smooth::measure::Measure;

/// Measures without those whose values are equal to an earlier measure, and a sentence for each measure left out.
pub(crate) struct DistinctMeasures {
    pub(crate) shown: Vec<Measure>,
    /// Clauses such as `edge equals edge-ratio`.
    pub(crate) equal: Vec<String>,
}

impl DistinctMeasures {
    /// Leaves out measures with an equal one among `measures`. Measures are equal for triangles alone.
    pub(crate) fn of(measures: &[Measure], has_quadrilaterals: bool) -> Self {
        let is_shown = |twin: &Measure| !has_quadrilaterals && measures.contains(twin);
        let twin = |measure: Measure| measure.equal_to().filter(is_shown);
        let shown = measures.iter().copied().filter(|measure| twin(*measure).is_none()).collect();
        let clause = |measure: &Measure| Some(format!("{measure} equals {}", twin(*measure)?));
        Self { shown, equal: measures.iter().filter_map(clause).collect() }
    }
}
