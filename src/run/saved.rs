//! The state of a run between two sweeps: all that decides how it goes on.

use bytemuck::Pod;
use glam::DVec2;

use crate::run::objectives::Objectives;

/// The name of the CPU engine in [`EngineState::engine`].
pub(crate) const CPU: &str = "cpu";

/// The state of a run between two sweeps.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Saved {
    /// The objectives before the first sweep and after each.
    pub(crate) log: Vec<Objectives>,
    /// The share of f that is estimated to be left to gain.
    pub(crate) remaining: Option<f64>,
    /// What decides on corrections, if the run has any.
    pub(crate) corrections: Option<Vec<u64>>,
    pub(crate) engine: EngineState,
}

impl Saved {
    /// Number of sweeps done.
    pub(crate) fn sweeps(&self) -> u32 {
        (self.log.len() as u32).saturating_sub(1)
    }
}

/// The state of an engine between two sweeps.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct EngineState {
    /// [`CPU`], or the name of the adapter.
    pub(crate) engine: String,
    /// The positions of all vertices, normalized and in the order of the problem.
    pub(crate) positions: Vec<DVec2>,
    /// The positions in the best state, where that may not be the last one.
    pub(crate) best: Option<Vec<DVec2>>,
    /// What the coarser levels were built from, and then what they were fitted to, one after the other. Empty if there are none,
    /// or if the state is not whole.
    pub(crate) roots: Vec<Vec<f32>>,
    /// What only an engine of the same kind understands.
    pub(crate) own: Vec<(String, Vec<u8>)>,
}

impl EngineState {
    /// Adds values that only an engine of the same kind understands.
    pub(crate) fn add<T: Pod>(&mut self, name: &str, values: &[T]) {
        self.own.push((name.to_owned(), bytemuck::cast_slice(values).to_vec()));
    }

    /// Values that were added by this name, if there are as many.
    pub(crate) fn own<T: Pod>(&self, name: &str, count: usize) -> Option<Vec<T>> {
        let (_, bytes) = self.own.iter().find(|(known, _)| known == name)?;
        let is_whole = bytes.len() == count.checked_mul(size_of::<T>())?;
        is_whole.then(|| bytemuck::pod_collect_to_vec(bytes))
    }
}
