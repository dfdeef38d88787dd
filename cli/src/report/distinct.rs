//! Measures for tables, in which measures with equal values share a row.

use gpu_smooth::measure::Measure;

/// Measures without those whose values are equal to an earlier measure, and a sentence for each measure left out.
pub(crate) struct DistinctMeasures {
    pub(crate) shown: Vec<Measure>,
    /// Clauses such as `edge equals edge-ratio`.
    pub(crate) equal: Vec<String>,
}

impl DistinctMeasures {
    /// Leaves out measures with an equal one among `measures`.
    pub(crate) fn of(measures: &[Measure]) -> Self {
        let twin = |measure: Measure| measure.equal_to().filter(|twin| measures.contains(twin));
        let shown = measures.iter().copied().filter(|measure| twin(*measure).is_none()).collect();
        let clause = |measure: &Measure| Some(format!("{measure} equals {}", twin(*measure)?));
        Self { shown, equal: measures.iter().filter_map(clause).collect() }
    }
}
