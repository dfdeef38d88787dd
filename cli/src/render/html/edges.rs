//! The edges between elements whose colors a page shows by measures of edges.

use gpu_smooth::measure::{InnerEdge, Measure, Measured};

/// The edges between shown elements before and after a run, or of one mesh.
pub(crate) struct ShownEdges {
    /// The edges at the positions of each state, all in one order.
    states: Vec<Vec<InnerEdge>>,
}

impl ShownEdges {
    /// Collects the edges whose two elements are `shown`, which is ascending. Without a measure of edges in `measures`,
    /// there are none.
    pub(crate) fn of(states: &[&Measured<'_>], shown: &[usize], measures: &[Measure]) -> Self {
        let is_shown = |index: &u32| shown.binary_search(&(*index as usize)).is_ok();
        let of_state = |state: &&Measured<'_>| {
            let mut edges = match measures.iter().any(|measure| measure.is_of_edges()) {
                true => state.edges(),
                false => Vec::new(),
            };
            edges.retain(|edge| edge.elements.iter().all(is_shown));
            edges
        };
        Self { states: states.iter().map(of_state).collect() }
    }

    /// Returns the ends of each edge.
    pub(crate) fn ends(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        self.states.iter().take(1).flatten().map(|edge| edge.vertices)
    }

    /// Returns the values of a measure in a state, in single precision; none of a measure of triangles.
    pub(crate) fn values(&self, state: usize, measure: Measure) -> impl Iterator<Item = f32> + '_ {
        let edges = if measure.is_of_edges() { &self.states[state][..] } else { &[] };
        edges.iter().map(move |edge| edge.value(measure) as f32)
    }
}
